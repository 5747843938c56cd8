"""B-splines as a penalised fit needs them: those alive at a point, derivatives, polynomials."""

from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.compiled import njit


@njit(cache=True)
@no_type_check
def alive_splines(
    x: Float[ndarray, " point"], knots: Float[ndarray, " knot"], degree: int
) -> tuple[Float[ndarray, "point alive"], Int[ndarray, " point"]]:
    """The degree + 1 B-splines that are not zero at each point, and the first one's number.

    By the recursion of Cox and de Boor on (already padded) knots; beyond the ends the outermost
    polynomials go on.
    """
    value, first = np.empty((x.size, degree + 1)), np.empty(x.size, np.int64)
    for p in range(x.size):
        cell, last = degree, knots.size - degree - 2
        while cell < last:  # by halves: the last knot that is not beyond the point
            middle = (cell + last + 1) // 2
            if knots[middle] <= x[p]:
                cell = middle
            else:
                last = middle - 1
        first[p] = cell - degree
        value[p, 0] = 1.0
        for d in range(1, degree + 1):
            kept = 0.0
            for k in range(d):
                right = knots[cell + 1 + k] - x[p]
                left = x[p] - knots[cell + 1 + k - d]
                share = value[p, k] / (right + left)
                value[p, k] = kept + share * right
                kept = share * left
            value[p, d] = kept
    return value, first


@njit(cache=True)
@no_type_check
def derivative_rows(
    knots: Float[ndarray, " knot"], degree: int, order: int
) -> Float[ndarray, "row alive"]:
    """From a spline's coefficients to those of its derivative: row j weighs j ... j + order."""
    count = knots.size - degree - 1
    rows = np.zeros((count, order + 1))
    rows[:, 0] = 1.0
    for done in range(order):
        d = degree - done
        for j in range(count - done - 1):
            # the derivative of a spline of degree d is a difference over the width of d knots
            share = d / (knots[done + 1 + j + d] - knots[done + 1 + j])
            for k in range(done + 1, -1, -1):
                below = rows[j + 1, k - 1] if k > 0 else 0.0
                above = rows[j, k] if k <= done else 0.0
                rows[j, k] = share * (below - above)
    return rows[: count - order]


@njit(cache=True)
@no_type_check
def polynomials(
    knots: Float[ndarray, " knot"], coefficient: Float[ndarray, "part n"], degree: int
) -> tuple[Float[ndarray, " piece"], Float[ndarray, "power part piece"]]:
    """Where each polynomial piece of the splines starts, and its powers of the distance from there.

    A power's coefficient is a derivative at the start, over its factorial.
    """
    parts, pieces = coefficient.shape[0], knots.size - 2 * degree - 1
    start = knots[degree : degree + pieces]
    power = np.zeros((degree + 1, parts, pieces))
    factorial = 1.0
    for order in range(degree + 1):
        factorial *= max(order, 1)
        inner = knots[order : knots.size - order]
        shape, _ = alive_splines(start, inner, degree - order)
        rows = derivative_rows(knots, degree, order)
        for part in range(parts):
            for piece in range(pieces):
                total = 0.0
                for a in range(degree + 1 - order):
                    for b in range(order + 1):
                        own = rows[piece + a, b] * coefficient[part, piece + a + b]
                        total += shape[piece, a] * own
                power[order, part, piece] = total / factorial
    return start, power
