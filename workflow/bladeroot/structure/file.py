"""Reading a structure file."""

from pathlib import Path

from bladeroot.schema import read_yaml
from bladeroot.structure.geometry import Structure, structure_from_mapping


def load_structure(path: str | Path) -> Structure:
    """The structure of a YAML file. Raises ValueError with a line a fault, naming the file."""
    return structure_from_mapping(read_yaml(path, "structure"), str(path))
