"""The parametric model against the full one at the ends of the force -> accuracy.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.accuracy import accuracy
from bladeroot.rom.file import load_structure
from bladeroot.rom.full import full_joint


def main(structure, mesh, prestress, parametric, forces, output):
    full = full_joint(load_structure(structure), artifacts.load(mesh), artifacts.load(prestress))
    artifacts.save(accuracy(full, artifacts.load(parametric), json.loads(forces)), output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc",
        prestress="prestress.nc",
        parametric="parametric.nc",
        forces="axial forces in N (JSON list)",
        output="accuracy.nc",
    )
