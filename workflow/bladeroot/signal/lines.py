"""Spectral lines of a piece of a record, its white noise and its digitiser's steps."""

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray
from scipy import fft

from bladeroot.signal.runs import medians

# A mode must lie below this part of the sampling frequency: an anti-alias filter takes the rest.
HIGHEST_OF_SAMPLING = 0.45
# A mode nearer to another than this part of its frequency is a close mode, as its beat takes more
# than eight cycles; one further away leaves something in the curve.
CLOSE_MODE_DISTANCE = 0.125

LOUD_CYCLES = 80.0  # the loudest cycles of a record, whose lines are looked at

# Which line is the mode: the strongest within FREQUENCY_TOLERANCE of its expected frequency
# (relative), but the strongest within NEAR_TOLERANCE if it is clear.
FREQUENCY_TOLERANCE = 0.3
NEAR_TOLERANCE = 0.17
NEAR_HEIGHT = 0.1  # its height over that of the strongest within FREQUENCY_TOLERANCE, at least
# Between the two the level sinks below this part of its height: a mode that softens by as much
# leaves no such valley.
VALLEY_HEIGHT = 0.5
# A mode further (relative) than this from its expected frequency may be another one. Sheets state
# frequencies to some per cent, and few joints soften by more.
FAR_FROM_EXPECTED = 0.06

# A line on one side of zero in a log-envelope.
FEWEST_TURNS = 3.0  # turns over all frames at least
ONE_SIDED_RATIO = 2.5  # height over that of the line at the opposite frequency, at least
COURSE_DEGREE = 3  # degree of the smooth course that is taken off first


def magnitudes(
    velocity: Float[ndarray, " sample"], sampling_Hz: float
) -> tuple[Float[ndarray, " line"], Float[ndarray, " line"]]:
    """Frequencies and magnitudes of a piece (Hann), without mean and lines below three turns."""
    count = velocity.size
    padded = fft.next_fast_len(2 * count, real=True)
    level = np.abs(fft.rfft((velocity - velocity.mean()) * hann(count), padded))
    frequency = fft.rfftfreq(padded, 1.0 / sampling_Hz)
    level[frequency < 3.0 * sampling_Hz / count] = 0.0
    return frequency, level


def lines_of(
    x: Float[ndarray, " sample"], sampling_Hz: float
) -> tuple[Float[ndarray, " line"], Float[ndarray, " line"]]:
    """Frequencies and amplitudes of a piece's own lines, one a turn (Hann, by differences)."""
    spectrum = fft.rfft(x)
    level = np.abs(spectrum[1:-1] - 0.5 * (spectrum[:-2] + spectrum[2:])) * (2.0 / x.size)
    return np.arange(1, level.size + 1) * (sampling_Hz / x.size), level


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
    """Frequency of the mode that is meant by the expected one, which is returned if there is none.

    The strongest line near it, or, without a clear one there, the strongest within the tolerance.
    """
    off = np.abs(frequency / expected_Hz - 1.0)
    inside = np.where(off <= FREQUENCY_TOLERANCE, level, 0.0)
    near = np.where(off <= NEAR_TOLERANCE, level, 0.0)
    k, strongest = int(np.argmax(near)), int(np.argmax(inside))
    between = level[min(k, strongest) : max(k, strongest) + 1]
    if level[k] > NEAR_HEIGHT * level[strongest] and between.min() < VALLEY_HEIGHT * level[k]:
        inside = near
    return peak_Hz(frequency, inside) if inside.any() else expected_Hz


def local_maxima(level: Float[ndarray, " line"]) -> Bool[ndarray, " line"]:
    """Where a level is higher than on either side."""
    found = np.zeros(level.size, bool)
    found[1:-1] = (level[1:-1] > level[:-2]) & (level[1:-1] >= level[2:])
    return found


def one_sided(log: Complex[ndarray, " frame"], least: float) -> tuple[float, float]:
    """How clear a log-envelope's strongest line on one side of zero is, and its turns a frame.

    A second mode of relative amplitude r < 1 adds ln(1 + r exp(i d t)): lines on one side of zero
    only, which no knock, bend or law of amplitude makes. A smooth course is taken off. The line
    makes at least `FEWEST_TURNS` turns, and the change of the logarithm from frame to frame swings
    by at least `least` with it. How clear it is: its height over the median line's. (0, 0) where
    there is none.
    """
    trend = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, log.size), COURSE_DEGREE)
    taper = hann(log.size)
    rest = (log - trend @ np.linalg.lstsq(trend, log, rcond=None)[0]) * taper
    level = np.abs(np.fft.fft(rest, 4 * log.size)) / taper.sum()
    turns = np.fft.fftfreq(level.size)
    apart = np.abs(turns) * log.size >= FEWEST_TURNS
    k = int(np.argmax(np.where(apart, level, 0.0)))
    change = 2.0 * np.pi * abs(turns[k]) * level[k]
    if change < least or level[k] < ONE_SIDED_RATIO * level[-k]:
        return 0.0, 0.0
    middle = float(np.median(level[apart]))
    return float(level[k]) / max(middle, 1e-300), float(turns[k])


def hann(count: int) -> Float[ndarray, " sample"]:
    """Hann's taper: sin^2 at the middles of `count` equal parts of its length.

    It is symmetric, loses no sample, and a mean shows in the lowest two lines only.
    """
    return np.sin(np.pi / count * (np.arange(count) + 0.5)) ** 2


