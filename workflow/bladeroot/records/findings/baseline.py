"""An offset under the decay, constant or not."""

import numpy as np

from bladeroot.records.finding import Finding
from bladeroot.records.sight import BASELINE_CYCLES, Sight

MIXED = True
STATISTIC = "largest local mean over some thirty cycles, relative to the first amplitude"
# 2 % of the amplitude shifts neither frequency nor damping, but tells of a bad sensor or range.
THRESHOLD = 0.02


def find(sight: Sight) -> Finding | None:
    """The local mean's largest value, less what noise explains."""
    if sight.baseline is None:
        return None
    _, mean = sight.baseline
    frames = sight.frames
    amplitude = float(frames.amplitude[: max(frames.clear, 1)].max())
    noise = 5.0 * sight.floor / np.sqrt(BASELINE_CYCLES * frames.hop)
    size = max(float(np.abs(mean).max()) - noise, 0.0)
    offset = float(np.median(mean))
    text = (
        f"baseline: offset {offset:.2g} m/s, wandering from {mean.min():.2g} to "
        f"{mean.max():.2g} m/s under an amplitude of {amplitude:.2g} m/s"
    )
    return Finding(size / amplitude, THRESHOLD, "warn", text)
