"""What can be wrong with a free decay: clipping, another mode, a mode out of the band."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy import fft


def clipped_runs(
    velocity: Float[ndarray, " sample"], first: int, stop: int, frequency_Hz: float, rate_Hz: float
) -> int:
    """Number of flat tops at the record's extremes between two samples.

    A run of samples at the very largest (or smallest) value of the record counts when it is
    longer than the digitiser's step explains for a sine of that amplitude.
    """
    top, bottom = velocity.max(), velocity.min()
    reach = top - bottom
    tolerance = 1e-9 * reach
    piece = velocity[first:stop]
    steps = np.diff(np.unique(piece[: min(piece.size, 20000)]))
    steps = steps[steps > tolerance]
    lsb = float(steps.min()) if steps.size else 0.0
    flat = 2.0 * np.sqrt(2.0 * lsb / (0.5 * reach)) * rate_Hz / (2.0 * np.pi * frequency_Hz)
    longest = 2.0 + 2.0 * np.ceil(flat)
    count = 0
    for extreme in (top, bottom):
        at = (np.abs(piece - extreme) <= tolerance).astype(int)
        edge = np.flatnonzero(np.diff(at, prepend=0, append=0))
        lengths = edge[1::2] - edge[::2]
        count += int((lengths > longest).sum())
    return count


def strongest_line(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, low_Hz: float, high_Hz: float
) -> tuple[float, float, float]:
    """Frequency of the strongest line, frequency of the strongest in a band, and their ratio."""
    count = velocity.size
    padded = fft.next_fast_len(2 * count, real=True)
    level = np.abs(fft.rfft((velocity - velocity.mean()) * np.hanning(count), padded))
    frequency = fft.rfftfreq(padded, 1.0 / sampling_Hz)
    level[frequency < 3.0 * sampling_Hz / count] = 0.0
    inside = (frequency >= low_Hz) & (frequency <= high_Hz)
    if not inside.any():
        return float(frequency[np.argmax(level)]), float("nan"), 0.0
    peak, own = int(np.argmax(level)), int(np.argmax(np.where(inside, level, -1.0)))
    return float(frequency[peak]), float(frequency[own]), float(level[own] / level[peak])