# Blackman and Harris's taper: weights of cosines of no, one, two and three turns (Harris 1978).
BLACKMAN_HARRIS_TERMS = (0.35875, 0.48829, 0.14128, 0.01168)


def blackman_harris(count: int) -> Float[ndarray, " sample"]:
    """The four-term taper whose side lobes lie 92 dB down."""
    once = np.cos(2.0 * np.pi / count * np.arange(count))
    # cosines of the double and triple angle, in powers of the single one's
    even = BLACKMAN_HARRIS_TERMS[0] + BLACKMAN_HARRIS_TERMS[2] * (2.0 * once**2 - 1.0)
    return even - once * (
        BLACKMAN_HARRIS_TERMS[1] + BLACKMAN_HARRIS_TERMS[3] * (4.0 * once**2 - 3.0)
    )


# Whether a digitiser cuts towards zero. Zero is then twice as wide as its other steps.
CUT_EVIDENCE = 10.0  # ln of how much likelier a zero of double width is, at least
EVEN_STEPS = 1.5  # the counts of the steps -2, -1, 1 and 2 lie within this factor of their mean
# Only cycles that reach this many steps are counted: in smaller ones the samples stay in the zero.
COUNTED_CYCLE_STEPS = 8.0

# Small samples are then also smaller than their neighbours say. A frequency that is a simple part
# of the sampling frequency meets a rounded zero more often, too, but does not shrink samples.
SMALL_STEPS = (1.0, 4.0)  # steps of a small sample, which lies between samples of opposite sign
LAGS_PER_CYCLE = 24  # its neighbours lie one and two of these lags away on either side
PAIRS_AGREE_STEPS = 1.0  # the two pairs of neighbours agree on the sample within this many steps
SHRUNK_STEPS = 0.25  # steps by which samples are smaller on average, at least


def white_noise(velocity: Float[ndarray, " sample"]) -> float:
    """Rms of the sensor's noise, taken as white, from the floor between the spectral lines.

    The median over frequency ignores lines, the lower quartile over tapered segments ignores
    impacts and the loud part of the record. Segments of 1024 samples, or eighths of a shorter
    record (64 at least, for a median); no more than 100 of them, spread evenly (the quartile
    then rests on 25), so that a long record costs no more than one of 51,000 samples.
    """
    segment = min(velocity.size, max(64, min(1024, velocity.size // 8)))
    count = min(100, max(1, 2 * velocity.size // segment - 1))
    start = np.linspace(0, velocity.size - segment, count).astype(int)
    taper = hann(segment)
    pieces = velocity[start[:, None] + np.arange(segment)] * taper
    spectra = fft.rfft(pieces, axis=1)[:, segment // 50 + 2 : -2]
    power = spectra.real**2 + spectra.imag**2
    floor = medians(power) / (np.log(2.0) * (taper**2).sum())
    quartile = np.interp(0.25 * (count - 1), np.arange(count), np.sort(floor))
    return float(np.sqrt(quartile))


def quantum(samples: Float[ndarray, " sample"]) -> float:
    """The digitiser's step: the smallest difference of values (of some thousand samples)."""
    some = np.sort(samples[:: -(-samples.size // 8192)])
    steps = np.diff(some)
    steps = steps[steps > 1e-9 * (some[-1] - some[0])]
    return float(steps.min()) if steps.size else 0.0


def not_cut(samples: Float[ndarray, " sample"], cycle: int) -> Float[ndarray, " sample"]:
    """Samples with the half step added that a conversion which cuts towards zero has taken away.

    Cut samples are nearer to zero by half a step on average, so that an amplitude of a few steps
    falls too fast. Samples that were not cut are returned as they are. cycle: samples in a cycle.
    """
    step, cycle = quantum(samples), max(cycle, 8)
    whole = samples.size // cycle * cycle
    if step == 0.0 or not whole:
        return samples
    code = samples[:whole].reshape(-1, cycle) / step
    code = code[np.abs(code).max(axis=1) > COUNTED_CYCLE_STEPS]
    counts = np.array([np.count_nonzero(np.abs(code - k) < 0.1) for k in (-2, -1, 0, 1, 2)])
    beside = counts[[0, 1, 3, 4]]
    usual = beside.mean()
    even = beside.min() * EVEN_STEPS > usual and beside.max() < EVEN_STEPS * usual
    if not even or counts[2] * np.log(2.0) - usual < CUT_EVIDENCE or _shrunk(code) < SHRUNK_STEPS:
        return samples
    return samples + 0.5 * step * np.sign(samples) * (np.abs(samples) > 0.5 * step)


def _shrunk(code: Float[ndarray, "turn sample"]) -> float:
    """Steps by which small samples are smaller than those on either side say; rows are cycles.

    The sum of two samples of opposite sign loses nothing by a cut.
    """
    cycle = code.shape[1]
    lag = max(cycle // LAGS_PER_CYCLE, 1)
    turn, count = 2.0 * np.pi * lag / cycle, cycle - 4 * lag
    far, near, own, later, last = (code[:, k * lag : k * lag + count] for k in range(5))
    between = 0.5 * (near + later) / np.cos(turn)
    beyond = 0.5 * (far + last) / max(np.cos(2.0 * turn), 0.1)
    small = (
        (np.abs(beyond) >= SMALL_STEPS[0])
        & (np.abs(beyond) <= SMALL_STEPS[1])
        & (near * later < 0.0)
    )
    small &= np.abs(beyond - between) < PAIRS_AGREE_STEPS
    less = ((between - own) * np.sign(beyond))[small]
    return float(less.mean()) if less.size else 0.0
