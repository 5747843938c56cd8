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
    least: int = 80,
) -> Float[ndarray, " block"]:
    """Observed over assumed standard error of the blocks, running along the record.

    From second differences of what a smooth curve misses: noise near the mode that is not that of
    the full band, remains of other modes and a wrong noise level all show here. Windows, at
    most `most` and of at least `least` blocks, since a scatter known too roughly spoils every
    standard error that rests on it; knocks are cut off.
    """
    count = std.size
    if count < 12:
        return np.ones(count)
    scaled = miss / std
    square = (scaled[:, 2:] - 2.0 * scaled[:, 1:-1] + scaled[:, :-2]) ** 2 / 6.0
    windows = int(np.clip(count // least, 1, most))
    edges = np.linspace(0, square.shape[1], windows + 1).astype(int)
    centre, level = [], []
    for start, stop in zip(edges[:-1], edges[1:], strict=True):
        more = (stop - start) // 2  # half a window more on either side
        near = square[:, max(start - more, 0) : stop + more].ravel()
        mean = np.median(near) / 0.4549
        for _ in range(3):
            mean = np.minimum(near, _LIMIT**2 * mean).mean() / _CUT_MEAN
        level.append(np.sqrt(mean))
        centre.append(0.5 * (start + stop) + 1.0)
    return np.interp(np.arange(count), centre, level)
