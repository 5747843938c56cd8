"""The sampling frequency: from a time column, and whether it is one that instruments have."""

from fractions import Fraction

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from numpy.lib.stride_tricks import sliding_window_view
from scipy.interpolate import CubicSpline

# Tolerance over the spacing of a kind of frequencies (1000 Hz of its multiples) up to which one of
# them is hardly near by chance.
LARGEST_TOLERANCE = 0.125

MOST_UNEVEN = 0.5  # of a step, that times lie off even ones: beyond, a sample is missing or twice
# What a cubic through a sample's four neighbours misses of it (rms), over the samples' rms: with
# more, there are too few samples a cycle to say what lies between them.
MOST_MISSED = 0.1


def uniform(
    time: Float[ndarray, " sample"], count: int, where: str, stated_Hz: float | None = None
) -> tuple[float, float]:
    """Sampling frequency and first time of a uniform time column; rounded digits are tolerated.

    A straight line through all times, so that no single one decides; a usual frequency within
    three standard errors of it is taken for it. Of times with too few digits to tell, a stated
    frequency with which all of them agree to their last digit.

    Raises:
        ValueError: times that are not `count` finite numbers which rise in equal steps.
    """
    time = np.asarray(time, dtype=float)
    if time.shape != (count,):
        raise ValueError(f"expected {count} times, got shape {time.shape} ({where})")
    bad = np.flatnonzero(~np.isfinite(time))
    if bad.size:
        raise ValueError(
            f"time must be finite, got {time[bad[0]]} at sample {bad[0] + 1} ({where})"
        )
    steps = np.diff(time)
    rising = steps.min() > 0.0
    index = np.arange(count) - 0.5 * (count - 1)
    middle = time.mean() if rising else 0.0
    step = float(index @ (time - middle)) / (count * (count**2 - 1) / 12.0) if rising else 0.0
    off = time - (middle + step * index)
    fault = "" if rising and np.abs(off).max() <= 0.1 * step else _fault(time, steps)
    if fault:
        digit = float(steps[steps > 0.0].min(initial=np.inf))
        coarse = steps.min() >= 0.0 and steps.max() < np.median(steps) + 1.5 * digit
        late = time - np.arange(count) / (stated_Hz or np.nan)
        if coarse and np.ptp(late) < 1.01 * digit:
            return stated_Hz, float(np.median(late))
        hint = "; too few digits, or a row twice? sampling_Hz can tell" if coarse else ""
        raise ValueError(f"{fault}{hint} ({where})")
    error = float(np.std(off)) * np.sqrt(12.0 / count**3) / step
    rate = 1.0 / step
    return usual_rate(rate, 3.0 * error + 1e-9) or rate, float(middle + step * index[0])


def evened(
    time: Float[ndarray, " time"], samples: Float[ndarray, " sample"]
) -> tuple[Float[ndarray, " sample"], float, float, str] | None:
    """Samples at even times, their sampling frequency and first time, and what is told of it.

    For times that scatter about even ones by less than half a step. Either the samples were taken
    at these times, and are interpolated, or a computer wrote down when it got them: the samples
    themselves tell, by whether each lies on the cubic through its neighbours. None where the times
    do not rise, scatter by more or are even ones of too few digits (whose steps have two lengths),
    and where samples are too few a cycle.
    """
    count = samples.size
    if time.shape != samples.shape or not (np.diff(time) > 0.0).all():
        return None
    step, first = np.polyfit(np.arange(count), time, 1)
    even = first + step * np.arange(count)
    lengths = np.unique(np.round(np.diff(time) / step, 6))
    off = np.abs(time - even).max() / step
    rms = float(np.std(samples))
    missed = [_missed(one, samples) / rms for one in (even, time)] if rms else [np.inf]
    if off > MOST_UNEVEN or lengths.size <= 2 or min(missed) > MOST_MISSED:
        return None
    told = f"times lie up to {100.0 * off:.2g} % of a step off even ones"
    if missed[0] <= missed[1]:
        return samples, 1.0 / step, float(first), f"{told}; the samples do not, and count as even"
    told += ", and the samples were taken at these: interpolated to even ones"
    return CubicSpline(time, samples)(even), 1.0 / step, float(first), told


def _missed(time: Float[ndarray, " sample"], samples: Float[ndarray, " sample"]) -> float:
    """Rms of what cubics through two neighbours on either side miss of each sample."""
    at, value = (sliding_window_view(one, 5) for one in (time, samples))
    around = np.delete(at, 2, axis=1) - at[:, 2:3]
    weights = np.ones(around.shape)
    for k in range(4):
        for other in {0, 1, 2, 3} - {k}:
            weights[:, k] *= around[:, other] / (around[:, other] - around[:, k])
    miss = (weights * np.delete(value, 2, axis=1)).sum(axis=1) - value[:, 2]
    return float(np.sqrt(np.mean(miss**2)))


def _fault(time: Float[ndarray, " sample"], steps: Float[ndarray, " step"]) -> str:
    """Where times do not rise, or where their steps are oddest."""
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        k = int(back[0])
        return f"time must rise, got {time[k + 1]:.9g} after {time[k]:.9g} at sample {k + 2}"
    k = int(np.argmax(np.abs(steps - np.median(steps))))
    return (
        f"time must be uniform, got steps of {steps.min():.9g} to {steps.max():.9g} s, the "
        f"oddest at sample {k + 2}"
    )


def usual_rate(rate: float, tolerance: float = 1e-9) -> float | None:
    """The frequency near `rate` that an instrument would have, None if there is none.

    A multiple of 1000, 1024 or 100 Hz, a whole number, a clock's whole part (51.2 kHz / 3), up to
    32 or, with a wide tolerance, 3; a whole number of microseconds. Each only where so few of its
    kind lie near that it is hardly there by chance. One written in single precision counts as the
    whole one.
    """
    if not (np.isfinite(rate) and 1e-3 < rate < 1e12):
        return None
    single = max(tolerance, 1e-7 if rate < 1e5 else tolerance)
    known = [(grain * round(rate / grain), grain, tolerance) for grain in (1000.0, 1024.0, 100.0)]
    known.append((float(round(rate)), 1.0, single))
    parts = 32 if tolerance < 1e-8 else 3
    known.append((float(Fraction(rate).limit_denominator(parts)), 1.0 / parts, tolerance))
    micro = max(round(1e6 / rate), 1)
    known.append((1e6 / micro, rate / micro, tolerance))
    for near, grain, within in known:
        if near and abs(rate - near) <= within * rate <= LARGEST_TOLERANCE * grain:
            return float(near)
    return None
