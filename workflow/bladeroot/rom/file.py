"""Reading a structure file, of a built-in dovetail or of matrices made elsewhere."""

from pathlib import Path

from bladeroot.fem.geometry import Structure, structure_from_mapping
from bladeroot.schema import parse_yaml, read_yaml


def load_structure(path: str | Path) -> Structure:
    """The dovetail of a YAML file. Raises ValueError with a line a fault, naming the file."""
    return structure_from_mapping(read_yaml(path, "structure"), str(path))


def is_matrices(path: str | Path) -> bool:
    """Whether the file is of kind `matrices`; ValueError if it cannot be read."""
    document = parse_yaml(path)
    return isinstance(document, dict) and document.get("kind") == "matrices"


def check_structure(path: str | Path) -> str:
    """Name of the structure, its file and the tables that it names checked; matrices come later.

    Raises ValueError with a line a fault.
    """
    if not is_matrices(path):
        return read_yaml(path, "structure")["name"]
    # numpy and xarray need not load for the dovetail
    from bladeroot.rom.external.description import read_description
    from bladeroot.rom.external.mesh import external_mesh

    description = read_description(path)
    external_mesh(description)
    return description.data["name"]
