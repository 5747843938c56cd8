"""Where slip begins, by how pressure is spread over the flanks -> shortfall.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.nonlinear.shortfall import POINT, onset_table
from bladeroot.rom.joint import joint_of_reduced


def main(reduced, output):
    structure = artifacts.load(reduced)
    table = onset_table(joint_of_reduced(structure), POINT)
    artifacts.save(table, output, origin=structure)


if __name__ == "__main__":
    run(main, reduced="reduced.nc", output="shortfall.nc")
