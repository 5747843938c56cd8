"""Laws of a size times a course over amplitude, whatever the force: of a spring, or of a loss.

Not a mechanism itself. values: the first mode's size, and the other modes' over it; slopes: of the
course, by what else a form has.
"""

import numpy as np
from numpy import ndarray

from bladeroot.mechanisms.mechanism import CurveEffect, Parameter, Points

# A stretched beam loses as any part of it does, a steel spring hardly anything, a stop more. What
# FREEVIB finds of a hysteretic one turns by as much with the slope of its frequency.
OWN_LOSS = Parameter(
    "own_loss", "1", 1.0, 1.5, 0.0, 3.0, "loss factor of the spring over the mode's", bounded=True
)


def of_spring(points: Points, values: ndarray, course: ndarray, *slopes: ndarray) -> CurveEffect:
    """Change of ln f, and of the loss factor where the spring loses less or more than the mode.

    values: third, its own loss factor over the mode's (OWN_LOSS).
    """
    whole, slope = _of_modes(points, values[:2], course, slopes)
    share = -2.0 * points.loss * (1.0 - values[2])
    loss_slope = np.insert(share[:, None] * slope, 2, 2.0 * points.loss * whole, axis=1)
    return CurveEffect(whole, share * whole, np.insert(slope, 2, 0.0, axis=1), loss_slope)


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
