"""A structure file to its reduced matrices, through all stages in between."""

from pathlib import Path

import xarray as xr

from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.rom.external.description import read_description
from bladeroot.rom.external.mesh import external_mesh
from bladeroot.rom.external.reduction import reduce_matrices
from bladeroot.rom.file import is_matrices, load_structure
from bladeroot.rom.reduction import reduce_structure


def reduced_structure(path: str | Path) -> xr.Dataset:
    """Craig-Bampton reduction (4.3-4.12) of a built-in structure or of matrices made elsewhere.

    Takes some ten seconds. Raises ValueError for what is wrong in the file, a line a fault.
    """
    if is_matrices(path):
        described = read_description(path)
        return reduce_matrices(described, external_mesh(described))
    structure = load_structure(path)
    nodes = build_mesh(structure)
    return reduce_structure(structure, nodes, prestress(structure, nodes))
