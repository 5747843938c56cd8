"""Raw columns to a recording in SI units, checked."""

from dataclasses import replace

import numpy as np
from numpy import ndarray

from bladeroot.io.channel import FEWEST_SAMPLES
from bladeroot.io.sampling import evened, uniform
from bladeroot.io.units import motion
from bladeroot.signal.recording import SI, Recording, filled

# Peaks (SI) outside which a vibration is suspicious.
USUAL_PEAKS = {"velocity": (1e-7, 10.0), "displacement": (1e-12, 0.1), "acceleration": (1e-5, 1e5)}
ABSURD_FACTOR = 1e4  # over the largest usual peak, above which it is no vibration
# Part of the samples that may be lost at most: up to it, lost at random, loss factors of a drawn
# decay are within 3 %; at twice as much one is 14 % off.
MOST_LOST_PART = 0.1


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
        samples: the motion in `unit`; NaN where a sample is lost, infinite where it was over the
            sensor's range. Curves stand in for these; at the end they are left out.
        unit: a unit of motion; or of a signal (V), with a sensitivity.
        where: what to name in messages, such as the file and column.
        time: seconds, uniform; or None with `sampling_Hz` given.
        sampling_Hz: sampling frequency when there is no time column.
        quantity: velocity, displacement or acceleration; must agree with the unit.
        sensitivity: the sensor's, such as `125 mm/s/V`; see `units.motion`.
        start_s: time of the first sample when there is no time column.
        scale: what one step of the numbers is in `unit`.

    Raises:
        ValueError: unknown unit, a unit of another quantity, too few samples or too many lost ones,
            a constant signal, what no vibration can be, or time that does not rise uniformly.
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
    count = raw.size
    lost, ending = _lost(raw, where)
    raw = raw[: count - ending]
    if raw.size < FEWEST_SAMPLES:
        raise ValueError(f"expected at least {FEWEST_SAMPLES} samples, got {raw.size} ({where})")
    over = lost[np.isinf(raw[lost])]
    known = np.delete(raw, lost) if lost.size else raw
    low, high = float(known.min()), float(known.max())
    if not high > low:
        raise ValueError(f"samples must vary, got {low:.6g} throughout ({where})")
    if _swapped(raw):
        raise ValueError(f"the samples look as if their bytes were in the other order ({where})")
    notes = _suspicions(max(abs(low), abs(high)) * abs(factor), found, where)
    if ending:
        notes += (f"no numbers for the last {ending} of {count} samples: left out",)
    if lost.size:
        raw = filled(raw, lost)
    if time is not None:
        try:
            sampling_Hz, start_s = uniform(time, count, where, sampling_Hz)
        except ValueError:
            made = evened(np.asarray(time, float)[: raw.size], raw.astype(float))
            if made is None:
                raise
            raw, sampling_Hz, start_s, told = made
            notes += (f"{told} ({where})",)
    elif sampling_Hz is None or not (np.isfinite(sampling_Hz) and sampling_Hz > 0.0):
        raise ValueError(
            f"expected a time column or a positive sampling_Hz, got sampling_Hz {sampling_Hz} "
            f"({where})"
        )
    return Recording(
        raw.astype(float) * factor,
        float(sampling_Hz),
        found,
        float(start_s),
        notes,
        lost=lost,
        over=over,
    )


def part(record: Recording, from_s: float | None, to_s: float | None, where: str) -> Recording:
    """The samples from one time to another, s after the first; to the ends where None.

    Raises:
        ValueError: too few samples lie between.
    """
    times = (from_s or 0.0, np.inf if to_s is None else to_s)
    first, stop = np.clip(np.ceil(np.array(times) * record.sampling_Hz), 0, record.samples.size)
    samples = record.samples[int(first) : int(stop)]
    if samples.size < FEWEST_SAMPLES:
        raise ValueError(
            f"expected at least {FEWEST_SAMPLES} samples between from_s and to_s, got "
            f"{samples.size} of the file's {record.samples.size / record.sampling_Hz:g} s ({where})"
        )
    start_s = record.start_s + first / record.sampling_Hz
    lost, over = (at[(at >= first) & (at < stop)] - int(first) for at in (record.lost, record.over))
    return replace(record, samples=samples, start_s=float(start_s), lost=lost, over=over)


def _lost(raw: ndarray, where: str) -> tuple[ndarray, int]:
    """Which samples are lost, and how many more at the end.

    Raises:
        ValueError: too many are lost.
    """
    good = np.isfinite(raw)
    ending = int(np.argmax(good[::-1])) if good.any() else 0
    count = raw.size - ending
    lost = np.flatnonzero(~good[:count])
    if lost.size > MOST_LOST_PART * count:
        over = np.isinf(raw[lost]).sum()
        raise ValueError(
            f"expected numbers for {1.0 - MOST_LOST_PART:.0%} of the samples at least, got none "
            f"for {lost.size} of {count} ({over} over the sensor's range), first for sample "
            f"{lost[0] + 1} ({where})"
        )
    return lost, ending


def _suspicions(peak: float, quantity: str, where: str) -> tuple[str, ...]:
    """What a slip of the unit by a thousand would look like; beyond reason, an error."""
    low, high = USUAL_PEAKS[quantity]
    unit = SI[quantity]
    seen = f"the peak {quantity} is {peak:.3g} {unit}"
    if not peak <= high * ABSURD_FACTOR:
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
