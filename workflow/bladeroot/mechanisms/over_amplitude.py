"""Laws of a size times a course over amplitude, whatever the force: of a spring, or of a loss.

Not a mechanism itself. values: the first mode's size, and the other modes' over it; slopes: of the
course, by what else a form has.
"""

import numpy as np
from numpy import ndarray

from bladeroot.mechanisms.mechanism import CurveEffect, Points


def of_spring(points: Points, values: ndarray, course: ndarray, *slopes: ndarray) -> CurveEffect:
    """Change of ln f; a stiffness without loss of its own takes its part of the loss factor."""
    whole, slope = _of_modes(points, values, course, slopes)
    share = -2.0 * points.loss
    return CurveEffect(whole, share * whole, slope, share[:, None] * slope)


def of_loss(points: Points, values: ndarray, course: ndarray, *slopes: ndarray) -> CurveEffect:
    """Change of the loss factor; the frequency stays."""
    whole, slope = _of_modes(points, values, course, slopes)
    return CurveEffect(np.zeros(whole.size), whole, np.zeros(slope.shape), slope)


def _of_modes(
    points: Points, values: ndarray, course: ndarray, slopes: tuple[ndarray, ...]
) -> tuple[ndarray, ndarray]:
    size, ratio = values
    other = points.mode > 0
    of_mode = np.where(other, ratio, 1.0)
    columns = [of_mode * course, np.where(other, size * course, 0.0)]
    columns += [size * of_mode * slope for slope in slopes]
    return size * of_mode * course, np.stack(columns, axis=1)
