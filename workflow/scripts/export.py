"""The full matrices of a dovetail as files of kind matrices -> a folder."""

import shutil
from pathlib import Path

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.external.export import export_matrices
from bladeroot.rom.file import load_structure


def main(structure, mesh, prestress, form, output):
    whole = Path(output)
    part = whole.with_name(f".{whole.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    dovetail = load_structure(structure)
    export_matrices(
        dovetail,
        artifacts.load(mesh),
        artifacts.load(prestress),
        part,
        f"{dovetail.name}-{form}",
        form,
    )
    shutil.rmtree(whole, ignore_errors=True)
    part.rename(whole)


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc",
        prestress="prestress.nc",
        form="mtx (Matrix Market) or hb (Harwell-Boeing)",
        output="folder of the matrices",
    )
