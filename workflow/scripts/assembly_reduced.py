"""Bodies and interfaces of a structure of kind assembly or lap-joint, reduced -> reduced.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.whole import reduced_structure


def main(structure, output):
    artifacts.save(reduced_structure(structure), output)


if __name__ == "__main__":
    run(main, structure="structure file (YAML)", output="reduced.nc")
