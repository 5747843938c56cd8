"""kn and kt with each structure at each axial force -> stiffness/<structure>/<force>.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.stiffness.search import search


def main(maps, fe_forces, settings, outputs):
    measured = artifacts.load(fe_forces)
    bias, offset = (
        {mode: percent / 100 for mode, percent in json.loads(settings)[name].items()}
        for name in ("fe_bias_percent", "fe_offset_percent")
    )
    for drawn, output in zip(maps, outputs, strict=True):
        found = search(artifacts.load(drawn), measured, bias, offset)
        artifacts.save(found, output, origin=measured, settings=settings)


if __name__ == "__main__":
    run(
        main,
        maps="many: maps of the structures, one a force",
        fe_forces="fe_forces.nc",
        settings="section `search` of the configuration (JSON)",
        outputs="many: stiffness files to write, in the same order",
    )
