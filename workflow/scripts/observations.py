"""The records of a campaign as the diagnosis takes them -> observations.nc."""

import json

import numpy as np
from _cli import run
from bladeroot import artifacts
from bladeroot.decay.groups import group_differences
from bladeroot.diagnosis.observations import Gauge, observations, reading_step


def main(stick, batches, integrity, settings, output):
    measured, facts = artifacts.load(stick), json.loads(settings)
    decays = artifacts.load_records(batches, "decay")
    forces = measured["record_force"].values if batches else measured["force"].values
    seen = observations(
        measured,
        decays,
        artifacts.load(integrity[0]) if integrity else None,
        Gauge(
            facts["same_everywhere"],
            facts["of_reading"],
            reading_step(forces, facts["scale"]) if facts["scale"] else 0.0,
        ),
        facts["laser_x"],
        facts["time"],
    )
    bad = np.char.startswith(measured["verdict"].values.astype(str), "rejected")
    rejected = dict(zip(measured["record"].values.astype(str), bad.tolist(), strict=True))
    differences = group_differences(decays, [rejected[one.attrs["record"]] for one in decays])
    if differences is not None:
        seen = seen.merge(differences)
    artifacts.save(seen, output, origin=measured, settings=settings)


if __name__ == "__main__":
    run(
        main,
        stick="stick.nc",
        batches="any: lists of the records in each batch, where there are records",
        integrity="any: integrity.nc, where there are records",
        settings="load (same_everywhere, of_reading, scale), laser_x (m), time (s) (JSON)",
        output="observations.nc",
    )
