"""One raw record of the virtual test bench, and its truth, which no inference reads."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.rig.bench import simulate
from bladeroot.rig.joint import parts
from bladeroot.schema import read_yaml


def main(bench, reduced, row, raw, truth):
    record, answer = simulate(
        read_yaml(bench, "bench"), parts(artifacts.load(reduced)), json.loads(row)
    )
    artifacts.save(answer, truth)
    artifacts.save(record, raw)


if __name__ == "__main__":
    run(
        main,
        bench="the bench's file (YAML)",
        reduced="reduced.nc of the bench's structure",
        row="the record's row of records.csv (JSON)",
        raw="raw record to write",
        truth="truth to write",
    )
