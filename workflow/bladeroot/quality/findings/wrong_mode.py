"""Another mode dominates the record, or two modes share the band."""

import numpy as np

from bladeroot.quality.examined import Examined, Finding
from bladeroot.quality.findings import sampling_rate
from bladeroot.signal.lines import FAR_FROM_EXPECTED, FREQUENCY_TOLERANCE, local_maxima, peak_Hz

STATISTIC = (
    "strongest line over the strongest in the band; or, within the band, second over first, or one "
    "less than half as far from the expected frequency with 10 % of the first; or how much nearer "
    "another mode of the sheet is"
)
THRESHOLD = 5.0
# A second line in the band leaves open which one is the mode, from this part of the first on.
RIVAL_LINE = 0.5  # anywhere in the band
NEARER_LINE = 0.1  # less than half as far from the expected frequency as the first
# Two lines are separate where they are further apart than the larger of these.
LINES_APART = 0.06  # relative to the mode's frequency
LINES_APART_BINS = 6.0  # spectral lines of a quarter of the decay


def find(seen: Examined) -> Finding | None:
    """Lines of the loud first part of the decay, in and out of the band."""
    frequency, level = seen.early
    inside = np.abs(frequency / seen.expected_Hz - 1.0) <= FREQUENCY_TOLERANCE
    if not inside.any():
        return None
    strongest = float(level[inside].max())
    own = float(level[np.argmin(np.abs(frequency - seen.own_Hz))])
    low, high = ((1.0 + sign * FREQUENCY_TOLERANCE) * seen.expected_Hz for sign in (-1, 1))
    ratio = float(level.max()) / max(strongest, 1e-300)
    if seen.mixed is not None and ratio <= THRESHOLD:
        frequency, level = seen.mixed.early
        inside = np.abs(frequency / seen.expected_Hz - 1.0) <= FREQUENCY_TOLERANCE
    within = np.where(inside, level, 0.0)
    apart = np.abs(frequency / seen.own_Hz - 1.0) > max(
        LINES_APART,
        LINES_APART_BINS * seen.sampling_Hz / (seen.own_Hz * max(seen.velocity.size // 4, 1)),
    )
    second = np.where(apart & local_maxima(level), within, 0.0)
    rival = float(second.max()) / max(own, 1e-300)
    off = abs(seen.own_Hz - seen.expected_Hz)
    theirs = min((abs(seen.own_Hz - mode) for mode in seen.modes_Hz), default=np.inf)
    close = np.where(np.abs(frequency - seen.expected_Hz) < 0.5 * off, second, 0.0)
    nearer = float(close.max()) / max(own, 1e-300)
    if ratio <= THRESHOLD and (rival > RIVAL_LINE or nearer > NEARER_LINE):
        statistic = THRESHOLD * max(rival / RIVAL_LINE, nearer / NEARER_LINE)
        shown, part = (close, nearer) if nearer > NEARER_LINE else (second, rival)
        text = (
            f"two modes in the band: {seen.own_Hz:.5g} and {peak_Hz(frequency, shown):.5g} Hz, "
            f"the second {part:.2g} times as loud; the first is taken"
        )
        if nearer <= NEARER_LINE:
            text += f", {seen.expected_Hz:.5g} Hz was expected"
            return Finding(statistic, THRESHOLD, "warn", text)
        text += f", the second is nearer to the expected {seen.expected_Hz:.5g} Hz"
        # the strongest may be the mode all the same, unless the sheet has another one there
        return Finding(statistic, THRESHOLD, "drop" if theirs < off else "warn", text)
    if ratio <= THRESHOLD and theirs < off:
        text = (
            f"the mode at {seen.own_Hz:.5g} Hz is nearer to another known one than to the "
            f"one that is asked for, at {seen.expected_Hz:.5g} Hz"
        )
        return Finding(THRESHOLD * off / max(theirs, 1e-9 * off), THRESHOLD, "drop", text)
    if ratio <= THRESHOLD and off > FAR_FROM_EXPECTED * seen.expected_Hz:
        text = f"the mode lies at {seen.own_Hz:.5g} Hz, expected at {seen.expected_Hz:.5g} Hz"
        return Finding(
            THRESHOLD * off / (FAR_FROM_EXPECTED * seen.expected_Hz), THRESHOLD, "warn", text
        )
    text = (
        f"another mode dominates: the strongest line is at {peak_Hz(frequency, level):.6g} Hz, "
        f"what lies within {low:.6g} to {high:.6g} Hz has {100 / ratio:.2g} % of it"
    )
    if ratio > THRESHOLD:
        text += f"; {sampling_rate.without_decay(seen)}"
    return Finding(ratio, THRESHOLD, "drop", text)
