"""B-splines as a penalised fit needs them: those alive at a point, and their derivatives."""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray


def alive_splines(
    x: Float[ndarray, " point"], knots: Float[ndarray, " knot"], degree: int
) -> tuple[Float[ndarray, "point alive"], Int[ndarray, " point"]]:
    """The degree + 1 B-splines that are not zero at each point, and the first one's number.

    By the recursion of Cox and de Boor on (already padded) knots; beyond the ends the outermost
    polynomials go on.
    """
    cell = np.searchsorted(knots, x, side="right") - 1
    cell = np.clip(cell, degree, knots.size - degree - 2)
    value = np.zeros((degree + 1, x.size))
    value[0] = 1.0
    left = x - knots[cell - np.arange(degree)[:, None]]
    right = knots[cell + 1 + np.arange(degree)[:, None]] - x
    for d in range(1, degree + 1):
        before = left[d - 1 :: -1]
        share = value[:d] / (right[:d] + before)
        value[1 : d + 1] = share * before
        value[0] = 0.0
        value[:d] += share * right[:d]
    return np.ascontiguousarray(value.T), cell - degree


def derivative_rows(
    knots: Float[ndarray, " knot"], degree: int, order: int
) -> Float[ndarray, "row alive"]:
    """From a spline's coefficients to those of its derivative: row j weighs j ... j + order."""
    rows = np.ones((knots.size - degree - 1, 1))
    for d in range(degree, degree - order, -1):
        inner = knots[degree - d : knots.size - degree + d]
        width = inner[d + 1 : d + rows.shape[0]] - inner[1 : rows.shape[0]]
        step = np.zeros((rows.shape[0] - 1, rows.shape[1] + 1))
        step[:, 1:] += rows[1:]
        step[:, :-1] -= rows[:-1]
        rows = step * (d / width)[:, None]
    return rows
