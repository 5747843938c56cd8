"""A recording as an analysis takes it, and its motion as velocity."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

SI = {"velocity": "m/s", "displacement": "m", "acceleration": "m/s^2"}
# The drift of acceleration's integral is its mean over this many cycles of the mode at most: of the
# lengths from half of that on, the one nearest to whole cycles.
DRIFT_CYCLES = 7
# Weights of the samples 1 to 4 ahead in the eighth-order central difference.
_CENTRAL = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
# A displacement's velocity is the slope of a straight line through this part of a cycle of the mode
# on either side, where that is more samples than the central difference's, which makes the noise of
# ten times faster samples ten times larger; none of that is the mode's.
SLOPE_PART = 0.1
SHORT_GAP = 4  # lost samples in a row, at most, that their neighbours tell well


@dataclass(frozen=True)
class Recording:
    """Uniformly sampled motion in SI units (m, m/s or m/s^2), as the sensor gives it.

    undone: takes the sensor's own response off samples at a sampling frequency, where it has one.
    lost: which samples the file has no number for, in whose place stand curves through the others;
    over: those of them that were over the sensor's range.
    """

    samples: Float[ndarray, " sample"]
    sampling_Hz: float
    quantity: str
    start_s: float = 0.0
    notes: tuple[str, ...] = ()
    undone: Callable[[ndarray, float], ndarray] | None = None
    lost: Int[ndarray, " lost"] = field(default_factory=lambda: np.zeros(0, int))
    over: Int[ndarray, " over"] = field(default_factory=lambda: np.zeros(0, int))


def filled(raw: ndarray, lost: Int[ndarray, " lost"]) -> ndarray:
    """Samples with a spline through short gaps and straight lines through long ones."""
    from scipy.interpolate import CubicSpline  # late: few records need it

    from bladeroot.signal.lines import quantum

    kept = np.delete(np.arange(raw.size), lost)
    after = np.searchsorted(kept, lost)
    before = raw[kept[np.maximum(after - 1, 0)]]
    short = (kept[after] - kept[after - 1] <= SHORT_GAP + 1) & (after > 0)
    course = np.interp(lost, kept, raw[kept])
    course[short] = CubicSpline(kept, raw[kept])(lost[short])
    step = quantum(raw[kept]) or 1.0  # in the digitiser's steps, which are looked for later
    made = raw.copy()
    made[lost] = before + step * np.round((course - before) / step)
    return made


def uncut(record: Recording, expected_Hz: float) -> Recording:
    """The recording; samples that were cut towards zero are corrected, with a note of it."""
    from bladeroot.signal.lines import not_cut  # late: the workflow reads units alone

    samples = not_cut(record.samples, round(record.sampling_Hz / expected_Hz))
    if samples is record.samples:
        return record
    note = "the samples were cut towards zero, not rounded; the half step that is missing is added"
    return replace(record, samples=samples, notes=(*record.notes, note))


def velocity(record: Recording, expected_Hz: float) -> Float[ndarray, " sample"]:
    """The recording as velocity in m/s, exact for the mode; a response of the sensor is undone.

    Displacement is differentiated by eighth-order central differences, or, where samples are many,
    by the slope of a straight line (Savitzky and Golay), which weakens what is several times faster
    than the mode: its third harmonic by 29 %. Acceleration is summed by the trapezoidal rule with
    its first Euler-Maclaurin correction, and its mean over whole cycles of the mode, the
    integration's drift, is taken off. The error of either on a wave,
    some per cent with few samples a cycle, is corrected at the mode's frequency in the loudest
    cycles.
    """
    x, step = record.samples, 1.0 / record.sampling_Hz
    if record.undone:
        x = record.undone(x, record.sampling_Hz)
    if record.quantity == "velocity":
        return x
    from bladeroot.signal.lines import loudest, mode_Hz

    lines = loudest(x - x.mean(), record.sampling_Hz, expected_Hz)
    own_Hz = mode_Hz(*lines, expected_Hz)
    # a mode above has too few samples a cycle, and the cut rejects it
    angle = min(2.0 * np.pi * own_Hz * step, 0.9 * np.pi)
    if record.quantity == "displacement":
        weights = _weights(min(difference_reach(record.sampling_Hz, expected_Hz), x.size // 2))
        return _slope(x, weights) / (_gain(weights, angle) * step)
    gain = _gain(_CENTRAL, angle)
    slope = _slope(x, _CENTRAL)
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (x[1:] + x[:-1]))]) - (slope - slope[0]) / 12.0
    gain = 0.5 * angle / np.tan(0.5 * angle) + angle**2 * gain / 12.0
    most = (x.size - 1) // 3 | 1
    widths = np.arange(1, 2 * round(DRIFT_CYCLES * np.pi / angle) + 2, 2)
    widths = np.minimum(widths[widths.size // 2 :], most)
    left = np.abs(np.sin(0.5 * widths * angle) / (widths * np.sin(0.5 * angle)))
    width, kept = int(widths[np.argmin(left)]), 1.0 - left.min() ** 2
    gain *= max(kept, 0.5)  # less only in a record of a cycle or two, which the cut rejects
    summed = summed * (step / gain)
    return summed - _drift(summed, width)


def difference_reach(sampling_Hz: float, expected_Hz: float) -> int:
    """Samples on either side from which a displacement's velocity is made."""
    return max(int(SLOPE_PART * sampling_Hz / expected_Hz), _CENTRAL.size)


def _weights(reach: int) -> Float[ndarray, " ahead"]:
    """Of the samples ahead in a slope over so many; those behind have the opposite ones."""
    ahead = np.arange(1.0, reach + 1.0)
    return ahead / (2.0 * ahead @ ahead) if reach > _CENTRAL.size else _CENTRAL


def _gain(weights: Float[ndarray, " ahead"], angle: float) -> float:
    """Of a slope, for a wave that turns by an angle from sample to sample."""
    return float(2.0 * weights @ np.sin(angle * np.arange(1, weights.size + 1)) / angle)


def _slope(
    x: Float[ndarray, " sample"], weights: Float[ndarray, " ahead"]
) -> Float[ndarray, " sample"]:
    """Change a sample."""
    from scipy.signal import oaconvolve  # late, too

    reach = weights.size
    kernel = np.concatenate([weights[::-1], [0.0], -weights])
    ahead = 2.0 * x[-1] - x[-2 : -reach - 2 : -1]
    behind = 2.0 * x[0] - x[reach:0:-1]
    convolved = np.convolve if reach <= _CENTRAL.size else oaconvolve
    return convolved(np.concatenate([behind, x, ahead]), kernel, mode="valid")


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
