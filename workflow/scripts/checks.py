"""A structure against the thesis's tables, exact identities and its own full model -> checks.nc."""

from pathlib import Path

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.reproduction.structure_checks import checks
from bladeroot.rom.file import load_structure


def main(structure, mesh, prestress, reduced, tables, output):
    published = {Path(table).stem: pd.read_csv(table) for table in tables}
    made = map(artifacts.load, (mesh, prestress, reduced))
    artifacts.save(checks(load_structure(structure), *made, published), output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc",
        prestress="prestress.nc",
        reduced="reduced.nc",
        tables="many: published tables as printed (CSV)",
        output="checks.nc",
    )
