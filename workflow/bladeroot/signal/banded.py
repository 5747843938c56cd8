"""Symmetric positive definite matrices of a narrow band: factor, solution, inverse in the band.

A matrix is stored as its lower band, row j holding the elements (j, j), (j + 1, j), ... below the
diagonal of column j; what would lie beyond the last row is zero.
"""

from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.compiled import njit


@njit(cache=True)
@no_type_check
def factored(
    band: Float[ndarray, "n width"],
) -> tuple[Float[ndarray, " n"], Float[ndarray, "n width"], bool]:
    """What balances the matrix, L D L' of the balanced one (D on the diagonal), and success."""
    n, width = band.shape
    scale = np.empty(n)
    for j in range(n):
        scale[j] = 1.0 / np.sqrt(band[j, 0])
    factor = np.zeros((n, width))
    for j in range(n):
        factor[j, 0] = 1.0 + 1e-13
        for k in range(1, min(width, n - j)):
            factor[j, k] = band[j, k] * scale[j] * scale[j + k]
    for j in range(n):
        pivot = factor[j, 0]
        if not pivot > 0.0:
            return scale, factor, False
        last = min(width, n - j)
        for a in range(1, last):
            share = factor[j, a] / pivot
            for b in range(a, last):
                factor[j + a, b - a] -= share * factor[j, b]
        for a in range(1, last):
            factor[j, a] /= pivot
    return scale, factor, True


@njit(cache=True)
@no_type_check
def solved(
    scale: Float[ndarray, " n"], factor: Float[ndarray, "n width"], right: Float[ndarray, " n"]
) -> Float[ndarray, " n"]:
    """The matrix's inverse times a vector."""
    n, width = factor.shape
    x = np.empty(n)
    for j in range(n):
        x[j] = right[j] * scale[j]
    for j in range(n):
        for k in range(1, min(width, n - j)):
            x[j + k] -= factor[j, k] * x[j]
    for j in range(n - 1, -1, -1):
        x[j] /= factor[j, 0]
        for k in range(1, min(width, n - j)):
            x[j] -= factor[j, k] * x[j + k]
    for j in range(n):
        x[j] *= scale[j]
    return x


@njit(cache=True)
@no_type_check
def inverse_band(
    scale: Float[ndarray, " n"], factor: Float[ndarray, "n width"]
) -> Float[ndarray, "n width"]:
    """The inverse within the band, from the last element to the first (Takahashi's equations)."""
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
    for j in range(n):
        for k in range(min(width, n - j)):
            inverse[j, k] *= scale[j] * scale[j + k]
    return inverse
