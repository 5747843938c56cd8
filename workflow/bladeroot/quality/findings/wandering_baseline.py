"""A baseline that wanders: within a cycle it is a ramp, of which the mode's own wave has a part."""

import numpy as np

from bladeroot.quality.finding import Finding
from bladeroot.quality.findings.mains_hum import beside_hum
from bladeroot.quality.sight import BASELINE_CYCLES, FRAME_CYCLES, Sight

STATISTIC = "the mode's share of the mean's steepest ramp, in standard errors of thirty cycles"
THRESHOLD = 1.0


def find(sight: Sight) -> Finding | None:
    """The steepest course of the local mean over thirty cycles; the whole course is taken off.

    A ramp r t holds r T / pi of a wave of period T, and the louder the drift the earlier that
    drowns a decay. Hum under a far higher mode would be one; it is taken off by itself.
    """
    return beside_hum(_steepest, sight)


def _steepest(sight: Sight) -> Finding | None:
    if sight.baseline is None:
        return None
    centre, mean = sight.baseline
    reach = min(2 * BASELINE_CYCLES, mean.size - 1)
    ramp = np.abs(mean[reach:] - mean[:-reach]).max() / reach
    # noise that is stronger at low frequencies shows in how the means of frames scatter
    bend = np.abs(np.diff(sight.frames.baseline[::FRAME_CYCLES], 2))
    noise = max(sight.floor, float(np.median(bend)) * np.sqrt(sight.frames.hop))
    samples = 2 * BASELINE_CYCLES * sight.frames.hop
    size = float(ramp / np.pi / (noise * np.sqrt(2.0 / samples)))
    if size <= THRESHOLD:
        return Finding(size, THRESHOLD, "subtract", "")
    from scipy.interpolate import CubicSpline  # seldom needed, and slow to load

    text = f"wandering baseline: by {np.ptp(mean):.2g} m/s; taken off"
    course = CubicSpline(centre, mean)(np.arange(sight.velocity.size))
    return Finding(size, THRESHOLD, "subtract", text, (), course)
