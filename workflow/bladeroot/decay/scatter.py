"""How much the blocks of a record really scatter, against the error assumed for them."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

# Squares of normal values beyond 2.5 standard errors are cut to that; this is then their mean.
_LIMIT = 2.5
_CUT_MEAN = 0.9765


def noise_ratio(
    miss: Float[ndarray, "part block"],
    std: Float[ndarray, " block"],
    most: int = 12,
    least: int = 120,
) -> Float[ndarray, " block"]:
    """Observed over assumed standard error of the blocks, running along the record.

    From second differences of what a smooth curve misses: noise near the mode that is not that of
    the full band, remains of other modes and a wrong noise level all show here. Windows, at
    most `most` and of at least `least` blocks, since a scatter known too roughly spoils every
    standard error that rests on it; knocks are cut off.
    """
    count = std.size - 2
    if count < 10:
        return np.ones(std.size)
    scaled = miss / std
    square = (scaled[:, 2:] - 2.0 * scaled[:, 1:-1] + scaled[:, :-2]) ** 2 / 6.0
    windows = int(np.clip(count // least, 1, most))
    length = count // windows
    near = square[:, : windows * length].reshape(-1, windows, length)
    near = near.transpose(1, 0, 2).reshape(windows, -1)
    mean = np.median(near, axis=1, keepdims=True) / 0.4549
    for _ in range(3):
        mean = np.minimum(near, _LIMIT**2 * mean).mean(axis=1, keepdims=True) / _CUT_MEAN
    centre = (np.arange(windows) + 0.5) * length + 0.5
    return np.sqrt(np.interp(np.arange(std.size), centre, mean[:, 0]))
