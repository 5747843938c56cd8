"""Whether two independent estimates of one decay agree: FREEVIB and peak finding and fitting."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray
from scipy.special import ndtr, ndtri

from bladeroot.variables import dataset

# What either method may miss by for reasons other than noise (see `peak_fit`), relative.
FLOOR = {"frequency": 2e-6, "loss_factor": 1e-3}
# Standard errors beyond which a difference is reported: not once in 800 simulated records with
# nothing wrong (benchmarks/second_opinion.py), so in fewer than one of a hundred.
THRESHOLD = 3.0


def compare(curves: xr.Dataset, peaks: xr.Dataset) -> xr.Dataset:
    """PFF minus FREEVIB, relative: the median over the times that both describe, and the worst.

    The median is weighted by the peaks' squared errors, and its standard error counts the
    segments that do not overlap. What cancels over a record, or is short, shows in the segment
    where the two differ most. Both methods see the same noise, and the difference of an
    efficient estimate and a less efficient one has at most the variance of the latter (Hausman
    1978), but FREEVIB's errors know also of what was taken off: both are added. The difference is
    reported, nothing is rejected.

    Args:
        curves: variables of dim point as from `freevib`.
        peaks: as from `peak_fit`.

    Returns:
        Scalars `pff_<quantity>_difference`, `_difference_std` and `_difference_z` (in standard
        errors) of frequency and loss_factor, all NaN where nothing can be compared; `pff_agrees`
        (1, 0, or -1: nothing to compare) and `pff_finding`, one line, empty unless they disagree.
    """
    made, loud = {}, []
    for name in FLOOR:
        difference, std, worst = _difference(curves, peaks, name)
        z = difference / std
        title = name.replace("_", " ")
        for suffix, value in (("", difference), ("_std", std), ("_z", z)):
            made[f"pff_{name}_difference{suffix}"] = value
        if abs(z) > THRESHOLD:
            loud.append(f"{title} by {100.0 * difference:.2g} %, {abs(z):.3g} standard errors")
        elif worst is not None and abs(worst.z) > worst.limit:
            loud.append(
                f"{title} by {100.0 * worst.difference:.2g} % around {worst.time:.3g} s, "
                f"{abs(worst.z):.3g} standard errors"
            )
    compared = np.isfinite(made["pff_frequency_difference"])
    made["pff_agrees"] = np.int8(-1 if not compared else int(not loud))
    made["pff_finding"] = f"peak fitting differs from FREEVIB: {'; '.join(loud)}" if loud else ""
    return dataset("quality/agreement", made)


@dataclass(frozen=True)
class _Segment:
    """The segment with the largest difference (z, in standard errors), and what z is asked for."""

    time: float
    difference: float
    z: float
    limit: float


def _difference(
    curves: xr.Dataset, peaks: xr.Dataset, name: str
) -> tuple[float, float, _Segment | None]:
    """Weighted median of the relative difference, its standard error, and the worst segment."""
    time, at = curves["time"].values, peaks["pff_time"].values
    both = (at >= time[0]) & (at <= time[-1]) if time.size > 1 else np.zeros(at.size, dtype=bool)
    if both.sum() < 3:
        return np.nan, np.nan, None
    at, window = at[both], peaks["pff_window"].values[both]
    ours = _mean_around(time, curves[name].values, at, 0.25 * window)
    ratio = peaks[f"pff_{name}"].values[both] / ours
    own_std = np.interp(at, time, curves[f"{name}_std"].values)
    both_std = np.hypot(peaks[f"pff_{name}_std"].values[both], own_std)
    scatter = np.hypot(both_std / np.abs(ours), FLOOR[name])
    part = np.minimum(np.gradient(at) / window, 1.0)  # of a segment
    weight = part / scatter**2
    # a median scatters more than a mean by the square root of pi / 2
    std = np.hypot(np.sqrt(0.5 * np.pi / weight.sum()), FLOOR[name])
    worst = _worst(at, ratio - 1.0, scatter, np.cumsum(part))
    return _weighted_median(ratio - 1.0, weight), float(std), worst


def _worst(
    at: Float[ndarray, " peak"],
    difference: Float[ndarray, " peak"],
    scatter: Float[ndarray, " peak"],
    passed: Float[ndarray, " peak"],
) -> _Segment:
    """Of the segments that do not overlap, the one with the largest difference.

    passed: how many segments lie before each peak.
    """
    count = max(int(passed[-1]), 1)
    number = np.minimum((passed * count / passed[-1]).astype(int), count - 1)
    limit = -ndtri(ndtr(-THRESHOLD) / count)  # as rare among all (Bonferroni)
    found = []
    for inside in (number == k for k in np.unique(number)):
        middle = float(np.median(difference[inside]))
        # one error for all: that of a single peak may be small by luck
        z = middle / np.sqrt((scatter[inside] ** 2).mean())
        found.append(_Segment(float(at[inside].mean()), middle, float(z), float(limit)))
    return max(found, key=lambda segment: abs(segment.z))


def _mean_around(
    time: Float[ndarray, " point"],
    y: Float[ndarray, " point"],
    at: Float[ndarray, " peak"],
    reach: Float[ndarray, " peak"],
) -> Float[ndarray, " peak"]:
    """A curve averaged over `reach` seconds to either side, its curvature allowed for."""
    total = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(time))])
    slope = np.diff(y) / np.diff(time)
    # symmetric as near to the ends as can be, and never less than a point's spacing
    reach = np.minimum(reach, np.minimum(at - time[0], time[-1] - at))
    reach = np.maximum(reach, np.interp(at, time, np.gradient(time)))

    def integral(until: ndarray) -> ndarray:
        k = np.clip(np.searchsorted(time, until) - 1, 0, slope.size - 1)
        beyond = until - time[k]
        return total[k] + beyond * (y[k] + 0.5 * slope[k] * beyond)

    def mean(around: ndarray) -> ndarray:
        low, high = np.maximum(at - around, time[0]), np.minimum(at + around, time[-1])
        return (integral(high) - integral(low)) / (high - low)

    return (4.0 * mean(0.5 * reach) - mean(reach)) / 3.0


def _weighted_median(x: Float[ndarray, " point"], weight: Float[ndarray, " point"]) -> float:
    order = np.argsort(x)
    total = np.cumsum(weight[order])
    return float(np.interp(0.5 * total[-1], total - 0.5 * weight[order], x[order]))
