"""kn and kt with one structure from all forces at once -> joint/<structure>.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.joint import joint


def main(parametric, stick, settings, output):
    measured, asked = artifacts.load(stick), json.loads(settings)
    gauge = asked["gauge"]
    bias, offset = (
        {mode: percent / 100 for mode, percent in asked[name].items()}
        for name in ("fe_bias_percent", "fe_offset_percent")
    )
    found = joint(
        artifacts.load(parametric),
        measured,
        ForceGauge(gauge["full_scale_std"], gauge["relative_std"], gauge["primary"]),
        gauge["forces"],
        bias,
        offset,
        asked["least_force"],
    )
    artifacts.save(found, output, origin=measured, settings=settings)


if __name__ == "__main__":
    run(
        main,
        parametric="parametric.nc of the structure",
        stick="stick.nc",
        settings="gauge (as for fe_forces), least_force (N) and section `search` (JSON)",
        output="joint file",
    )
