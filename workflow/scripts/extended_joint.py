"""kn and kt from all forces at once with a model file's causes -> extended joint.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.diagnosis.extension import read
from bladeroot.diagnosis.rerun import gauge_of, law_of, left_out
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.schema import read_yaml
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.joint import joint


def main(parametric, stick, model, settings, output):
    measured, asked = artifacts.load(stick), json.loads(settings)
    extension = read(read_yaml(model, "model"), catalogue(asked["mechanisms"] or None))
    gauge = asked["gauge"]
    bias, offset = (
        {mode: percent / 100 for mode, percent in asked[name].items()}
        for name in ("fe_bias_percent", "fe_offset_percent")
    )
    stated = ForceGauge(gauge["full_scale_std"], gauge["relative_std"], gauge["primary"])
    found = joint(
        artifacts.load(parametric),
        measured,
        gauge_of(extension, stated),
        gauge["forces"],
        bias,
        offset,
        asked["least_force"],
        extension=law_of(extension),
    ).assign_attrs(
        extended_by=";".join(one.id for one, _ in extension.causes),
        extension_left_out=";".join(left_out(extension)),
    )
    artifacts.save(found, output, origin=measured, settings=settings)


if __name__ == "__main__":
    run(
        main,
        parametric="parametric.nc of the extended structure",
        stick="stick.nc",
        model="model file (YAML)",
        settings="gauge (as for fe_forces), least_force, sections `search`, `diagnosis` (JSON)",
        output="joint file",
    )
