"""Frequencies of the joint over kn, kt and force, once for each structure -> parametric.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.whole import parametric_structure


def main(reduced, springs, settings, output):
    model = parametric_structure(
        artifacts.load(reduced), json.loads(settings), equal_nodes=springs == "equal"
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
