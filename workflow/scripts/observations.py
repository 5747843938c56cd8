"""The records of a campaign as the diagnosis takes them -> observations.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.diagnosis.observations import Gauge, observations, reading_step


def main(stick, batches, integrity, settings, output):
    measured, facts = artifacts.load(stick), json.loads(settings)
    forces = measured["record_force"].values if batches else measured["force"].values
    full_scale = facts["full_scale"] * facts["accuracy"]
    seen = observations(
        measured,
        artifacts.load_records(batches, "decay"),
        artifacts.load(integrity[0]) if integrity else None,
        Gauge(
            full_scale if facts["primary"] == "full-scale" else 0.0,
            facts["accuracy"],
            reading_step(forces, facts["scale"]),
        ),
        facts["laser_x"],
        facts["time"],
    )
    artifacts.save(seen, output, origin=measured, settings=settings)


if __name__ == "__main__":
    run(
        main,
        stick="stick.nc",
        batches="any: lists of the records in each batch, where there are records",
        integrity="any: integrity.nc, where there are records",
        settings="gauge (full_scale, scale, accuracy, primary), laser_x (m), time (s) (JSON)",
        output="observations.nc",
    )
