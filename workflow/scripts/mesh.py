"""The mesh of a structure: beam with pad, slots and contact pairs -> mesh.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.fem.mesh import build_mesh
from bladeroot.rom.file import load_structure


def main(structure, output):
    artifacts.save(build_mesh(load_structure(structure)), output)


if __name__ == "__main__":
    run(main, structure="structure file (YAML)", output="mesh.nc")
