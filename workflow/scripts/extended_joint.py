"""kn and kt from all records at once with a model file's causes -> extended joint.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.diagnosis.extended import extended_joint
from bladeroot.diagnosis.extension import read
from bladeroot.diagnosis.simulation.parametric import of_structure
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.schema import read_yaml


def main(parametric, observations, model, settings, output):
    seen, asked = artifacts.load(observations), json.loads(settings)
    extension = read(read_yaml(model, "model"), catalogue(asked["mechanisms"] or None))
    bias, offset = (
        {mode: percent / 100 for mode, percent in asked[name].items()}
        for name in ("fe_bias_percent", "fe_offset_percent")
    )
    model, modes = artifacts.load(parametric), seen["mode"].values.astype(str)
    simulated = of_structure(model, modes, bias, offset)
    least_force, forces = asked["least_force"], asked["gauge"]["forces"]
    found = extended_joint(seen, simulated, extension, least_force, forces)
    found.attrs["springs"] = str(model.attrs.get("springs", ""))
    artifacts.save(found, output, origin=seen, settings=settings)


if __name__ == "__main__":
    run(
        main,
        parametric="parametric.nc of the structure",
        observations="observations.nc",
        model="model file (YAML)",
        settings="gauge (as for fe_forces), least_force, sections `search`, `diagnosis` (JSON)",
        output="joint file",
    )
