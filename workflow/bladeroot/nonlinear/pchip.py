"""Monotone piecewise cubic interpolation of many rows at once (Fritsch and Butland 1984).

As scipy's `PchipInterpolator`, whose checks cost more than short rows do.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray


def pieces(
    x: Float[ndarray, " knot"], y: Float[ndarray, "knot row"]
) -> Float[ndarray, "4 piece row"]:
    """Coefficients of each piece by falling power of the distance from its first knot.

    x: rising, three or more.
    """
    step = np.diff(x)[:, None]
    chord = np.diff(y, axis=0) / step
    slope = np.zeros_like(y)
    before, after = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (before / chord[:-1] + after / chord[1:]) / (before + after)
        slope[1:-1] = np.where(chord[:-1] * chord[1:] > 0.0, 1.0 / mean, 0.0)
    slope[0] = _at_end(step[0], step[1], chord[0], chord[1])
    slope[-1] = _at_end(step[-1], step[-2], chord[-1], chord[-2])
    bend = (slope[:-1] + slope[1:] - 2.0 * chord) / step
    return np.stack([bend / step, (chord - slope[:-1]) / step - bend, slope[:-1], y[:-1]])


def _at_end(near, far, first, second) -> Float[ndarray, " row"]:
    """Slope at an end by three points, of the first chord's sign and at most three times it."""
    slope = ((2.0 * near + far) * first - near * second) / (near + far)
    slope = np.where(np.sign(slope) == np.sign(first), slope, 0.0)
    steep = (np.sign(first) != np.sign(second)) & (np.abs(slope) > 3.0 * np.abs(first))
    return np.where(steep, 3.0 * first, slope)


def evaluate(
    x: Float[ndarray, " knot"], made: Float[ndarray, "4 piece row"], at: Float[ndarray, " place"]
) -> Float[ndarray, "place row"]:
    """The pieces on their knots at places; beyond the ends the last piece goes on."""
    piece = np.clip(np.searchsorted(x, at, side="right") - 1, 0, x.size - 2)
    away = (at - x[piece])[:, None]
    cubic, square, linear, constant = made[:, piece]
    return ((cubic * away + square) * away + linear) * away + constant
