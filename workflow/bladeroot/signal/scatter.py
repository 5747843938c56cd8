"""How much the blocks of a record really scatter, and which of them are not to be trusted."""

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
    least: int = 80,
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


def without_knocks(
    miss: Float[ndarray, "part block"],
    std: Float[ndarray, " block"],
    window: int = 9,
    limit: float = 6.0,
) -> Float[ndarray, " block"]:
    """Larger standard errors for the few blocks that a knock or a glitch threw off.

    Such a block lies far from the straight line through its neighbours (by medians), on what a
    smooth curve misses. At the ends the window shifts inwards.
    """
    count = std.size
    jump = np.abs(np.diff(miss, 2, axis=1)).max(axis=0) / np.sqrt(6.0)
    if count < 2 * window or not (jump > limit * std[1:-1]).any():
        return std
    own = np.arange(count)
    start = np.clip(own - window // 2, 0, count - window)
    near = miss[:, start[:, None] + np.arange(window)]
    slope = np.median(np.diff(near, axis=2), axis=2)
    level = np.median(near - slope[:, :, None] * np.arange(window), axis=2)
    off = np.abs(miss - level - slope * (own - start)).max(axis=0)
    return np.where(off > limit * std, np.maximum(off, std), std)
