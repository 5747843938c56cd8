"""The parametric model against the full matrices at the ends of the force -> accuracy.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.accuracy import accuracy
from bladeroot.rom.external.bodies import load_bodies
from bladeroot.rom.external.description import read_description
from bladeroot.rom.external.full import full_joint_of


def main(structure, mesh, parametric, forces, output):
    nodes = artifacts.load(mesh)
    full = full_joint_of(load_bodies(read_description(structure), nodes), nodes)
    artifacts.save(accuracy(full, artifacts.load(parametric), json.loads(forces)), output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file of kind matrices (YAML)",
        mesh="mesh.nc",
        parametric="parametric.nc",
        forces="axial forces in N (JSON list)",
        output="accuracy.nc",
    )
