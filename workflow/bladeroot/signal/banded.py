"""Symmetric positive definite matrices of a narrow band: solution, and the inverse in the band.

A matrix is stored as its lower band, row j holding the elements (j, j), (j + 1, j), ... below the
diagonal of column j; what would lie beyond the last row is zero.
"""

from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from bladeroot.compiled import njit


def solution(
    band: Float[ndarray, "n width"], right: Float[ndarray, " n"]
) -> tuple[Float[ndarray, " n"], Float[ndarray, "n width"]]:
    """The matrix's inverse times a vector, and the inverse within the band.

    LinAlgError where the matrix is not positive definite.
    """
    n, width = band.shape
    if not (band[:, 0] > 0.0).all():
        raise LinAlgError("a diagonal element is not positive")
    scale = band[:, 0] ** -0.5
    beside = np.pad(scale, (0, width - 1))[np.arange(n)[:, None] + np.arange(width)]
    beside *= scale[:, None]
    balanced = band * beside
    balanced[:, 0] = 1.0 + 1e-13
    factor = cholesky_banded(balanced.T, lower=True, check_finite=False)
    x = scale * cho_solve_banded((factor, True), scale * right, check_finite=False)
    if not np.isfinite(x).all():
        raise LinAlgError("the matrix or the vector is not finite")
    return x, inverse_band(factor.T) * beside


def inverse_band(factor: Float[ndarray, "n width"]) -> Float[ndarray, "n width"]:
    """The inverse within the band, from the lower Cholesky factor in the same storage."""
    pivot = factor[:, 0]
    unit = np.ascontiguousarray(factor / pivot[:, None])
    unit[:, 0] = pivot**2
    return _takahashi(unit)


@njit(cache=True)
@no_type_check
def _takahashi(factor: Float[ndarray, "n width"]) -> Float[ndarray, "n width"]:
    """From L D L' with D on the diagonal, from the last element to the first (Takahashi)."""
    n, width = factor.shape
    inverse = np.zeros((n, width))
    column = np.empty(width)
    for j in range(n - 1, -1, -1):
        last = min(width, n - j)
        column[:] = 0.0
        for m in range(1, last):  # along rows, which lie side by side in memory
            share, rest, row = factor[j, m], factor[j, m:], inverse[j + m]
            total = share * row[0]
            for k in range(1, last - m):
                column[m + k] += share * row[k]
                total += rest[k] * row[k]
            column[m] += total
        inverse[j, 0] = 1.0 / factor[j, 0]
        for m in range(1, last):
            inverse[j, m] = -column[m]
            inverse[j, 0] += factor[j, m] * column[m]
    return inverse
