"""What several readers share: which matrix is meant, and one stored triangle of a symmetric one."""

from collections.abc import Sequence

import scipy.sparse as sp


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
