"""Small text tables: nodes, contact pairs, fixed nodes."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.rom.external.reading import check_path

MOST_DIGITS = 18  # of a whole number, so that it fits 64 bits


@dataclass(frozen=True)
class Table:
    """Cells as text by column, with the line of each row in the file."""

    path: Path
    lines: list[int]
    columns: dict[str, list[str]]

    def where(self, row: int) -> str:
        """Where a row stands, for a message."""
        return f"{self.path}, row {self.lines[row]}"


def read_table(path: Path, required: Sequence[str], optional: Sequence[str] = ()) -> Table:
    """A table with a header, split by commas, semicolons or tabs; lines with # are left out.

    Raises ValueError, one line, for a missing file, a missing or unknown column, a short row.
    """
    check_path(path, f"a table with columns {', '.join(required)}")
    with open(path, encoding="utf-8-sig", errors="replace", newline="") as file:
        numbered = [(k, line) for k, line in enumerate(file, 1) if line.strip(" \t,;\r\n")]
    numbered = [(k, line) for k, line in numbered if not line.startswith("#")]
    if not numbered:
        raise ValueError(f"expected columns {', '.join(required)}, got an empty table ({path})")
    separator = max(",;\t", key=numbered[0][1].count)
    rows = [
        [c.strip() for c in row]
        for row in csv.reader((s for _, s in numbered), delimiter=separator)
    ]
    header, cells = rows[0], rows[1:]
    missing = [name for name in required if name not in header]
    unknown = [name for name in header if name not in (*required, *optional)]
    if missing or unknown:
        extra = f" (optional: {', '.join(optional)})" if optional else ""
        raise ValueError(
            f"expected columns {', '.join(required)}{extra}, got {', '.join(header)} ({path})"
        )
    lines = [k for k, _ in numbered[1:]]
    for line, row in zip(lines, cells, strict=True):
        if len(row) != len(header):
            raise ValueError(f"expected {len(header)} cells, got {len(row)} ({path}, row {line})")
    if not cells:
        raise ValueError(f"expected rows below {', '.join(header)}, got none ({path})")
    columns = {name: [row[k] for row in cells] for k, name in enumerate(header)}
    return Table(path, lines, columns)


def floats(table: Table, name: str) -> Float[ndarray, " row"]:
    """A column of finite numbers; ValueError names the first row that is none."""
    cells = table.columns[name]
    try:
        values = np.array(cells, dtype=float)
    except ValueError:
        values = np.array([_number(cell) for cell in cells])
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        raise ValueError(
            f"{name} must be a finite number, got {cells[bad[0]]!r} ({table.where(int(bad[0]))})"
        )
    return values


def whole_numbers(table: Table, name: str, empty: int | None = None) -> Int[ndarray, " row"]:
    """A column of whole numbers from 1; empty cells are `empty`, if that is given."""
    cells = table.columns[name]
    result = np.empty(len(cells), dtype=np.int64)
    for k, cell in enumerate(cells):
        if not cell and empty is not None:
            result[k] = empty
        elif cell.isascii() and cell.isdigit() and len(cell) <= MOST_DIGITS and int(cell) > 0:
            result[k] = int(cell)
        else:
            raise ValueError(
                f"{name} must be a whole number from 1, of {MOST_DIGITS} digits at most, got "
                f"{cell[:60]!r} ({table.where(k)})"
            )
    return result


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return np.nan
