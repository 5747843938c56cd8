"""The noise leaves too little of the decay."""

import numpy as np

from bladeroot.quality.finding import Finding
from bladeroot.quality.sight import Sight

STATISTIC = "standard error over amplitude of the mode at the start, in frames of four cycles"
# 20 dB; a requirement, not a test: it is exceeded when it is, without false alarms.
THRESHOLD = 0.1


def find(sight: Sight) -> Finding | None:
    """Noise in the mode's frames over the largest amplitude."""
    std = sight.frames.std
    least = float(std[: max(std.size // 4, 1)].min())
    text = (
        f"low dynamic range: the decay starts {-20.0 * np.log10(max(least, 1e-12)):.3g} dB above "
        f"the noise ({sight.floor:.2g} m/s rms)"
    )
    return Finding(least, THRESHOLD, "warn", text)
