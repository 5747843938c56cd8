"""The onset of a joint that stops slipping within a cycle, faster than a law over blocks can tell.

One Coulomb contact alone may take half of the amplitude in the last slipping cycle and stick from
the next turning point on. The critical amplitude is then that of the plateau, carried back to the
moment of capture: where the fall of the last slipping blocks meets the plateau's line.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.signal.runs import medians

SUDDEN = 0.1  # ln A above the plateau's line of a block that slips
LEFT = 0.1  # largest share, of what a sudden fall had two blocks before, that may be left after it
WITHIN = 0.3  # blocks: standard error of the moment, from sliders of known critical amplitude
ERRORS = 5.0  # standard errors of a block above the plateau's line while it slips
SETTLED = 5  # blocks after it at least
NEAR = 9  # blocks whose median error is that of any one of them


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
    # the very blocks of a capture are often given large errors, as they are off all smooth curves
    around = np.pad(std, NEAR // 2, mode="edge")
    calm = medians(np.lib.stride_tricks.sliding_window_view(around, NEAR))
    std = np.minimum(std, calm)
    above = log - rate * time
    sharp = above[std < 2.0 * np.median(std)]
    above = above - np.median(sharp[-sharp.size // 4 :])
    slipping = np.flatnonzero(above > np.maximum(SUDDEN, ERRORS * std))
    if not slipping.size or not 1 <= slipping[-1] <= time.size - SETTLED:
        return None
    last = int(slipping[-1])
    weight = std[last + 2 :] ** -2.0
    level = float(above[last + 2 :] @ weight / weight.sum())
    before, here, after = above[last - 1 : last + 2] - level
    if abs(after) > max(LEFT * before, 3.0 * std[last + 1]) or before < here + SUDDEN:
        return None
    step = time[last] - time[last - 1]
    at = time[last] + min(here / (before - here), 2.0) * step
    width = np.hypot(WITHIN * abs(rate) * step, weight.sum() ** -0.5)
    line = log[last] - here  # the plateau's, at the last slipping block
    return float(line + rate * (at - time[last])), float(width), float(log[last + 3])
