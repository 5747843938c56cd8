"""Masing's rules: the loop of a cycle from the curve of first loading.

Unloading and reloading follow the first loading, doubled in both directions (Masing 1926): from
the peak X(A) at q = A, X(q) = X(A) - 2 X_0((A - q) / 2). With q = A cos(theta) the loop's first
harmonic is a pair of integrals over the first loading alone.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.nonlinear.monotone import pieces

_HALF_CYCLE_POINTS = 256  # of the integrals over half a cycle
_LADDER_DIGITS = 12  # decimals of ln amplitude to which ladders must agree to share their weights


def first_harmonic(
    amplitude: Float[ndarray, " amplitude"],
    loading: Float[ndarray, "amplitude quantity"],
    slope: Float[ndarray, " quantity"],
) -> tuple[Float[ndarray, "amplitude quantity"], Float[ndarray, "amplitude quantity"]]:
    """Cosine and sine part of quantities in a cycle of each amplitude.

    amplitude: rising, of the motion q = A cos(theta). loading: quantities on first loading to it;
    slope: their ratio to q while all sticks, which is taken to hold below the smallest amplitude.
    """
    short = slope - loading / amplitude[:, None]  # what is missing to the linear quantity, over q
    ladder = np.round(np.log(amplitude / amplitude[0]), _LADDER_DIGITS)
    cubics = pieces(ladder, short).reshape(-1, short.shape[1])
    mean_cosine, mean_sine = (weight @ cubics for weight in _weights(ladder.tobytes()))
    size = amplitude[:, None]
    return (
        size * (slope + 4.0 / np.pi * mean_cosine),
        -4.0 / np.pi * size * (short - mean_sine),
    )


@lru_cache(maxsize=128)
def _weights(ladder: bytes) -> tuple[ndarray, ndarray]:
    """Integrals over half a cycle, times cos and sin, of a piecewise cubic function of ln q.

    ladder: its knots, ln(A / A_0), as of an array. Rows: amplitudes; columns: a piece's
    coefficients, by falling power, then the pieces. Curves on one ladder share them.
    """
    knots = np.frombuffer(ladder)
    theta = np.pi * (np.arange(_HALF_CYCLE_POINTS) + 0.5) / _HALF_CYCLE_POINTS
    part = np.sin(0.5 * theta) ** 2
    place = np.maximum(knots[:, None] + np.log(part), 0.0)
    piece = np.clip(np.searchsorted(knots, place, side="right") - 1, 0, knots.size - 2)
    power = (place - knots[piece]) ** np.array([3, 2, 1, 0])[:, None, None]
    row = np.arange(knots.size)[:, None]
    shape = (knots.size, 4, knots.size - 1)
    found = []
    for turn in (np.cos(theta), np.sin(theta)):
        weight = np.zeros(shape)
        for k in range(4):
            np.add.at(
                weight[:, k], (row, piece), power[k] * part * turn * np.pi / _HALF_CYCLE_POINTS
            )
        found.append(weight.reshape(knots.size, -1))
    return found[0], found[1]
