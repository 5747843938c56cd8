"""Least squares with a random walk in the values, where the normal matrix has no band.

Roots of the normal matrix are used, not the matrix itself: a stiff penalty and what it leaves free
differ by more than floating point resolves.
"""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.linalg import cholesky_banded, solve_banded, solve_triangular


def spread_out(
    shape: Float[ndarray, "row alive"], first: Int[ndarray, " row"], count: int
) -> Float[ndarray, "row n"]:
    """Rows written out in full, of which only some neighbouring elements are not zero."""
    whole = np.zeros((first.size, count))
    np.put_along_axis(whole, first[:, None] + np.arange(shape.shape[1]), shape, axis=1)
    return whole


def whitened(
    values: Float[ndarray, "value column"],
    std: Float[ndarray, " value"],
    walk: Float[ndarray, " value"],
) -> tuple[Float[ndarray, "value column"], float]:
    """Columns made independent, of unit variance; half the ln of their covariance's determinant.

    Errors are `std` and a random walk, of whose steps `walk` has the variances, the first that of
    its start. Each value has the walk's mean over a step about its place, whose variance is a sixth
    of a step's less. The differences of neighbouring values have a covariance of three diagonals.
    """
    own = std**2 - np.minimum(walk, np.append(walk[1:], walk[-1])) / 6.0
    band = np.stack([own + walk, np.append(-own[:-1], 0.0)])
    band[0, 1:] += own[:-1]
    factor = cholesky_banded(band, lower=True)
    white = solve_banded((1, 0), factor, np.diff(values, axis=0, prepend=0.0))
    return white, float(np.log(factor[0]).sum())


def root_of(
    columns: Float[ndarray, "value column"],
    rows: Float[ndarray, "row alive"],
    precision: Float[ndarray, " row"],
) -> Float[ndarray, "column column"]:
    """Triangular root of whitened columns, the last of them data, with a penalty on the others."""
    size = np.sqrt(precision)[:, None] * rows
    penalty = spread_out(size, np.arange(len(rows)), columns.shape[1])
    return np.linalg.qr(np.concatenate([columns, penalty]), "r")


def full_solution(
    root: Float[ndarray, "column column"], width: int
) -> tuple[Float[ndarray, " n"], Float[ndarray, "n width"]]:
    """Coefficients by a root as of `root_of`, and a band of their covariance."""
    inverse = solve_triangular(root[:-1, :-1], np.eye(len(root) - 1))
    covariance = np.pad(inverse @ inverse.T, ((0, 0), (0, width)))
    own = np.arange(len(inverse))[:, None]
    return inverse @ root[:-1, -1], covariance[own, own + np.arange(width)]
