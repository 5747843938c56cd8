"""What must hold for matrices made elsewhere, whatever the structure -> checks.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.external.checks import external_checks
from bladeroot.rom.external.description import read_description


def main(structure, mesh, output):
    artifacts.save(external_checks(read_description(structure), artifacts.load(mesh)), output)


if __name__ == "__main__":
    run(
        main,
        structure="structure file of kind matrices (YAML)",
        mesh="mesh.nc",
        output="checks.nc",
    )
