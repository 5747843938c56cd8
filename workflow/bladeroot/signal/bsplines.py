"""B-splines as a penalised fit needs them: those alive at a point, and derivatives."""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.interpolate import BSpline


def alive_splines(
    x: Float[ndarray, " point"], knots: Float[ndarray, " knot"], degree: int
) -> tuple[Float[ndarray, "point alive"], Int[ndarray, " point"]]:
    """The degree + 1 B-splines that are not zero at each point, and the first one's number.

    On (already padded) knots; beyond the ends the outermost polynomials go on.
    """
    matrix = BSpline.design_matrix(x, knots, degree, extrapolate=True)
    return matrix.data.reshape(-1, degree + 1), matrix.indices[:: degree + 1]


def derivative_rows(
    knots: Float[ndarray, " knot"], degree: int, order: int
) -> Float[ndarray, "row alive"]:
    """From a spline's coefficients to those of its derivative: row j weighs j ... j + order."""
    rows = np.zeros((knots.size - degree - 1, order + 1))
    rows[:, 0] = 1.0
    for done in range(order):
        # the derivative of a spline of degree d is a difference over the width of d knots
        d, left = degree - done, knots[done + 1 :]
        width = left[d : d + len(rows) - 1] - left[: len(rows) - 1]
        difference = -rows[:-1]
        difference[:, 1:] += rows[1:, :-1]
        rows = d / width[:, None] * difference
    return rows
