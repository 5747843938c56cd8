"""A structure against the thesis's tables, exact identities and its own full model -> checks.nc."""

from pathlib import Path

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.rom.checks import checks
from bladeroot.rom.file import load_structure


def main(structure, tables, output):
    published = {Path(table).stem: pd.read_csv(table) for table in tables}
    artifacts.save(checks(load_structure(structure), published), output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        tables="many: published tables as printed (CSV)",
        output="checks.nc",
    )
