"""kn and kt at one axial force with one structure -> stiffness/<structure>/<force>.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.stiffness.search import search


def main(map, fe_forces, settings, output):
    measured = artifacts.load(fe_forces)
    bias, offset = (
        {mode: percent / 100 for mode, percent in json.loads(settings)[name].items()}
        for name in ("fe_bias_percent", "fe_offset_percent")
    )
    artifacts.save(
        search(artifacts.load(map), measured, bias, offset),
        output,
        origin=measured,
        settings=settings,
    )


if __name__ == "__main__":
    run(
        main,
        map="map file of the structure at the force",
        fe_forces="fe_forces.nc",
        settings="section `search` of the configuration (JSON)",
        output="stiffness file",
    )
