"""Curves of one free decay, and its plateau -> decay/<record>.nc, plateau/<record>.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.estimate import estimate
from bladeroot.decay.record import record_plateau


def main(record, settings, decay, plateau):
    cut = artifacts.load(record)
    band = cut.attrs.get("band_Hz")
    curves = estimate(
        cut, **json.loads(settings), band_Hz=None if band is None else tuple(map(float, band))
    )
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
