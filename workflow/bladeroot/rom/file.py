"""Reading a structure file, of a built-in dovetail or of matrices made elsewhere."""

import math
from collections.abc import Iterable
from pathlib import Path

from bladeroot.fem.geometry import Structure, structure_from_mapping
from bladeroot.schema import parse_yaml, read_yaml
from bladeroot.shipped_files import structure_file

# Kinds of structure files.
ASSEMBLY, LAP_JOINT = "assembly", "lap-joint"


def load_structure(path: str | Path) -> Structure:
    """The dovetail of a YAML file. Raises ValueError with a line a fault, naming the file."""
    return structure_from_mapping(read_yaml(path, "structure"), str(path))


def kind_of(path: str | Path) -> str:
    """`matrices`, `assembly`, `lap-joint`, or "" for a dovetail.

    ValueError if it cannot be read.
    """
    document = parse_yaml(path)
    return str(document.get("kind", "")) if isinstance(document, dict) else ""


def is_matrices(path: str | Path) -> bool:
    """Whether the file is of kind `matrices`; ValueError if it cannot be read."""
    return kind_of(path) == "matrices"


def named_structure(
    name: str, folder: Path, modes: Iterable[str] = (), loads: Iterable[float] = ()
) -> Path:
    """The file of a campaign's structure, the campaign folder's own or a shipped one, checked.

    modes, loads: those of the campaign. Raises ValueError with a line a fault.
    """
    path = structure_file(name, folder)
    written = check_structure(path, modes, loads)
    if written != name:
        raise ValueError(f"name must be {name!r} as the file's, got {written!r} ({path})")
    return path


def check_structure(
    path: str | Path, modes: Iterable[str] = (), loads: Iterable[float] = ()
) -> str:
    """Name of the structure, its file and the tables that it names checked; matrices come later.

    modes, loads: those of a campaign that an assembly must serve. Raises ValueError with a line a
    fault.
    """
    kind = kind_of(path)
    if kind in (ASSEMBLY, LAP_JOINT):
        data = read_yaml(path, "assembly")
        unknown = [mode for mode in modes if mode not in data["modes"]]
        if unknown:
            known = ", ".join(data["modes"])
            raise ValueError(f"modes: {path} knows {known}, not {', '.join(unknown)}")
        low, high = data.get("load_range", (-math.inf, math.inf))
        outside = sorted({load for load in loads if not low <= load <= high})
        if outside:
            told = ", ".join(f"{load:g}" for load in outside)
            raise ValueError(
                f"load_range of {path} is {low:g} to {high:g}; records have {told} (forces in N)"
            )
        if kind == ASSEMBLY:
            from bladeroot.rom.external.assembly import assembly_tables, read_assembly

            assembly_tables(read_assembly(path))
        return data["name"]
    if kind != "matrices":
        return read_yaml(path, "structure")["name"]
    # numpy and xarray need not load for the dovetail
    from bladeroot.rom.external.description import read_description
    from bladeroot.rom.external.mesh import external_mesh

    description = read_description(path)
    external_mesh(description)
    return description.data["name"]
