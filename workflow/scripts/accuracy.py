"""The parametric model against the full finite-element model at every force -> accuracy.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.structure.accuracy import accuracy
from bladeroot.structure.file import load_structure


def main(structure, mesh, prestress, parametric, forces, output):
    parts = [artifacts.load(part) for part in (mesh, prestress, parametric)]
    artifacts.save(accuracy(load_structure(structure), *parts, json.loads(forces)), output)


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
