"""A recording in SI units, its checks, and its conversion to velocity."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

# quantity and factor to SI of every unit accepted
UNITS = {
    "m/s": ("velocity", 1.0),
    "mm/s": ("velocity", 1e-3),
    "um/s": ("velocity", 1e-6),
    "m": ("displacement", 1.0),
    "mm": ("displacement", 1e-3),
    "um": ("displacement", 1e-6),
    "m/s^2": ("acceleration", 1.0),
    "g": ("acceleration", 9.80665),
}
SI = {"velocity": "m/s", "displacement": "m", "acceleration": "m/s^2"}
SHORTEST = 64


@dataclass(frozen=True)
class Recording:
    """Uniformly sampled motion in SI units (m, m/s or m/s^2)."""

    samples: Float[ndarray, " sample"]
    sampling_Hz: float
    quantity: str
    start_s: float = 0.0


def normal_unit(unit: str) -> str:
    """One spelling for a unit: um for the micro signs, m/s^2 for m/s2 and m s-2."""
    text = unit.strip().replace("µ", "u").replace("μ", "u").replace("**", "^").replace(" ", "")
    aliases = {"m/s2": "m/s^2", "m/s²": "m/s^2", "ms-1": "m/s", "ms-2": "m/s^2", "g_n": "g"}
    return aliases.get(text, text)


def recording(
    samples: ndarray,
    unit: str,
    where: str,
    time: ndarray | None = None,
    sampling_Hz: float | None = None,
    quantity: str | None = None,
) -> Recording:
    """Check raw columns and bring them to SI.

    Args:
        samples: the motion in `unit`.
        unit: one of `UNITS`.
        where: what to name in messages, such as the file and column.
        time: seconds, uniform; or None with `sampling_Hz` given.
        sampling_Hz: sampling frequency when there is no time column.
        quantity: velocity, displacement or acceleration; must agree with the unit.

    Raises:
        ValueError: unknown unit, a unit of another quantity, too few samples, NaN, a constant
            signal, or time that does not rise uniformly.
    """
    unit = normal_unit(unit)
    if unit not in UNITS:
        raise ValueError(f"unit must be one of {', '.join(UNITS)}, got {unit!r} ({where})")
    found, factor = UNITS[unit]
    if quantity is not None and quantity != found:
        raise ValueError(
            f"quantity {quantity!r} needs a unit such as "
            f"{SI.get(quantity, 'm/s, m or m/s^2')}, got {unit!r} ({where})"
        )
    samples = np.asarray(samples, dtype=float)
    if samples.ndim != 1:
        raise ValueError(f"expected one channel of samples, got shape {samples.shape} ({where})")
    if samples.size < SHORTEST:
        raise ValueError(f"expected at least {SHORTEST} samples, got {samples.size} ({where})")
    bad = np.flatnonzero(~np.isfinite(samples))
    if bad.size:
        raise ValueError(
            f"samples must be finite numbers, got {samples[bad[0]]} at sample {bad[0] + 1} "
            f"and {bad.size} in all ({where})"
        )
    if not np.ptp(samples) > 0.0:
        raise ValueError(f"samples must vary, got {samples[0]} throughout ({where})")
    start = 0.0
    if time is not None:
        sampling_Hz, start = _uniform(np.asarray(time, dtype=float), samples.size, where)
    elif sampling_Hz is None or not (np.isfinite(sampling_Hz) and sampling_Hz > 0.0):
        raise ValueError(
            f"expected a time column or a positive sampling_Hz, got sampling_Hz {sampling_Hz} "
            f"({where})"
        )
    return Recording(samples * factor, float(sampling_Hz), found, start)


def _uniform(time: ndarray, count: int, where: str) -> tuple[float, float]:
    """Sampling frequency and start of a uniform time column (rounded digits are tolerated)."""
    if time.shape != (count,):
        raise ValueError(f"expected {count} times, got shape {time.shape} ({where})")
    bad = np.flatnonzero(~np.isfinite(time))
    if bad.size:
        raise ValueError(
            f"time must be finite, got {time[bad[0]]} at sample {bad[0] + 1} ({where})"
        )
    steps = np.diff(time)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        k = int(back[0])
        raise ValueError(
            f"time must rise, got {time[k + 1]:.9g} after {time[k]:.9g} at sample {k + 2} ({where})"
        )
    step = (time[-1] - time[0]) / (count - 1)
    off = np.abs(time - (time[0] + step * np.arange(count)))
    if off.max() > 0.1 * step:
        k = int(np.argmax(np.abs(steps - np.median(steps))))
        raise ValueError(
            f"time must be uniform, got steps of {steps.min():.9g} to {steps.max():.9g} s, the "
            f"oddest at sample {k + 2} ({where})"
        )
    return 1.0 / step, float(time[0])


def velocity(record: Recording, lowest_Hz: float) -> Float[ndarray, " sample"]:
    """The recording as velocity in m/s; what matters lies above `lowest_Hz`.

    Displacement is differentiated by eighth-order central differences (4e-5 of the amplitude at
    ten samples a cycle). Acceleration is summed by the trapezoidal rule with its first
    Euler-Maclaurin correction, and the drift below `lowest_Hz` taken off.
    """
    x, step = record.samples, 1.0 / record.sampling_Hz
    if record.quantity == "velocity":
        return x
    if record.quantity == "displacement":
        return _derivative(x) / step
    slope = _derivative(x)
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (x[1:] + x[:-1]))]) - (slope - slope[0]) / 12.0
    summed = summed * step
    drift = _running_mean(summed, max(3, 2 * round(record.sampling_Hz / lowest_Hz / 2) + 1))
    return summed - drift


def _derivative(x: Float[ndarray, " sample"]) -> Float[ndarray, " sample"]:
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0.0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    ahead = 2.0 * x[-1] - x[-2:-6:-1]
    behind = 2.0 * x[0] - x[4:0:-1]
    return np.convolve(np.concatenate([behind, x, ahead]), weights[::-1], mode="valid")


def _running_mean(x: Float[ndarray, " sample"], width: int) -> Float[ndarray, " sample"]:
    """Mean over `width` samples, twice; the window shrinks symmetrically towards the ends."""
    half = np.minimum(width // 2, np.minimum(np.arange(x.size), np.arange(x.size)[::-1]))
    at = np.arange(x.size)
    for _ in range(2):
        total = np.concatenate([[0.0], np.cumsum(x)])
        x = (total[at + half + 1] - total[at - half]) / (2 * half + 1)
    return x
