"""The onset of a joint that stops slipping within a cycle, faster than a law over blocks can tell.

One Coulomb contact alone may take half of the amplitude in the last slipping cycle and stick from
the next turning point on. The critical amplitude is then that of the plateau, carried back to the
moment of capture: where the fall of the last slipping blocks meets the plateau's line.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.signal.runs import medians

# A block slips where its ln A lies above the plateau's line by both of these.
SLIPPING_LEVEL = 0.1  # in ln A; the last fall, from one block to the next, is larger than this too
SLIPPING_ERRORS = 5.0  # standard errors
# The fall is sudden where at most this share of the height two blocks before is left after it.
LEFT_AFTER_FALL = 0.1
FEWEST_SETTLED = 5  # blocks from the last one that slips on, itself counted, at least
MOMENT_STD = 0.3  # blocks: error of the moment of capture, from sliders of known critical amplitude
NEAR_BLOCKS = 9  # around a block, whose median error is its own at most


def sudden_onset(
    time: Float[ndarray, " block"],
    log: Float[ndarray, " block"],
    std: Float[ndarray, " block"],
    rate: float,
) -> tuple[float, float, float] | None:
    """ln of the amplitude at a sudden capture, its standard error, and ln A where all has settled.

    None where there is none.

    log: ln A of the blocks. rate: of ln A on the plateau.
    """
    # the blocks of a capture often have large errors, as they lie off any smooth curve
    around = np.pad(std, NEAR_BLOCKS // 2, mode="edge")
    calm = medians(np.lib.stride_tricks.sliding_window_view(around, NEAR_BLOCKS))
    std = np.minimum(std, calm)
    above = log - rate * time
    sharp = above[std < 2.0 * np.median(std)]
    above = above - np.median(sharp[-sharp.size // 4 :])
    slipping = np.flatnonzero(above > np.maximum(SLIPPING_LEVEL, SLIPPING_ERRORS * std))
    if not slipping.size or not 1 <= slipping[-1] <= time.size - FEWEST_SETTLED:
        return None
    last = int(slipping[-1])
    weight = std[last + 2 :] ** -2.0
    level = float(above[last + 2 :] @ weight / weight.sum())
    before, here, after = above[last - 1 : last + 2] - level
    if (
        abs(after) > max(LEFT_AFTER_FALL * before, 3.0 * std[last + 1])
        or before < here + SLIPPING_LEVEL
    ):
        return None
    step = time[last] - time[last - 1]
    at = time[last] + min(here / (before - here), 2.0) * step
    width = np.hypot(MOMENT_STD * abs(rate) * step, weight.sum() ** -0.5)
    line = log[last] - here  # the plateau's, at the last slipping block
    return float(line + rate * (at - time[last])), float(width), float(log[last + 3])
