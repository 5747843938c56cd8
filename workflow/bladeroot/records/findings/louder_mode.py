"""Another mode is louder than the one that is looked for: a joint slips by the sum of both."""

import numpy as np

from bladeroot.records.finding import Finding
from bladeroot.records.findings import wrong_mode
from bladeroot.records.findings.mains_hum import beside_hum
from bladeroot.records.lines import peak_Hz
from bladeroot.records.sight import TOLERANCE, Sight

STATISTIC = "strongest line out of the band over the strongest in it, in the loudest 80 cycles"
# A requirement, not a test: the curves are then not those of this mode alone.
THRESHOLD = 1.0


def find(sight: Sight) -> Finding | None:
    """Lines of the loud first part of the decay; what drowns the mode is left to `wrong_mode`."""
    return beside_hum(_loudest, sight)


def _loudest(sight: Sight) -> Finding | None:
    frequency, level = sight.early
    inside = np.abs(frequency / sight.expected_Hz - 1.0) <= TOLERANCE
    if not inside.any() or inside.all():
        return None
    other = np.where(inside, 0.0, level)
    ratio = float(other.max()) / max(float(level[inside].max()), 1e-300)
    if ratio > wrong_mode.THRESHOLD:
        return None
    text = (
        f"a louder mode or tone: {ratio:.2g} times this one's velocity at "
        f"{peak_Hz(frequency, other):.5g} Hz; by a mode's motion a joint slips, too"
    )
    return Finding(ratio, THRESHOLD, "warn", text)
