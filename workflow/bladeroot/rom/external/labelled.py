"""Matrices whose entries name nodes and directions instead of rows: Abaqus's and Nastran's text.

Rows are in the order of nodes, then directions. The same file says as `mapping` what they are.
"""

from pathlib import Path

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.rom.external.reading import both_triangles, choose

Entries = tuple[Int[ndarray, "entry 4"], Float[ndarray, " entry"]]


def is_abaqus(path: str | Path) -> bool:
    """Whether a .mtx file is Abaqus's (FORMAT=MATRIX INPUT), not Matrix Market's."""
    with open(path, encoding="latin-1") as file:
        return not file.readline().startswith("%%")


def abaqus_entries(path: str | Path) -> Entries:
    """Lines of row node, direction, column node, direction, value."""
    with open(path, encoding="latin-1") as file:
        lines = [line for line in file if line.strip() and not line.startswith(("*", "%"))]
    table = np.loadtxt(lines, delimiter=",", ndmin=2)
    if table.shape[1] != 5:
        raise ValueError(
            f"expected lines of node, direction, node, direction, value, got {table.shape[1]} "
            f"columns ({path})"
        )
    return table[:, :4].astype(np.int64), table[:, 4]


def punch_entries(path: str | Path, variable: str | None = None, first: bool = False) -> Entries:
    """DMIG* cards, fields of sixteen characters, of the named matrix, the only or the first one."""
    found: dict[str, tuple[list, list]] = {}
    name, column = "", (0, 0)
    with open(path, encoding="latin-1") as file:
        for line in file:
            fields = [line[8 + 16 * k : 24 + 16 * k].strip() for k in range(4)]
            if line.startswith("DMIG*"):
                name, column = fields[0], (int(fields[1]), int(fields[2]))
                found.setdefault(name, ([], []))
            elif line.startswith("*") and name:
                place, values = found[name]
                place.append((int(fields[0]), int(fields[1]), *column))
                values.append(float(fields[2].upper().replace("D", "E")))
    chosen = next(iter(found), None) if first else choose(list(found), variable, str(path))
    place, values = found.get(chosen, ([], []))
    if not values:
        raise ValueError(f"expected DMIG* cards, got none ({path})")
    return np.array(place), np.array(values)


def matrix_of(entries: Entries, path: str) -> sp.coo_array:
    """Rows in the order of `labels_of`; a triangle becomes both."""
    place, values = entries
    labels = labels_of(entries)
    code = labels[:, 0] * 10 + labels[:, 1]
    index = [np.searchsorted(code, place[:, k] * 10 + place[:, k + 1]) for k in (0, 2)]
    stored = sp.coo_array((values, tuple(index)), shape=(len(labels),) * 2)
    whole = sp.tril(stored, -1).nnz and sp.triu(stored, 1).nnz
    return stored if whole else both_triangles(stored, path)


def labels_of(entries: Entries) -> Int[ndarray, "row 2"]:
    """Node and direction (1 to 6) of each row."""
    return np.unique(entries[0].reshape(-1, 2), axis=0)
