"""The Craig-Bampton reduction of beam and slots, once for all forces -> reduced.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.file import load_structure
from bladeroot.rom.reduction import reduce_structure


def main(structure, mesh, prestress, output):
    reduced = reduce_structure(
        load_structure(structure), artifacts.load(mesh), artifacts.load(prestress)
    )
    artifacts.save(reduced, output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file (YAML)",
        mesh="mesh.nc",
        prestress="prestress.nc",
        output="reduced.nc",
    )
