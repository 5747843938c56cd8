"""Raw records of one batch of the virtual test bench, and their truth, which no inference reads."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.bench.bench import simulate
from bladeroot.bench.joint import parts
from bladeroot.schema import read_yaml


def main(bench, reduced, rows, folder):
    described, specimen = read_yaml(bench, "bench"), parts(artifacts.load(reduced))
    for row in json.loads(rows):
        record, answer = simulate(described, specimen, row)
        artifacts.save(answer, f"{folder}/truth/{row['record']}.nc")
        artifacts.save(record, f"{folder}/{row['record']}.nc")


if __name__ == "__main__":
    run(
        main,
        bench="the bench's file (YAML)",
        reduced="reduced.nc of the bench's structure",
        rows="the records' rows of records.csv, a list (JSON)",
        folder="where the raw records go, and their truth in its folder truth",
    )
