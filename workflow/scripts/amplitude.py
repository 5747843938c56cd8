"""kn and kt from frequencies and amplitude curves together -> amplitude/<structure>.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.stiffness.amplitude import amplitude
from bladeroot.stiffness.interpolation import ForceGauge


def main(reduced, parametric, stick, observations, settings, output):
    measured, asked = artifacts.load(stick), json.loads(settings)
    gauge = asked["gauge"]
    bias, offset = (
        {mode: percent / 100 for mode, percent in asked[name].items()}
        for name in ("fe_bias_percent", "fe_offset_percent")
    )
    found = amplitude(
        joint_of_reduced(artifacts.load(reduced)),
        artifacts.load(parametric),
        measured,
        artifacts.load(observations),
        asked["lasers"],
        ForceGauge(gauge["full_scale_std"], gauge["relative_std"], gauge["primary"]),
        gauge["forces"],
        bias,
        offset,
        asked["least_force"],
        asked["curve_discrepancy_percent"] / 100,
    )
    artifacts.save(found, output, origin=measured, settings=settings)


if __name__ == "__main__":
    run(
        main,
        reduced="reduced.nc of the structure",
        parametric="parametric.nc of the structure",
        stick="stick.nc",
        observations="observations.nc",
        settings="as of joint.py, with lasers (m, by mode) and curve_discrepancy_percent (JSON)",
        output="amplitude file",
    )
