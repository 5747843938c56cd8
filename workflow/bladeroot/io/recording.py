"""A recording in SI units, its checks, and its conversion to velocity."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.io.channel import SHORTEST
from bladeroot.io.response import undoing
from bladeroot.io.sampling import uniform
from bladeroot.io.units import SI, motion
from bladeroot.signal.lines import loudest, mode_Hz
from bladeroot.signal.spectrum import not_cut

# Peaks (SI) outside which a vibration is suspicious, and the factor beyond which it is none.
USUAL_PEAKS = {"velocity": (1e-7, 10.0), "displacement": (1e-12, 0.1), "acceleration": (1e-5, 1e5)}
ABSURD = 1e4
# Cycles of the mode over which acceleration's integral is averaged to find its drift.
DRIFT_CYCLES = 5
# Weights of the samples 1 to 4 ahead in the eighth-order central difference.
_CENTRAL = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])


@dataclass(frozen=True)
class Recording:
    """Uniformly sampled motion in SI units (m, m/s or m/s^2), as the sensor gives it.

    response: of the sensor, as of `bladeroot.io.response`, or "".
    """

    samples: Float[ndarray, " sample"]
    sampling_Hz: float
    quantity: str
    start_s: float = 0.0
    notes: tuple[str, ...] = ()
    response: str = ""


def recording(
    samples: ndarray,
    unit: str,
    where: str,
    time: ndarray | None = None,
    sampling_Hz: float | None = None,
    quantity: str | None = None,
    sensitivity: str | None = None,
    start_s: float = 0.0,
    scale: float = 1.0,
) -> Recording:
    """Check raw columns and bring them to SI.

    Args:
        samples: the motion in `unit`.
        unit: a unit of motion; or of a signal (V), with a sensitivity.
        where: what to name in messages, such as the file and column.
        time: seconds, uniform; or None with `sampling_Hz` given.
        sampling_Hz: sampling frequency when there is no time column.
        quantity: velocity, displacement or acceleration; must agree with the unit.
        sensitivity: the sensor's, such as `125 mm/s/V`; see `units.motion`.
        start_s: time of the first sample when there is no time column.
        scale: what one step of the numbers is in `unit`.

    Raises:
        ValueError: unknown unit, a unit of another quantity, too few samples, NaN, a constant
            signal, what no vibration can be, or time that does not rise uniformly.
    """
    try:
        found, factor = motion(unit, sensitivity)
        factor *= scale
    except ValueError as error:
        raise ValueError(f"{error} ({where})") from error
    if quantity is not None and quantity != found:
        raise ValueError(
            f"quantity {quantity!r} needs a unit such as "
            f"{SI.get(quantity, 'm/s, m or m/s^2')}, got {unit!r} of {found} ({where})"
        )
    raw = np.asarray(samples)
    if raw.ndim != 1:
        raise ValueError(f"expected one channel of samples, got shape {raw.shape} ({where})")
    if raw.dtype.kind not in "iuf":
        raise ValueError(f"expected real numbers as samples, got {raw.dtype} ({where})")
    if raw.size < SHORTEST:
        raise ValueError(f"expected at least {SHORTEST} samples, got {raw.size} ({where})")
    bad = np.flatnonzero(~np.isfinite(raw))
    if bad.size:
        raise ValueError(
            f"samples must be finite numbers, got {raw[bad[0]]} at sample {bad[0] + 1} "
            f"and {bad.size} in all ({where})"
        )
    low, high = float(raw.min()), float(raw.max())
    if not high > low:
        raise ValueError(f"samples must vary, got {low:.6g} throughout ({where})")
    if _swapped(raw):
        raise ValueError(f"the samples look as if their bytes were in the other order ({where})")
    notes = _suspicions(max(abs(low), abs(high)) * abs(factor), found, where)
    if time is not None:
        sampling_Hz, start_s = uniform(time, raw.size, where)
    elif sampling_Hz is None or not (np.isfinite(sampling_Hz) and sampling_Hz > 0.0):
        raise ValueError(
            f"expected a time column or a positive sampling_Hz, got sampling_Hz {sampling_Hz} "
            f"({where})"
        )
    return Recording(raw.astype(float) * factor, float(sampling_Hz), found, float(start_s), notes)


def part(record: Recording, from_s: float | None, to_s: float | None, where: str) -> Recording:
    """The samples from one time to another, s after the first; to the ends where None.

    Raises:
        ValueError: too few samples lie between.
    """
    times = (from_s or 0.0, np.inf if to_s is None else to_s)
    first, stop = np.clip(np.ceil(np.array(times) * record.sampling_Hz), 0, record.samples.size)
    samples = record.samples[int(first) : int(stop)]
    if samples.size < SHORTEST:
        raise ValueError(
            f"expected at least {SHORTEST} samples between from_s and to_s, got {samples.size} of "
            f"the file's {record.samples.size / record.sampling_Hz:g} s ({where})"
        )
    start_s = record.start_s + first / record.sampling_Hz
    return replace(record, samples=samples, start_s=float(start_s))


def _suspicions(peak: float, quantity: str, where: str) -> tuple[str, ...]:
    """What a slip of the unit by a thousand would look like; beyond reason, an error."""
    low, high = USUAL_PEAKS[quantity]
    unit = SI[quantity]
    seen = f"the peak {quantity} is {peak:.3g} {unit}"
    if not peak <= high * ABSURD:
        raise ValueError(
            f"{seen}, no vibration: wrong unit, wrong byte order or spoilt samples? ({where})"
        )
    if peak > high:
        return (f"{seen}, above {high:g} {unit}: is the unit right?",)
    if peak < low:
        return (f"{seen}, below {low:g} {unit}: is the unit right?",)
    return ()


def _swapped(raw: ndarray) -> bool:
    """Whether integers are far smoother with their bytes in the other order."""
    if raw.dtype.kind not in "iu" or raw.dtype.itemsize == 1:
        return False
    piece = raw[:100_000]
    return _roughness(piece.byteswap()) < 0.1 * _roughness(piece)


def _roughness(x: ndarray) -> float:
    """Power of the steps relative to that of the samples: 2 for white noise, small for a curve."""
    x = x.astype(float)
    power = np.var(x)
    return float(np.mean(np.diff(x) ** 2) / power) if power > 0.0 else np.inf


def uncut(record: Recording, expected_Hz: float) -> Recording:
    """The recording; where its samples were cut towards zero, made good, with a note of it."""
    samples = not_cut(record.samples, round(record.sampling_Hz / expected_Hz))
    if samples is record.samples:
        return record
    note = "the samples were cut towards zero, not rounded; the half step that is missing is added"
    return replace(record, samples=samples, notes=(*record.notes, note))


def velocity(record: Recording, expected_Hz: float) -> Float[ndarray, " sample"]:
    """The recording as velocity in m/s, exact for the mode; a response of the sensor is undone.

    Displacement is differentiated by eighth-order central differences. Acceleration is summed by
    the trapezoidal rule with its first Euler-Maclaurin correction, and its mean over whole cycles
    of the mode, the integration's drift, is taken off. What either does to a wave, some
    per cent with few samples a cycle, is made good for the mode's line in the loudest cycles.
    """
    x, step = record.samples, 1.0 / record.sampling_Hz
    if record.response:
        x = undoing(record.response)(x, record.sampling_Hz)
    if record.quantity == "velocity":
        return x
    lines = loudest(x - x.mean(), record.sampling_Hz, expected_Hz)
    own_Hz = mode_Hz(*lines, expected_Hz)
    # what lies above has no samples to be seen by, as the cut then says
    angle = min(2.0 * np.pi * own_Hz * step, 0.9 * np.pi)
    gain = float(2.0 * _CENTRAL @ np.sin(angle * np.arange(1, 5)) / angle)
    if record.quantity == "displacement":
        return _derivative(x) / (gain * step)
    slope = _derivative(x)
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (x[1:] + x[:-1]))]) - (slope - slope[0]) / 12.0
    gain = 0.5 * angle / np.tan(0.5 * angle) + angle**2 * gain / 12.0
    width = 2 * round(DRIFT_CYCLES * np.pi / angle) + 1
    width = min(width, (x.size - 1) // 3 | 1)
    kept = 1.0 - (np.sin(0.5 * width * angle) / (width * np.sin(0.5 * angle))) ** 2
    gain *= max(kept, 0.5)  # less only in a record of a cycle or two, which the cut rejects
    summed = summed * (step / gain)
    return summed - _drift(summed, width)


def _derivative(x: Float[ndarray, " sample"]) -> Float[ndarray, " sample"]:
    weights = np.concatenate([-_CENTRAL[::-1], [0.0], _CENTRAL])
    ahead = 2.0 * x[-1] - x[-2:-6:-1]
    behind = 2.0 * x[0] - x[4:0:-1]
    return np.convolve(np.concatenate([behind, x, ahead]), weights[::-1], mode="valid")


def _drift(x: Float[ndarray, " sample"], width: int) -> Float[ndarray, " sample"]:
    """Mean over `width` samples, twice; straight on where the windows would pass the ends.

    A window that shrank there would hold part of a cycle and take the mode's own motion off.
    """
    mean = x
    for _ in range(2):
        total = np.concatenate([[0.0], np.cumsum(mean)])
        mean = (total[width:] - total[:-width]) / width
    reach = min(width, mean.size - 1)
    first = mean[0] + (mean[reach] - mean[0]) / reach * np.arange(1.0 - width, 0.0)
    last = mean[-1] + (mean[-1] - mean[-1 - reach]) / reach * np.arange(1.0, width)
    return np.concatenate([first, mean, last])
