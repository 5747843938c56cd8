"""Raw records of one batch of the virtual test bench, and their truth, which no inference reads."""

import json
from pathlib import Path

from _cli import run
from bladeroot import artifacts, statement
from bladeroot.bench.bench import simulate
from bladeroot.bench.joint import parts
from bladeroot.schema import read_yaml


def main(bench, reduced, rows, code, folder):
    described, specimen = read_yaml(bench, "bench"), parts(artifacts.load(reduced))
    place = Path(folder)
    asked = [
        statement.Part(row, [], [f"{folder}/{kind}{row['record']}.nc" for kind in ("truth/", "")])
        for row in json.loads(rows)
    ]
    stated = statement.statements(place.parents[1], f"bench/{place.name}")
    current = statement.still_current(stated, [code], [bench, reduced], asked)
    for part in asked:
        if part.facts["record"] in current:
            statement.renew(part)
            continue
        record, answer = simulate(described, specimen, part.facts)
        for path, made in zip(part.outputs, (answer, record), strict=True):
            artifacts.save(made, path)


if __name__ == "__main__":
    run(
        main,
        bench="the bench's file (YAML)",
        reduced="reduced.nc of the bench's structure",
        rows="the records' rows of records.csv, a list (JSON)",
        code="hash of the code; a record that this code has made of the same is kept",
        folder="where the raw records go, and their truth in its folder truth",
    )
