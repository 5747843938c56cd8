"""The sampling frequency: from a time column, and whether it is one that instruments have."""

from fractions import Fraction

import numpy as np
from jaxtyping import Float
from numpy import ndarray

# Tolerance over the spacing of a kind of frequencies (1000 Hz of its multiples) up to which one of
# them is hardly near by chance.
LARGEST_TOLERANCE = 0.125


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
