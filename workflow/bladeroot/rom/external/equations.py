"""Which node and direction each row of a matrix is: from a mapping file or from the node table."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Int
from numpy import ndarray

from bladeroot.rom.external.labelled import abaqus_entries, labels_of, punch_entries
from bladeroot.rom.external.reading import check_path
from bladeroot.rom.external.tables import MOST_DIGITS, Table, whole_numbers

# Displacements along X, Y, Z, then rotations about them, as ANSYS writes them.
LABELS = ("UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")
COLUMNS = ("dof_x", "dof_y", "dof_z", "dof_rx", "dof_ry", "dof_rz")


@dataclass(frozen=True)
class Equations:
    """For each row of the matrices, from the first: its node's place in the table, and its axis.

    Axes 0 to 2 are displacements along X, Y, Z, 3 to 5 rotations.
    """

    node: Int[ndarray, " equation"]
    axis: Int[ndarray, " equation"]


def equations_of(nodes: Table, mapping: Path | None) -> Equations:
    """From the mapping file; else from the columns dof_x...; else three rows a node, in order.

    ANSYS's HBMAT writes a file `.mapping` (matrix equation, node, direction), CalculiX a file
    `.dof` (node.direction). Raises ValueError, one line, if it is not one row for one equation.
    """
    ids = whole_numbers(nodes, "node")
    place = {int(node): k for k, node in enumerate(ids)}
    if len(place) < len(ids):
        twice = next(k for k, node in enumerate(ids) if place[int(node)] != k)
        raise ValueError(f"node {ids[twice]} stands in the table twice ({nodes.where(twice)})")
    by_columns = any(name in nodes.columns for name in COLUMNS)
    if mapping is not None and by_columns:
        raise ValueError(f"expected either a mapping or columns dof_x..., got both ({nodes.path})")
    if mapping is not None:
        return _from_mapping(mapping, place, nodes.path)
    if by_columns:
        return _from_columns(nodes)
    return Equations(np.repeat(np.arange(len(ids)), 3), np.tile(np.arange(3), len(ids)))


def _from_columns(nodes: Table) -> Equations:
    number, node, axis = [], [], []
    for k, name in enumerate(COLUMNS):
        if name in nodes.columns:
            column = whole_numbers(nodes, name, empty=0)
            given = np.flatnonzero(column)
            number.append(column[given])
            node.append(given)
            axis.append(np.full(len(given), k))
    return _ordered(*(np.concatenate(part) for part in (number, node, axis)), nodes.path)


def _from_mapping(path: Path, place: dict[int, int], table: Path) -> Equations:
    if path.suffix.lower() not in (".mapping", ".dof", ".pch", ".mtx"):
        raise ValueError(
            "expected a mapping ending in .mapping (HBMAT) or .dof (CalculiX), or a matrix with "
            f"labels ending in .pch (Nastran) or .mtx (Abaqus), got {path}"
        )
    check_path(path, "a mapping file")
    if path.suffix.lower() in (".pch", ".mtx"):
        return _from_labels(path, place, table)
    read = _hbmat_row if path.suffix.lower() == ".mapping" else _calculix_row
    number, node, axis = [], [], []
    for line, text in enumerate(path.read_text(encoding="latin-1").splitlines(), 1):
        if not re.match(r"\s*\d", text):
            continue  # blank lines and the header
        row = read(text, len(number) + 1)
        if row is None:
            expected = "equation, node and one of " + ", ".join(LABELS)
            expected = expected if read is _hbmat_row else "node.direction"
            raise ValueError(f"expected {expected}, got {text.strip()!r} ({path}, row {line})")
        if row[1] not in place:
            raise ValueError(f"node {row[1]} is not in {table} ({path}, row {line})")
        number.append(row[0])
        node.append(place[row[1]])
        axis.append(row[2])
    return _ordered(*(np.array(part, dtype=np.int64) for part in (number, node, axis)), path)


def _from_labels(path: Path, place: dict[int, int], table: Path) -> Equations:
    """From a matrix, the first of its file, whose entries name nodes and directions."""
    labels = labels_of(abaqus_entries(path) if path.suffix.lower() == ".mtx" else
                       punch_entries(path, first=True))  # fmt: skip
    for node, axis in labels.tolist():
        if node not in place or not 1 <= axis <= 6:
            raise ValueError(f"node {node}, direction {axis} is not in {table} ({path})")
    node = np.array([place[one] for one in labels[:, 0].tolist()])
    return Equations(node, labels[:, 1] - 1)


def _hbmat_row(text: str, _: int) -> tuple[int, int, int] | None:
    match = re.fullmatch(
        rf"\s*(\d{{1,{MOST_DIGITS}}})\s+(\d{{1,{MOST_DIGITS}}})\s+([A-Z]+)\s*", text
    )
    if match is None or match[3] not in LABELS:
        return None
    return int(match[1]), int(match[2]), LABELS.index(match[3])


def _calculix_row(text: str, number: int) -> tuple[int, int, int] | None:
    match = re.fullmatch(rf"\s*(\d{{1,{MOST_DIGITS}}})\.([1-6])\s*", text)
    return None if match is None else (number, int(match[1]), int(match[2]) - 1)


def _ordered(number: ndarray, node: ndarray, axis: ndarray, path: Path) -> Equations:
    """By equation number, which must run from 1 without a gap or a repetition."""
    order = np.argsort(number, kind="stable")
    wrong = np.flatnonzero(number[order] != np.arange(1, len(number) + 1))
    if len(wrong) or not len(number):
        got = f"{number[order][wrong[0]]} as number {wrong[0] + 1}" if len(wrong) else "none"
        raise ValueError(f"expected equations 1, 2, 3, ... each once, got {got} ({path})")
    pairs = node * 6 + axis
    if len(np.unique(pairs)) < len(pairs):
        raise ValueError(f"expected one equation for each node and direction, got several ({path})")
    return Equations(node[order], axis[order])
