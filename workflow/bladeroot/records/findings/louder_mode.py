"""Another mode is louder than the one that is looked for: a joint slips by the sum of both."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.records.finding import Finding
from bladeroot.records.findings import wrong_mode
from bladeroot.records.findings.mains_hum import beside_hum
from bladeroot.records.lines import LOUD_CYCLES, TOLERANCE, magnitudes, peak_Hz
from bladeroot.records.runs import in_frames
from bladeroot.records.sight import Sight

MIXED = True
STATISTIC = "velocity of the strongest line out of the band over this mode's, first 80 cycles"
# A requirement, not a test: the curves are then not those of this mode alone.
THRESHOLD = 1.0
# Cycles whose lines are looked at, and what one that is louder in the first of them has at least.
FIRST_CYCLES, HARMLESS = 32, 0.2
FRAME_CYCLES = 8
# What is masked leaves at least this part of the decay, and of this mode's first amplitude, or the
# larger amplitudes would be lost.
LEAST_LEFT = 0.5


def find(sight: Sight) -> Finding | None:
    """The strongest other line of the first cycles, and for how long it is louder.

    Modes couple where it is: damping and frequency of this one depend on the other's phase and
    amplitude. What drowns the mode is left to `wrong_mode`.
    """
    return beside_hum(_loudest, sight)


def _loudest(sight: Sight) -> Finding | None:
    if _strongest(*sight.early, sight)[1] > wrong_mode.THRESHOLD:
        return None
    count = min(int(FIRST_CYCLES * sight.sampling_Hz / sight.own_Hz), sight.velocity.size)
    first = magnitudes(sight.velocity[:count], sight.sampling_Hz)
    other_Hz, ratio = _strongest(*first, sight)
    if ratio < HARMLESS:
        return Finding(ratio, THRESHOLD, "warn", "")
    own, other = _course(sight, other_Hz)
    course = other[: sight.frames.clear] / own[: sight.frames.clear]
    early = course[: int(LOUD_CYCLES)]
    if not early.size:
        return None
    ratio = float(early.max())
    text = (
        f"a louder mode or tone: {ratio:.2g} times this one's velocity at {other_Hz:.5g} Hz; "
        "by a mode's motion a joint slips, too"
    )
    louder = np.flatnonzero(course > THRESHOLD)
    if not louder.size or louder[0] > FRAME_CYCLES:
        return Finding(ratio, THRESHOLD, "warn", text)
    stop = int(louder[-1] + 1 + FRAME_CYCLES // 2) * sight.frames.hop
    left = sight.velocity.size - stop
    if left < LEAST_LEFT * sight.velocity.size or own[louder[-1]] < LEAST_LEFT * own[0]:
        return Finding(ratio, THRESHOLD, "warn", text)
    text += f"; the first {1e3 * sight.seconds(stop):.3g} ms are not used"
    return Finding(ratio, THRESHOLD, "mask", text, ((0, stop),))


def _strongest(
    frequency: Float[ndarray, " line"], level: Float[ndarray, " line"], sight: Sight
) -> tuple[float, float]:
    """Frequency of the strongest line out of the band, and its size over the strongest within."""
    inside = np.abs(frequency / sight.expected_Hz - 1.0) <= TOLERANCE
    other = np.where(inside, 0.0, level)
    own = float(level.max(where=inside, initial=0.0))
    return peak_Hz(frequency, other), float(other.max()) / max(own, 1e-300)


def _course(
    sight: Sight, other_Hz: float
) -> tuple[Float[ndarray, " frame"], Float[ndarray, " frame"]]:
    """Velocity of this mode and of the other in frames of eight cycles, a cycle apart."""
    step = sight.frames.hop
    width = min(FRAME_CYCLES, sight.velocity.size // step) * step
    time = (np.arange(width) - 0.5 * (width - 1)) / sight.sampling_Hz
    turns = 2.0 * np.pi * np.outer(time, [sight.own_Hz, other_Hz])
    design = np.hstack([np.cos(turns), np.sin(turns), np.ones((width, 1))])
    taper = np.sqrt(np.hanning(width + 2)[1:-1])
    solver = np.linalg.pinv(design * taper[:, None]) * taper
    own_cos, other_cos, own_sin, other_sin = in_frames(sight.velocity, solver[:4].T, step).T
    return np.maximum(np.hypot(own_cos, own_sin), 1e-300), np.hypot(other_cos, other_sin)
