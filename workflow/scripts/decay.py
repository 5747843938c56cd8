"""Curves of one free decay, and its plateau -> decay/<record>.nc, plateau/<record>.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.estimate import estimate
from bladeroot.decay.record import record_plateau


def main(record, settings, decay, plateau):
    curves = estimate(artifacts.load(record), **json.loads(settings))
    artifacts.save(record_plateau(curves), plateau, settings=settings)
    artifacts.save(curves, decay, settings=settings)


if __name__ == "__main__":
    run(
        main,
        record="free decay",
        settings="section `decay` of the configuration (JSON)",
        decay="curves to write",
        plateau="plateau to write",
    )
