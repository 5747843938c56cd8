"""Symmetric positive definite matrices of a narrow band: solution, and the inverse in the band.

A matrix is stored as its lower band, row j holding the elements (j, j), (j + 1, j), ... below the
diagonal of column j; what would lie beyond the last row is zero.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
from scipy.linalg.lapack import dtrtri

# Rows of a block at least: on smaller blocks calls cost more than their arithmetic.
FEWEST_BLOCK_ROWS = 16


def lower_band(whole: Float[ndarray, "n n"], width: int) -> Float[ndarray, "n width"]:
    """The lower band of a symmetric matrix."""
    padded = np.pad(whole, ((0, 0), (0, width)))
    own = np.arange(len(whole))[:, None]
    return padded[own, own + np.arange(width)]


def solution(
    band: Float[ndarray, "n width"], right: Float[ndarray, " n"]
) -> tuple[Float[ndarray, " n"], Float[ndarray, "n width"], Callable[[ndarray], ndarray]]:
    """The inverse times a vector, the inverse within the band, and what multiplies columns by it.

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

    def times(columns: Float[ndarray, "n column"]) -> Float[ndarray, "n column"]:
        balanced = scale[:, None] * columns
        return scale[:, None] * cho_solve_banded((factor, True), balanced, check_finite=False)

    x = times(right[:, None])[:, 0]
    if not np.isfinite(x).all():
        raise LinAlgError("the matrix or the vector is not finite")
    return x, inverse_band(factor.T) * beside, times


def inverse_band(factor: Float[ndarray, "n width"]) -> Float[ndarray, "n width"]:
    """The inverse within the band, from the lower Cholesky factor in the same storage.

    Blocks as long as the band is wide (or `FEWEST_BLOCK_ROWS`) are coupled to the next one only;
    from the last to the first, a block of the inverse follows from the one behind it (Takahashi).
    """
    n, width = factor.shape
    size = max(width, FEWEST_BLOCK_ROWS)
    blocks = -(-n // size)
    # beyond the end, an identity
    padded = np.zeros(((blocks + 1) * size, width))
    padded[:n], padded[n:, 0] = factor, 1.0
    down, across = np.arange(2 * size)[:, None], np.arange(size)
    lag = down - across
    inside = (lag >= 0) & (lag < width)
    lag = np.where(inside, lag, 0)
    rows = np.arange(blocks)[:, None, None] * size + across
    whole = np.where(inside, padded[rows, lag], 0.0)
    later, inverse = np.eye(size), np.empty((blocks, 2 * size, size))
    for k in range(blocks - 1, -1, -1):
        pivot = dtrtri(whole[k, :size], lower=1)[0]
        ratio = whole[k, size:] @ pivot
        beside = -later @ ratio
        later = pivot.T @ pivot - ratio.T @ beside
        inverse[k] = np.concatenate([later, beside])
    at = np.minimum(np.arange(width) + across[:, None], 2 * size - 1)
    found = inverse[:, at, across[:, None]].reshape(-1, width)[:n]
    return np.where(np.arange(n)[:, None] + np.arange(width) < n, found, 0.0)
