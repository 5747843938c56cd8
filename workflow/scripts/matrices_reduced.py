"""The Craig-Bampton reduction of matrices made elsewhere, with their checks -> reduced.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.external.description import read_description
from bladeroot.rom.external.reduction import reduce_matrices


def main(structure, mesh, output):
    artifacts.save(reduce_matrices(read_description(structure), artifacts.load(mesh)), output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file of kind matrices (YAML)",
        mesh="mesh.nc",
        output="reduced.nc",
    )
