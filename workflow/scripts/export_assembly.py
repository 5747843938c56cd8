"""A lap joint's matrices, nodes and contact pairs as files of kind assembly."""

from pathlib import Path

from _cli import run
from bladeroot.rom.external.assembly import export_assembly
from bladeroot.rom.whole import assembly
from bladeroot.schema import read_yaml


def main(structure, output):
    name = f"{Path(structure).stem}-mtx"
    export_assembly(assembly(structure), read_yaml(structure, "assembly"), Path(output), name)


if __name__ == "__main__":
    run(main, structure="structure file of kind lap-joint (YAML)", output="folder to write")
