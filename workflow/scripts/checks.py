"""A structure against the thesis's tables, exact identities and its own full model -> checks.nc."""

from pathlib import Path

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.rom.checks import checks
from bladeroot.rom.file import load_structure


def main(structure, mesh, prestress, tables, output):
    published = {Path(table).stem: pd.read_csv(table) for table in tables}
    made = (artifacts.load(mesh), artifacts.load(prestress))
    artifacts.save(checks(load_structure(structure), *made, published), output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc",
        prestress="prestress.nc",
        tables="many: published tables as printed (CSV)",
        output="checks.nc",
    )
