"""Unpublished dimensions of a structure from published tables -> calibration.nc."""

from pathlib import Path

import pandas as pd
from _cli import run
from bladeroot import artifacts
from bladeroot.reproduction.calibration import Calibration
from bladeroot.reproduction.calibration_result import calibration
from bladeroot.reproduction.parameters import parameters_of
from bladeroot.reproduction.targets import targets_of
from bladeroot.schema import read_yaml


def main(calibration_file, structure, tables, output):
    asked = read_yaml(calibration_file, "calibration")
    start = read_yaml(structure, "structure")
    if asked["structure"] != start["name"]:
        raise ValueError(
            f"structure must be {start['name']!r} as the file's ({structure}), "
            f"got {asked['structure']!r} ({calibration_file})"
        )
    published = {Path(table).stem: pd.read_csv(table) for table in tables}
    asked_for = Calibration(
        start,
        parameters_of(asked["parameters"], start),
        targets_of(published, {**asked["judged"], **asked["targets"]}),
    )
    artifacts.save(calibration(asked_for, list(asked["targets"])), output)


if __name__ == "__main__":
    run(
        main,
        calibration_file="what to fit to which tables (YAML)",
        structure="structure file to start from (YAML)",
        tables="many: published tables as printed (CSV)",
        output="calibration.nc",
    )
