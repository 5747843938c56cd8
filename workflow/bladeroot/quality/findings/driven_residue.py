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
# While a joint sticks, ln A falls at one rate; that of a driven mode falls ever slower: in the last
# tenth at less than SLOWS times the rate of the tenth two before. Where it does not slow so, the
# ratio is multiplied by STEADY, so that only one counts that no joint has.
SLOWS, STEADY = 0.6, 0.3
# Frames at least; parts of the fall between which the usual rate is taken.
FEWEST, USUAL = 80, (0.5, 0.8)
# A slope counts as the steepest that so many of its standard errors allow, and as this part of the
# usual one at least.
ERRORS, LEAST = 6.0, 1e-3
# What lies below this many times the last amplitude is masked.
MASKED = 5.0


def find(seen: Examined) -> Finding | None:
    """Compare slopes of ln A."""
    frames = seen.frames
    level = frames.log.real[: frames.clear]
    if level.size < FEWEST:
        return None
    part = level.size // 10
    tail = slice(level.size - part, level.size)
    std = frames.std[: level.size]
    slope, earlier = (_steepest(level, std, level.size - k * part, part) for k in (1, 3))
    fall = level[0] - level
    half, most = (int(np.argmax(fall > share * fall.max())) for share in USUAL)
    usual = float(level[most] - level[half]) / max(most - half, 1)
    if usual >= 0.0 or not frames.whole[tail].all():
        return None
    last = float(np.median(level[tail]))
    statistic = usual / min(slope, -LEAST * abs(usual))
    if slope < SLOWS * earlier:
        statistic *= STEADY
    begin = int(np.argmax(level < last + np.log(MASKED)))
    start = int(frames.centre[begin])
    text = (
        f"driven residue: from {seen.seconds(frames.centre[tail.start]):.4g} s on the amplitude "
        f"stays at {np.exp(last):.2g} m/s; masked from {seen.seconds(start):.4g} s"
    )
    return Finding(statistic, THRESHOLD, "mask", text, ((start, seen.velocity.size),))


def _steepest(
    level: Float[ndarray, " frame"], std: Float[ndarray, " frame"], first: int, count: int
) -> float:
    """Slope of ln A over some frames, less `ERRORS` standard errors of independent frames."""
    part = slice(first, first + count)
    x = np.arange(count, dtype=float)
    x -= x.mean()
    square = float(x @ x)
    return float(x @ level[part]) / square - ERRORS * float(std[part].mean()) / np.sqrt(square)
