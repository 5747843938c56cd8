"""Stick frequencies at the simulation's axial forces -> fe_forces.nc."""

import json

import numpy as np
from _cli import run
from bladeroot import artifacts
from bladeroot.stiffness.interpolation import ForceGauge, fe_forces


def main(stick, settings, output):
    measured = artifacts.load(stick)
    facts = json.loads(settings)
    gauge = ForceGauge(facts["full_scale_std"], facts["relative_std"], facts["primary"])
    artifacts.save(
        fe_forces(measured, np.array(facts["forces"]), gauge),
        output,
        origin=measured,
        settings=settings,
    )


if __name__ == "__main__":
    run(
        main,
        stick="stick.nc",
        settings="forces (N), and the gauge's full_scale_std (N), relative_std and primary (JSON)",
        output="fe_forces.nc",
    )
