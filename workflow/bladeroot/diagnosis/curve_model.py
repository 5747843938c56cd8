"""Frequency and damping over amplitude: what the baseline leaves, level by level.

A level is a mode at a force in one group; `bladeroot.pooling.level_curve` averages its records, and
it keeps a free offset. The baseline has no slip, or that of the simulation that it is given.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int
from numpy import ndarray
from scipy.interpolate import RegularGridInterpolator
from scipy.linalg import block_diag

from bladeroot.diagnosis.causes import places, with_causes, with_smooth
from bladeroot.diagnosis.guards import TRUST_CURVE
from bladeroot.diagnosis.stick_model import kinked, near, own_error_turned
from bladeroot.inference.gaussian import Fit
from bladeroot.inference.problem import Problem, Slopes, State
from bladeroot.mechanisms.mechanism import Mechanism, Points
from bladeroot.pooling.level_curve import level_curve

SPACING = 5  # ladder's points between those that are used
REACH = 10.0**2.5  # from the largest amplitude of a level down
# Each level's curves have a free offset of ln f and of the loss factor, with these standard
# deviations.
OFFSET = 2e-3  # where records reach their plateau
OFFSET_NO_PLATEAU = 2e-2  # where none does, and the curves begin anywhere
# Over so much of ln A and of ln F a law's own errors vary.
LN_A_LENGTH = 1.0
LN_F_LENGTH = 0.8
AT_TOP = 3e-4  # of what is smooth in amplitude, of ln f and of the loss factor, likely beforehand
# What the analysis of records is trusted to at best, of ln f and of the loss factor.
BEST = (1e-6, 5e-6)
# ln of: errors over the stated ones; floors of ln f and of the loss factor.
NOISE = ((0.0, 0.4), (np.log(2e-7), 1.5), (np.log(3e-6), 1.5))
QUANTITIES = ("frequency", "loss_factor")


@dataclass(frozen=True)
class CurveData:
    """Points of all levels, first ln f, then the loss factor of the same.

    value: excess over the plateau, less the baseline's. noise: covariance by the records' errors,
    stated and as repeats differ. level: number of each point's level. records: how many. stuck:
    whether any record of the level has a plateau.
    """

    modes: tuple[str, ...]
    points: Points
    value: Float[ndarray, " datum"]
    noise: Float[ndarray, "datum datum"]
    level: Int[ndarray, " point"]
    records: Int[ndarray, " point"]
    stuck: Bool[ndarray, " point"]

    @property
    def quantity(self) -> Int[ndarray, " datum"]:
        """0 for ln f, 1 for the loss factor."""
        return np.repeat([0, 1], self.points.mode.size)

    @property
    def twice(self) -> Points:
        """The points once for each quantity."""
        p = self.points
        return Points(*(np.tile(part, 2) for part in (p.mode, p.force, p.amplitude, p.loss)))


def curve_data(
    seen: xr.Dataset,
    modes: Sequence[str],
    skip: Bool[ndarray, " record"] | None = None,
    baseline: xr.Dataset | None = None,
) -> CurveData | None:
    """The curves of the usable records, without those to skip; None if there are none.

    baseline: simulated `ln_frequency` and `loss_factor` changes over (mode, force, amplitude).
    """
    mode = seen["mode"].values.astype(str)
    use = np.isin(mode, modes) & (seen["verdict"].values.astype(str) == "usable")
    if skip is not None:
        use &= ~skip
    amplitude = seen["amplitude"].values
    if not amplitude.size or not use.any():
        return None
    force = seen["force"].values
    group = seen["group"].values.astype(str) if "group" in seen else np.full(force.size, "")
    places, curves = [], []
    for number, name in enumerate(modes):
        mine = use & (mode == name)
        for f, own in sorted(set(zip(force[mine].tolist(), group[mine].tolist(), strict=True))):
            rows = np.flatnonzero(mine & (force == f) & (group == own))
            curve = level_curve(seen.isel(record=rows), SPACING, REACH)
            if curve is not None:
                places.append((number, float(f)))
                curves.append(curve)
    if not curves:
        return None
    sizes = [one.amplitude.size for one in curves]
    points = Points(
        *(np.repeat(part, sizes) for part in zip(*places, strict=True)),
        np.concatenate([one.amplitude for one in curves]),
        np.repeat([one.plateau_loss for one in curves], sizes),
    )
    level = np.repeat(np.arange(len(curves)), sizes)
    noise = block_diag(*(one.stated[q] + one.repeats[q] for q in (0, 1) for one in curves))
    value = np.concatenate([one.mean[q] for q in (0, 1) for one in curves])
    count = np.concatenate([one.records for one in curves])
    if baseline is not None:
        value = value - _of_baseline(baseline, points, modes)
    stuck = np.repeat([one.stuck for one in curves], sizes)
    return CurveData(tuple(modes), points, value, noise, level, count, stuck)


def _of_baseline(baseline: xr.Dataset, points: Points, modes: Sequence[str]) -> ndarray:
    """Linear in the force and ln of the amplitude, constant beyond the simulated ones."""
    axes = baseline["force"].values, np.log(baseline["amplitude"].values)
    places = zip((points.force, np.log(points.amplitude)), axes, strict=True)
    at = np.stack([np.clip(x, axis[0], axis[-1]) for x, axis in places], axis=1)
    value = np.zeros((2, points.mode.size))
    for quantity, name in enumerate(("ln_frequency", "loss_factor")):
        for number, mode in enumerate(modes):
            grid = baseline[name].sel(mode=mode).transpose("force", "amplitude").values
            mine = points.mode == number
            value[quantity, mine] = RegularGridInterpolator(axes, grid)(at[mine])
    return value.ravel()


def problem(
    data: CurveData,
    mechanisms: Sequence[Mechanism] = (),
    extra: Sequence[tuple[ndarray, float]] = (),
) -> Problem:
    """Excess over the plateau with mechanisms; `extra`: covariances of unit size of a smooth
    competitor, each with the size that is likely beforehand.
    """
    n = data.value.size
    loss = data.quantity == 1
    group = np.concatenate([data.level, data.level + data.level.max() + 1])
    size = np.tile(np.where(data.stuck, OFFSET, OFFSET_NO_PLATEAU), 2)
    free = size**2 * (group[:, None] == group)
    best, rows = np.where(loss, BEST[1] ** 2, BEST[0] ** 2), np.arange(n)
    kernel = law_kernel(data, kinked)
    prior = with_causes(np.zeros(0), np.zeros(0), mechanisms)

    def predict(theta: ndarray) -> State:
        mean, columns, effects = np.zeros(n), [np.zeros((n, 0))], []
        for one, own in zip(mechanisms, places(mechanisms), strict=True):
            values, chain = one.values(theta[own])
            effect = one.curve(data.points, values)
            both = np.concatenate([effect.ln_f, effect.loss])
            slope = np.vstack([effect.ln_f_slope, effect.loss_slope])
            columns.append(slope * chain)
            effects.append(both)
            mean = mean + both
        whole = np.array(effects).reshape(-1, n)
        turns = partial(turned, whole, columns[1:])
        return State(mean, np.hstack(columns), {"effects": whole}, turns=turns)

    def turned(
        effects: ndarray, slopes: Sequence[ndarray], _: ndarray, vector: ndarray, matrix: ndarray
    ) -> tuple[ndarray, ndarray]:
        """The covariance's derivatives by the parameters, as `State` says."""
        parts = [
            own_error_turned(TRUST_CURVE, kernel, e, slope, vector, matrix)
            for e, slope in zip(effects, slopes, strict=True)
        ]
        times, traces = zip((np.zeros((n, 0)), np.zeros(0)), *parts, strict=True)
        return np.hstack(times), np.concatenate(traces)

    def covariance(state: State, scales: ndarray) -> tuple[ndarray, Slopes]:
        stated = np.exp(2.0 * scales[0]) * data.noise
        floor_f = np.where(loss, 0.0, np.exp(2.0 * scales[1]))
        floor_loss = np.where(loss, np.exp(2.0 * scales[2]), 0.0)
        whole = free + stated
        whole[rows, rows] += floor_f + floor_loss + best
        for e in state.facts["effects"]:
            whole += np.outer(TRUST_CURVE**2 * e, e) * kernel
        parts = [
            np.exp(2.0 * scale) * unit for scale, (unit, _) in zip(scales[3:], extra, strict=True)
        ]
        for part in parts:
            whole += part
        return whole, lambda: [2.0 * part for part in (stated, floor_f, floor_loss, *parts)]

    scales = with_smooth(NOISE, extra)
    return Problem(data.value, predict, covariance, prior, scales, blocks=_blocks(data))


