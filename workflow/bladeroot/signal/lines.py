"""Spectral lines of a piece of a record."""

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray

LOUD_CYCLES = 80.0
# A mode further than this (relative) from its expected frequency is not looked for. One in the
# nearer part goes before a louder one further off, from this part of its height on, where the level
# between them sinks below this part of its own: a mode that softens by as much leaves no valley.
TOLERANCE, NEAR, LEAST, VALLEY = 0.3, 0.17, 0.1, 0.5

# Turns that a line on one side makes at least, what it is over the line on the other side, and the
# degree of the course that is taken off.
FEWEST_TURNS, ONE_SIDED, COURSE = 3.0, 2.5, 3


def magnitudes(
    velocity: Float[ndarray, " sample"], sampling_Hz: float
) -> tuple[Float[ndarray, " line"], Float[ndarray, " line"]]:
    """Frequencies and magnitudes of a piece (Hann), without mean and slowest drift."""
    from scipy import fft  # late: who checks a sheet imports this module

    count = velocity.size
    padded = fft.next_fast_len(2 * count, real=True)
    level = np.abs(fft.rfft((velocity - velocity.mean()) * np.hanning(count), padded))
    frequency = fft.rfftfreq(padded, 1.0 / sampling_Hz)
    level[frequency < 3.0 * sampling_Hz / count] = 0.0
    return frequency, level


def loudest(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, expected_Hz: float
) -> tuple[Float[ndarray, " line"], Float[ndarray, " line"]]:
    """Frequencies and magnitudes of the loudest 80 cycles of a record, a decay's first."""
    length = min(max(1, int(LOUD_CYCLES * sampling_Hz / expected_Hz)), velocity.size)
    parts = velocity[: velocity.size // length * length].reshape(-1, length)
    return magnitudes(parts[int(np.argmax(np.einsum("ij,ij->i", parts, parts)))], sampling_Hz)


def peak_Hz(frequency: Float[ndarray, " line"], level: Float[ndarray, " line"]) -> float:
    """Frequency of the largest magnitude, between the lines by a parabola."""
    k = int(np.argmax(level))
    if not 0 < k < level.size - 1:
        return float(frequency[k])
    before, at, after = level[k - 1 : k + 2]
    bend = before - 2.0 * at + after
    shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    return float(frequency[k] + np.clip(shift, -0.5, 0.5) * (frequency[1] - frequency[0]))


def mode_Hz(
    frequency: Float[ndarray, " line"], level: Float[ndarray, " line"], expected_Hz: float
) -> float:
    """Frequency of the mode that is meant by the expected one, which stands in for none.

    The strongest line near it, or, without a clear one there, the strongest within the tolerance.
    """
    off = np.abs(frequency / expected_Hz - 1.0)
    inside = np.where(off <= TOLERANCE, level, 0.0)
    near = np.where(off <= NEAR, level, 0.0)
    k, strongest = int(np.argmax(near)), int(np.argmax(inside))
    between = level[min(k, strongest) : max(k, strongest) + 1]
    if level[k] > LEAST * level[strongest] and between.min() < VALLEY * level[k]:
        inside = near
    return peak_Hz(frequency, inside) if inside.any() else expected_Hz


def peaks(level: Float[ndarray, " line"]) -> Bool[ndarray, " line"]:
    """Where a level is higher than on either side."""
    found = np.zeros(level.size, bool)
    found[1:-1] = (level[1:-1] > level[:-2]) & (level[1:-1] >= level[2:])
    return found


def one_sided(log: Complex[ndarray, " frame"], least: float) -> tuple[float, float]:
    """How clear a log-envelope's strongest line on one side of zero is, and its turns a frame.

    A second mode of relative amplitude r < 1 adds ln(1 + r exp(i d t)): lines on one side of zero
    only, which no knock, bend or law of amplitude makes. A smooth course is taken off; the line
    makes FEWEST_TURNS turns at least, swings the logarithm by `least`, and is compared with the
    median one. (0, 0): there is none.
    """
    trend = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, log.size), COURSE)
    taper = np.hanning(log.size)
    rest = (log - trend @ np.linalg.lstsq(trend, log, rcond=None)[0]) * taper
    level = np.abs(np.fft.fft(rest, 4 * log.size)) / taper.sum()
    turns = np.fft.fftfreq(level.size)
    apart = np.abs(turns) * log.size >= FEWEST_TURNS
    if not apart.any():
        return 0.0, 0.0
    k = int(np.argmax(np.where(apart, level, 0.0)))
    if level[k] < max(least, ONE_SIDED * level[-k]):
        return 0.0, 0.0
    middle = float(np.median(level[apart]))
    return float(level[k]) / max(middle, 1e-300), float(turns[k])


def blackman_harris(count: int) -> Float[ndarray, " sample"]:
    """The four-term taper whose side lobes lie 92 dB down."""
    once = np.cos(2.0 * np.pi / count * np.arange(count))
    # cosines of the double and triple angle, in powers of the single one's
    even = 0.35875 + 0.14128 * (2.0 * once**2 - 1.0)
    return even - once * (0.48829 + 0.01168 * (4.0 * once**2 - 3.0))
