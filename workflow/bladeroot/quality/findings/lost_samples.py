"""Samples for which the file has no number: lost ones, or marks of a sensor over its range."""

from bladeroot.quality.examined import Examined, Finding

FIRST = True
STATISTIC = "samples of the record that the file has no number for"
THRESHOLD = 0.0


def find(seen: Examined) -> Finding | None:
    """All lost samples are told; those in the decay are masked."""
    told = without_decay(seen)
    if not told:
        return None
    inside = sum(stop - first for first, stop in seen.lost)
    text = f"{told}; {'masked' if inside else 'none in the decay'}"
    count = float(seen.recording.lost.size)
    return Finding(count, THRESHOLD, "mask" if inside else "warn", text, seen.lost)


def without_decay(seen: Examined) -> str:
    """How many samples of the record are lost, and when the first of them."""
    known = seen.recording
    if known is None or not known.lost.size:
        return ""
    over = f" ({known.over.size} over the sensor's range)" if known.over.size else ""
    first_s = known.lost[0] / known.sampling_Hz
    samples = "1 sample" if known.lost.size == 1 else f"{known.lost.size} samples"
    return f"{samples} lost{over}, the first {first_s:.6g} s into the record"
