"""Beam and slots joined at one axial force -> assembly/<force>.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.structure.assembly import assemble


def main(reduced, force, output):
    artifacts.save(assemble(artifacts.load(reduced), float(force)), output)


if __name__ == "__main__":
    run(main, reduced="reduced.nc", force="axial force in N", output="assembly file")
