"""Offset and slow drift under the decay."""

import numpy as np

from bladeroot.records.finding import Finding
from bladeroot.records.sight import Sight

STATISTIC = "largest local mean over some thirty cycles, relative to the first amplitude"
# 2 % of the amplitude shifts neither frequency nor damping, but tells of a bad sensor or range.
THRESHOLD = 0.02


def find(sight: Sight) -> Finding | None:
    """Running mean of the frames' own means, less what noise explains."""
    frames = sight.frames
    reach = 16
    if frames.baseline.size < 3 * reach:
        return None
    mean = frames.baseline
    for _ in range(2):  # twice: slow modes below this one are no drift
        total = np.concatenate([[0.0], np.cumsum(mean)])
        mean = (total[reach:] - total[:-reach]) / reach
    largest = int(np.argmax(np.abs(mean)))
    amplitude = float(frames.amplitude[: max(frames.clear, 1)].max())
    noise = 5.0 * sight.floor / np.sqrt(reach * frames.hop)
    size = max(abs(float(mean[largest])) - noise, 0.0)
    offset = float(np.median(mean))
    text = (
        f"baseline: offset {offset:.2g} m/s, wandering from {mean.min():.2g} to "
        f"{mean.max():.2g} m/s under an amplitude of {amplitude:.2g} m/s"
    )
    return Finding(size / amplitude, THRESHOLD, "warn", text)
