"""A sampling rate that is not what the file says: all modes are off by one usual ratio."""

import numpy as np

from bladeroot.quality.examined import Examined, Finding
from bladeroot.signal.lines import FREQUENCY_TOLERANCE, local_maxima, magnitudes

MIXED = True
STATISTIC = "modes of the structure found at one usual ratio of their frequencies, less those at 1"
THRESHOLD = 1.0
# Usual ratios of one sampling rate to another that is taken for it, and their inverses.
RATIOS = tuple(
    ratio
    for factor in (1.28, 2.0, 2.5, 2.56, 4.0, 5.12, 10.0, 48.0 / 44.1, 51.2 / 50.0)
    for ratio in (factor, 1.0 / factor)
)
# An axial force moves all bending modes by as much as this: a smaller ratio tells nothing.
LEAST_TELLING_RATIO = 1.2
# A line is at a mode's place within this (relative), and within LOOSE_FACTOR times this at a ratio
# of 1 or in a record without a decay: there a sheet alone says where the mode is.
PLACE_TOLERANCE = 0.01
LOOSE_FACTOR = 3.0

# Which lines of the spectrum are looked at, strongest first.
MOST_LINES = 12
LEAST_OF_STRONGEST = 0.003  # height over that of the strongest line, at least
LINE_OVER_MEDIAN = 8.0  # height over the spectrum's median, at least
LINES_APART = 0.03  # distance from any stronger line, relative, at least


def find(seen: Examined) -> Finding | None:
    """Compare the strongest lines of the record with the modes that the campaign knows.

    One mode alone cannot tell a wrong clock from a wrong expectation; two can.
    """
    modes = np.array([seen.expected_Hz, *seen.modes_Hz])
    if modes.size < 2:
        return None
    lines = _lines(seen)
    at_one = _matches(lines, modes, 1.0)
    telling = [ratio for ratio in RATIOS if abs(np.log(ratio)) > np.log(LEAST_TELLING_RATIO)]
    scored = [(_matches(lines, modes, ratio), ratio) for ratio in telling]
    most, ratio = max(scored, key=lambda pair: (pair[0], -abs(np.log(pair[1]))))
    text = (
        f"sampling rate: {most} modes lie at {ratio:.4g} times their expected frequencies; "
        f"{seen.sampling_Hz:.6g} Hz may be wrong by that"
    )
    return Finding(float(most - at_one), THRESHOLD, "drop", text)


def without_decay(seen: Examined) -> str:
    """For a record without its mode: what the strongest line would be at another sampling rate."""
    frequency, level = magnitudes(seen.whole, seen.sampling_Hz)
    line = float(frequency[np.argmax(level)])
    expected, rate = seen.expected_Hz, seen.sampling_Hz
    if abs(line / expected - 1.0) < FREQUENCY_TOLERANCE:
        return ""
    alias = abs(expected - rate * round(expected / rate))
    if (
        expected > 0.5 * rate
        and abs(line / max(alias, 1e-9) - 1.0) < LOOSE_FACTOR * PLACE_TOLERANCE
    ):
        return f"the strongest line, {line:.5g} Hz, is where {expected:.5g} Hz is aliased to"
    ratio = min(RATIOS, key=lambda ratio: abs(np.log(line / (expected * ratio))))
    if abs(line / (expected * ratio) - 1.0) < LOOSE_FACTOR * PLACE_TOLERANCE:
        return (
            f"the strongest line, {line:.5g} Hz, is near {ratio:.4g} times the expected "
            "frequency: is the sampling rate right?"
        )
    return f"the strongest line is at {line:.5g} Hz"


def _lines(seen: Examined) -> np.ndarray:
    """Frequencies of the strongest distinct lines of the decay's first part."""
    frequency, level = seen.early
    tops = np.flatnonzero(local_maxima(level))
    tops = tops[
        level[tops] > max(LEAST_OF_STRONGEST * level.max(), LINE_OVER_MEDIAN * np.median(level))
    ]
    chosen: list[float] = []
    for k in tops[np.argsort(level[tops])[::-1]]:
        if all(abs(frequency[k] - f) > LINES_APART * f for f in chosen):
            chosen.append(float(frequency[k]))
        if len(chosen) == MOST_LINES:
            break
    return np.array(chosen)


def _matches(lines: np.ndarray, modes: np.ndarray, ratio: float) -> int:
    off = np.abs(lines[:, None] / (ratio * modes) - 1.0).min(axis=0, initial=np.inf)
    return int((off < (PLACE_TOLERANCE if ratio != 1.0 else LOOSE_FACTOR * PLACE_TOLERANCE)).sum())
