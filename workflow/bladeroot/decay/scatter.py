"""How much the blocks of a record really scatter, against the error assumed for them."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

# Fourth differences of white values of unit variance have this variance, whatever cubic they ride.
_SPREAD = 70.0


def noise_ratio(
    miss: Float[ndarray, "part block"], std: Float[ndarray, " block"], windows: int = 12
) -> Float[ndarray, " block"]:
    """Observed over assumed standard error of the blocks, running along the record.

    From fourth differences of what a smooth curve misses: coloured noise, remains of other modes
    and a wrong noise level all show here. The median in each of some windows ignores knocks.
    """
    count = std.size
    if count < 12:
        return np.ones(count)
    scaled = miss / std
    rough = np.diff(scaled, 4, axis=1) ** 2 / _SPREAD
    windows = max(1, min(windows, count // 24))
    edges = np.linspace(0, rough.shape[1], windows + 1).astype(int)
    centre, level = [], []
    for start, stop in zip(edges[:-1], edges[1:], strict=True):
        # half a window more on either side
        more = (stop - start) // 2
        near = rough[:, max(start - more, 0) : stop + more]
        level.append(np.sqrt(np.median(near) / 0.4549))
        centre.append(0.5 * (start + stop) + 2.0)
    return np.interp(np.arange(count), centre, level)
