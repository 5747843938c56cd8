"""Lines that stand out of a record's spectrum: which modes a ring-down seems to hold."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy import signal

# A line stands out of the spectrum where it is high enough in all three ways.
PROMINENCE_DB = 18.0  # above the valleys beside it
OVER_NOISE_DB = 20.0  # above the median of the spectrum, the noise
RANGE_DB = 60.0  # below the strongest at most; weaker lines are left for a person to find
# Lines of several records closer than this (relative) are one mode.
SAME_MODE = 0.03


def spectrum(
    samples: Float[ndarray, " sample"], sampling_Hz: float
) -> tuple[Float[ndarray, " line"], Float[ndarray, " line"]]:
    """Frequencies (Hz) and level (dB of the strongest) of the loudest half of a record."""
    size = samples.size
    half = max(size // 2, min(size, 256))
    first = int(np.argmax(np.abs(samples - samples.mean())))
    piece = samples[min(first, size - half) :][:half]
    frequency, power = signal.periodogram(
        piece, sampling_Hz, window="blackmanharris", detrend="linear", nfft=4 * half
    )
    level = 10.0 * np.log10(np.maximum(power, 1e-40 * power.max()))
    return frequency[1:], level[1:] - level[1:].max()


def peaks(
    frequency: Float[ndarray, " line"], level: Float[ndarray, " line"]
) -> list[tuple[float, float]]:
    """Frequency (Hz) and level (dB) of the lines that stand out, strongest first."""
    floor = float(np.median(level))
    found, _ = signal.find_peaks(
        level, height=max(floor + OVER_NOISE_DB, -RANGE_DB), prominence=PROMINENCE_DB
    )
    order = found[np.argsort(-level[found])]
    return [(float(frequency[k]), float(level[k])) for k in order]


def common(lists: Sequence[Sequence[tuple[float, float]]]) -> list[float]:
    """Frequencies that at least half of the records show, ascending."""
    every = sorted((frequency, k) for k, lines in enumerate(lists) for frequency, _ in lines)
    groups: list[list[tuple[float, int]]] = []
    for line in every:
        if groups and line[0] < groups[-1][0][0] * (1.0 + SAME_MODE):
            groups[-1].append(line)
        else:
            groups.append([line])
    kept = [group for group in groups if len({k for _, k in group}) >= 0.5 * len(lists)]
    return [float(np.median([frequency for frequency, _ in group])) for group in kept]