def stretched(fitted: Fit) -> float:
    """How many times as large as the records state them the errors of the curves are in a fit."""
    return float(np.exp(fitted.scales[0]))


def strain(fitted: Fit) -> float:
    """Nats that a fit pays for errors of the curves larger than the records state them."""
    prior = fitted.problem.scales
    larger = (fitted.scales[0] - prior.mean[0]) / prior.std[0]
    return 0.5 * max(float(larger), 0.0) ** 2


def _blocks(data: CurveData) -> tuple[slice, ...]:
    """Of one quantity of one mode: they stand together."""
    own = 2 * data.twice.mode + data.quantity
    edges = [0, *(np.flatnonzero(np.diff(own)) + 1), own.size]
    return tuple(slice(*pair) for pair in pairwise(edges))


def law_kernel(data: CurveData, alike: Callable = near) -> Float[ndarray, "datum datum"]:
    """Correlation of errors of a law between points: alike in amplitude, force, mode, quantity."""
    twice, quantity = data.twice, data.quantity
    same = (twice.mode[:, None] == twice.mode) & (quantity[:, None] == quantity)
    return (
        same * alike(np.log(twice.amplitude), LN_A_LENGTH) * near(np.log(twice.force), LN_F_LENGTH)
    )


def smooth_kernels(data: CurveData) -> list[tuple[ndarray, float]]:
    """A free smooth function of amplitude and force, one for ln f and one for the loss factor.

    Its size is in proportion to the amplitude, as whatever it is leaves the plateau slowly.
    """
    mode, amplitude, quantity = data.twice.mode, data.twice.amplitude, data.quantity
    largest = np.array([amplitude[mode == m].max(initial=0.0) for m in range(len(data.modes))])
    share = amplitude / largest[mode]
    kernel = law_kernel(data) * np.outer(share, share)
    return [((quantity[:, None] == q) * (quantity == q) * kernel, AT_TOP) for q in (0, 1)]
