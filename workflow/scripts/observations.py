"""The records of a campaign as the diagnosis takes them -> observations.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.diagnosis.observations import observations


def main(stick, batches, integrity, settings, output):
    measured, settings = artifacts.load(stick), "".join(settings)
    seen = observations(
        measured,
        artifacts.load_records(batches, "decay", without=("pff_*",)),
        artifacts.load(integrity[0]) if integrity else None,
        json.loads(settings),
    )
    artifacts.save(seen, output, origin=measured, settings=settings)


if __name__ == "__main__":
    run(
        main,
        stick="stick.nc",
        batches="any: lists of the records in each batch, where there are records",
        integrity="any: integrity.nc, where there are records",
        settings="many: pieces of JSON: load (same_everywhere, of_reading, scale), laser_x, time",
        output="observations.nc",
    )
