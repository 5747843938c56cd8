"""Nodes and contact pairs of a model made elsewhere -> mesh.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.external.description import read_description
from bladeroot.rom.external.mesh import external_mesh


def main(structure, output):
    artifacts.save(external_mesh(read_description(structure)), output)


if __name__ == "__main__":
    run(main, structure="structure file of kind matrices (YAML)", output="mesh.nc")
