"""A thermometer's readings as a temperature that changes slowly, with what is left unknown of it.

Stick frequencies tell a change of temperature a hundred times finer than a thermometer does. Beside
readings taken as they are, any drift would fit better than the temperature that they are of.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import cho_factor, cho_solve

# How fast a temperature changes (s), and by how much single readings are off it (K): of all pairs
# the most likely one counts. Readings are rounded to a tenth of a kelvin at best.
PACES = 3600.0 * np.array([0.5, 1.0, 2.0, 4.0, 8.0])
OFF = np.array([0.03, 0.06, 0.12, 0.25, 0.5])
WIDEST = 2.0  # of the course beforehand, times the readings' range


def course(
    time: Float[ndarray, " record"], read: Float[ndarray, " record"]
) -> tuple[Float[ndarray, " record"], Float[ndarray, "record record"]]:
    """Temperature at the records' times (s), K off its mean, and its covariance (K^2).

    read: degrees. Records of one time have one reading. A Gaussian process (Matern 5/2).
    """
    at, back = np.unique(time, return_inverse=True)
    count = np.bincount(back)
    mean = np.bincount(back, read - read.mean()) / count
    size = max(WIDEST * float(np.ptp(read)), OFF[0])
    best, made = -np.inf, None
    for pace in PACES:
        away = np.sqrt(5.0) * np.abs(at[:, None] - at) / pace
        alike = size**2 * (1.0 + away + away**2 / 3.0) * np.exp(-away)
        for off in OFF:
            factor = cho_factor(alike + off**2 * np.eye(at.size), lower=True)
            weighted = cho_solve(factor, mean)
            likely = -0.5 * mean @ weighted - np.log(np.diag(factor[0])).sum()
            if likely > best:
                best = likely
                made = alike @ weighted, alike - alike @ cho_solve(factor, alike)
    value, covariance = made
    return (value - value[back].mean())[back], covariance[np.ix_(back, back)]
