"""Frequencies of the joint as a function of kn and kt at one axial force -> map/<force>.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.stiffness.map import frequency_map


def main(parametric, assembly, output):
    artifacts.save(frequency_map(artifacts.load(parametric), artifacts.load(assembly)), output)


if __name__ == "__main__":
    run(main, parametric="parametric.nc", assembly="assembly file", output="map file")
