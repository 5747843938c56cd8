"""Where a decay starts and ends in an envelope: its largest fall, and the kink at the release."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray


def largest_fall(level: Float[ndarray, " frame"], rise: float) -> tuple[int, int]:
    """Peak and trough (indices) of the largest fall that no rise by more than `rise` breaks."""
    best, found = 0.0, (0, 0)
    peak = trough = 0
    for k in range(1, level.size):
        if level[k] > level[trough] + rise or level[k] > level[peak]:
            peak = trough = k
        elif level[k] < level[trough]:
            trough = k
        if level[peak] - level[trough] > best:
            best, found = level[peak] - level[trough], (peak, trough)
    return found


def release_kink(
    level: Float[ndarray, " frame"],
    phase: Float[ndarray, " frame"],
    first: int,
    last: int,
    reach: int,
    ratio: float = 3.0,
) -> int | None:
    """Frame between `first` and `last` where a steady oscillation is let go, or None.

    At each candidate two straight lines with a bend (the later one curved) are compared with one
    smooth cubic over `reach` frames before and after, for log-envelope and phase together. The
    bend is accepted where it leaves `ratio` times less misfit and the envelope's slope before is
    less than half the slope after. Of several as good, the last one is taken.
    """
    x = np.arange(-reach, reach + 1) / reach
    bend = np.stack([np.ones_like(x), np.minimum(x, 0), np.maximum(x, 0), np.maximum(x, 0) ** 2], 1)
    cubic = np.vander(x, 4)
    # frames near the bend are rounded by their own length
    clear = np.abs(x * reach) > 2.5
    bend, cubic = bend[clear], cubic[clear]
    first, last = max(first, reach), min(last, level.size - reach - 1)
    if last < first:
        return None
    pieces = np.arange(first, last + 1)[:, None] + np.arange(-reach, reach + 1)[clear]
    kinked, smooth, slopes = 0.0, 0.0, None
    for y in (level[pieces], phase[pieces]):
        y = y - y.mean(axis=1, keepdims=True)
        value = y @ np.linalg.pinv(bend).T
        slopes = value if slopes is None else slopes
        kinked = kinked + ((y - value @ bend.T) ** 2).sum(axis=1) + 1e-12 * clear.sum()
        smooth = smooth + ((y - y @ np.linalg.pinv(cubic).T @ cubic.T) ** 2).sum(axis=1)
    gain = smooth / kinked
    gain[(slopes[:, 2] >= 0.0) | (slopes[:, 1] <= 0.5 * slopes[:, 2])] = 0.0
    if gain.max() < ratio:
        return None
    close = np.flatnonzero(gain > max(ratio, 0.3 * gain.max()))
    # the last run of good candidates, and the best in it
    run = close[np.flatnonzero(np.diff(close, prepend=-9) > 3)[-1] :][0]
    late = gain[run:]
    return int(first + run + np.argmax(late))
