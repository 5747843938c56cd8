"""A first-order high-pass: AC coupling of a conditioner, or a piezoelectric sensor's discharge.

Its response is s/(s + w), so the motion is the reading plus w times the reading's integral. The
straight line that an offset behind the filter becomes is no motion and is taken off.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

EXAMPLE = "high-pass 0.5 Hz"


def undone(
    samples: Float[ndarray, " sample"], sampling_Hz: float, corner_Hz: float
) -> Float[ndarray, " sample"]:
    """The motion before the filter, but for a straight line."""
    steps = 0.5 * (samples[1:] + samples[:-1]) / sampling_Hz
    whole = samples + 2.0 * np.pi * corner_Hz * np.concatenate([[0.0], np.cumsum(steps)])
    time = np.linspace(-1.0, 1.0, whole.size)
    return whole - whole.mean() - time * (time @ whole) / (time @ time)
