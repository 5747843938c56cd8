"""Cubics between knots that rise and fall as their values do (Fritsch and Butland 1984).

They are those of SciPy's `PchipInterpolator`, whose checks take longer than fifty knots do.
"""

from typing import no_type_check

import numpy as np

from bladeroot.compiled import njit


@njit(cache=True, error_model="numpy")
@no_type_check
def pieces(x, y):
    """Coefficients (power, piece, quantity), the highest power first, through y (knot, quantity).

    x: rising, three knots at least.
    """
    found = np.empty((4, x.size - 1, y.shape[1]))
    step, slope = x[1:] - x[:-1], np.zeros(x.size)
    for q in range(y.shape[1]):
        rise = (y[1:, q] - y[:-1, q]) / step
        for k in range(1, x.size - 1):
            slope[k] = 0.0
            if rise[k - 1] * rise[k] > 0.0:
                before, after = step[k - 1] + 2.0 * step[k], 2.0 * step[k - 1] + step[k]
                slope[k] = (before + after) / (before / rise[k - 1] + after / rise[k])
        slope[0] = _end(step[0], step[1], rise[0], rise[1])
        slope[-1] = _end(step[-1], step[-2], rise[-1], rise[-2])
        bend = (slope[:-1] + slope[1:] - 2.0 * rise) / step
        found[0, :, q] = bend / step
        found[1, :, q] = (rise - slope[:-1]) / step - bend
        found[2, :, q] = slope[:-1]
        found[3, :, q] = y[:-1, q]
    return found


@njit(cache=True, error_model="numpy")
@no_type_check
def _end(step, next_step, rise, next_rise):
    """Slope at an end: a parabola's, limited so that the cubic stays monotone."""
    slope = ((2.0 * step + next_step) * rise - step * next_rise) / (step + next_step)
    if slope * rise <= 0.0:
        return 0.0
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope


@njit(cache=True, error_model="numpy")
@no_type_check
def interpolated(x, y, at):
    """Values (place, quantity) at places of x; the outer pieces go on beyond the knots."""
    c = pieces(x, y)
    piece = np.minimum(np.maximum(np.searchsorted(x, at, side="right") - 1, 0), x.size - 2)
    found = np.empty((at.size, y.shape[1]))
    for i in range(at.size):
        k, away = piece[i], at[i] - x[piece[i]]
        found[i] = ((c[0, k] * away + c[1, k]) * away + c[2, k]) * away + c[3, k]
    return found
