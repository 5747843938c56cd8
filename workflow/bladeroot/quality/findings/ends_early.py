"""The record, or the tip's return, ends the decay while the amplitude is still large."""

from bladeroot.quality.finding import Finding
from bladeroot.quality.sight import Sight

STATISTIC = "last over first amplitude of the decay"
# Less than a factor of ten of amplitude seldom reaches the stick plateau; a requirement.
THRESHOLD = 0.1


def find(sight: Sight) -> Finding | None:
    """Amplitude at the end of the cut over that at its start, where noise is not the end."""
    frames = sight.frames
    if frames.clear < frames.log.size:
        return Finding(0.0, THRESHOLD, "warn", "")
    last, first = frames.amplitude[-1], frames.amplitude.max()
    why = f" ({sight.end_reason})" if sight.end_reason else ""
    text = f"the decay ends early, at {100 * last / first:.2g} % of its first amplitude{why}"
    return Finding(float(last / first), THRESHOLD, "warn", text)
