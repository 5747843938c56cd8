"""Frequencies of the joint over kn, kt and force, once for each structure -> parametric.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.rom.parametric import parametric_model


def main(reduced, springs, settings, output):
    asked = json.loads(settings)
    model = parametric_model(
        joint_of_reduced(artifacts.load(reduced), equal_nodes=springs == "equal"),
        asked["modes"],
        tuple(1e9 * k for k in asked["stiffness_GN_per_m"]),
        tuple(1e3 * force for force in asked["force_kN"]),
    )
    artifacts.save(model, output, settings=settings)


if __name__ == "__main__":
    run(
        main,
        reduced="reduced.nc",
        springs="area or equal: how a flank's stiffness is shared among its nodes",
        settings="section `parametric` of the configuration (JSON)",
        output="parametric.nc",
    )
