"""The static stress of the beam under axial force -> prestress.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.fem.prestress import prestress
from bladeroot.rom.file import load_structure


def main(structure, mesh, output):
    artifacts.save(prestress(load_structure(structure), artifacts.load(mesh)), output)


if __name__ == "__main__":
    run(main, structure="structure file (YAML)", mesh="mesh.nc", output="prestress.nc")
