"""What several readers share: which matrix is meant, and one stored triangle of a symmetric one."""

from collections.abc import Sequence
from pathlib import Path

import scipy.sparse as sp

# Rows that a model may have, far more than can be solved here; a header may claim any number.
MOST_ROWS = 10_000_000


def check_path(path: Path, expected: str) -> None:
    """Raise ValueError unless there is such a file and its path can be an input of the workflow."""
    if set("{}") & set(str(path)):
        raise ValueError(f"expected a path without braces, which stand for wildcards, got {path}")
    try:
        there = path.is_file()
    except OSError:  # a name that is too long, a folder without the right to look
        there = False
    if not there:
        raise ValueError(f"expected {expected}, got none at {path}")


def check_order(rows: int, where: str) -> None:
    """Raise ValueError for more rows than `MOST_ROWS`: a matrix without entries takes memory."""
    if rows > MOST_ROWS:
        raise ValueError(f"expected {MOST_ROWS} rows at most, got {rows} ({where})")


def choose(names: Sequence[str], variable: str | None, path: str) -> str:
    """The matrix that is asked for, or the only one there is; ValueError if that is not clear."""
    listed = ", ".join(sorted(names)) or "none"
    if variable is None and len(names) == 1:
        return names[0]
    if variable is None:
        raise ValueError(f"expected file#name, as the file holds the matrices {listed} ({path})")
    if variable not in names:
        raise ValueError(f"expected a matrix {variable}, the file holds {listed} ({path})")
    return variable


def refuse_variable(variable: str | None, path: str) -> None:
    """Raise ValueError if a name is given for a format whose files hold one matrix."""
    if variable is not None:
        raise ValueError(
            f"such a file holds one matrix without a name; leave #{variable} out ({path})"
        )


def both_triangles(stored: sp.coo_array, path: str) -> sp.coo_array:
    """The symmetric matrix whose lower or upper triangle is stored; ValueError if both are."""
    check_order(max(stored.shape), path)
    row, column = stored.coords
    below, above = row > column, row < column
    if below.any() and above.any():
        place = int((above if above.sum() < below.sum() else below).nonzero()[0][0])
        raise ValueError(
            "expected one triangle of a symmetric matrix, got entries on both sides of the "
            f"diagonal, such as row {row[place] + 1}, column {column[place] + 1} ({path})"
        )
    strict = sp.coo_array((stored.data * (row != column), (column, row)), shape=stored.shape[::-1])
    return sp.coo_array(stored + strict)
