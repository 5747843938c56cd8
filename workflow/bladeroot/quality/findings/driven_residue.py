"""Something still drives the mode: its amplitude stops falling well above the noise."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.quality.examined import Examined, Finding

STATISTIC = (
    "decay rate from a half to 80 % of the fall (of ln A) over that of the last tenth; "
    "0.3 of it where the decay no longer slows"
)
THRESHOLD = 3.0
# Whether the decay still slows. While a joint sticks, ln A falls at one rate; that of a driven mode
# falls ever more slowly.
STILL_SLOWING = 0.6  # rate of the last tenth over that of the tenth two before it, at most
STEADY_FACTOR = 0.3  # times the statistic if it does not: only a ratio that no joint has counts
# What the last tenth is compared with.
FEWEST_FRAMES = 80  # frames, a cycle apart, that the decay has at least
USUAL_FALL = (0.5, 0.8)  # parts of the whole fall of ln A between which the usual rate is taken
# A slope counts as the steepest that its errors allow.
SLOPE_ERRORS = 6.0  # standard errors that are taken off it
FLATTEST_SLOPE = 1e-3  # it counts as this part of the usual one at least, as it divides
MASK_BELOW = 5.0  # all below this many times the last amplitude is masked


def find(seen: Examined) -> Finding | None:
    """Compare the slope of ln A in the last tenth with the usual one."""
    frames = seen.frames
    level = frames.log.real[: frames.clear]
    if level.size < FEWEST_FRAMES:
        return None
    part = level.size // 10
    tail = slice(level.size - part, level.size)
    std = frames.std[: level.size]
    slope, earlier = (_steepest(level, std, level.size - k * part, part) for k in (1, 3))
    fall = level[0] - level
    half, most = (int(np.argmax(fall > share * fall.max())) for share in USUAL_FALL)
    usual = float(level[most] - level[half]) / max(most - half, 1)
    if usual >= 0.0 or not frames.whole[tail].all():
        return None
    last = float(np.median(level[tail]))
    statistic = usual / min(slope, -FLATTEST_SLOPE * abs(usual))
    if slope < STILL_SLOWING * earlier:
        statistic *= STEADY_FACTOR
    begin = int(np.argmax(level < last + np.log(MASK_BELOW)))
    start = int(frames.centre[begin])
    text = (
        f"driven residue: from {seen.seconds(frames.centre[tail.start]):.4g} s on the amplitude "
        f"stays at {np.exp(last):.2g} m/s; masked from {seen.seconds(start):.4g} s"
    )
    return Finding(statistic, THRESHOLD, "mask", text, ((start, seen.velocity.size),))


def _steepest(
    level: Float[ndarray, " frame"], std: Float[ndarray, " frame"], first: int, count: int
) -> float:
    """Slope of ln A over some frames, less `SLOPE_ERRORS` standard errors of independent frames."""
    part = slice(first, first + count)
    x = np.arange(count, dtype=float)
    x -= x.mean()
    square = float(x @ x)
    return float(x @ level[part]) / square - SLOPE_ERRORS * float(std[part].mean()) / np.sqrt(
        square
    )
