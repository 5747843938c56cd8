"""The full matrices of a dovetail as files of kind matrices -> a folder."""

from _cli import run
from bladeroot import artifacts
from bladeroot.files import whole_folder
from bladeroot.rom.external.export import export_matrices
from bladeroot.rom.file import load_structure


def main(structure, mesh, prestress, form, output):
    dovetail = load_structure(structure)
    with whole_folder(output) as folder:
        export_matrices(
            dovetail,
            artifacts.load(mesh),
            artifacts.load(prestress),
            folder,
            f"{dovetail.name}-{form}",
            form,
        )


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc",
        prestress="prestress.nc",
        form="mtx (Matrix Market) or hb (Harwell-Boeing)",
        output="folder of the matrices",
    )
