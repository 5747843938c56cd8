"""Masing's rules: the loop of a cycle from the curve of first loading.

Unloading and reloading follow the first loading, doubled in both directions (Masing 1926): from
the peak X(A) at q = A, X(q) = X(A) - 2 X_0((A - q) / 2). With q = A cos(theta) the loop's first
harmonic is a pair of integrals over the first loading alone.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.interpolate import PchipInterpolator

_POINTS = 256  # of half a cycle


def first_harmonic(
    amplitude: Float[ndarray, " amplitude"],
    loading: Float[ndarray, "amplitude quantity"],
    slope: Float[ndarray, " quantity"],
) -> tuple[Float[ndarray, "amplitude quantity"], Float[ndarray, "amplitude quantity"]]:
    """Cosine and sine part of quantities in a cycle of each amplitude.

    amplitude: rising, of the motion q = A cos(theta). loading: quantities on first loading to it;
    slope: their ratio to q while all sticks, which is taken to hold below the smallest amplitude.
    """
    short = slope - loading / amplitude[:, None]  # what is missing to linear, over q
    curve = PchipInterpolator(np.log(amplitude), short, axis=0)
    theta = np.pi * (np.arange(_POINTS) + 0.5) / _POINTS
    part = np.sin(0.5 * theta) ** 2
    q = np.maximum(amplitude[:, None] * part, amplitude[0])
    inner = part[:, None] * curve(np.log(q))  # (amplitude, theta, quantity)
    size = amplitude[:, None]
    mean_cosine = np.einsum("atq,t->aq", inner, np.cos(theta)) * np.pi / _POINTS
    mean_sine = np.einsum("atq,t->aq", inner, np.sin(theta)) * np.pi / _POINTS
    return (
        size * (slope + 4.0 / np.pi * mean_cosine),
        -4.0 / np.pi * size * (short - mean_sine),
    )
