"""Frequency and damping over amplitude at each force: the curves of all its records as one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.special import stdtrit

from bladeroot.loads import load_attrs, load_facts_of, value_of
from bladeroot.pooling.components import QUANTILE_95
from bladeroot.pooling.level_curve import (
    LENGTH,
    POINTS_A_DECADE,
    ladder_of,
    levels_of,
    on_ladder,
)
from bladeroot.variables import dataset

CURVES = ("frequency", "loss_factor")
# The mean, its standard error with and without that of the records' levels, the scatter of records.
KINDS = ("", "_std", "_change_std", "_scatter")

# A change per decade is told from a curve that reaches over this part of one.
SHORTEST = 0.3


def mean_curves(decays: Sequence[xr.Dataset], plateaus: Sequence[xr.Dataset]) -> xr.Dataset:
    """The mean curve of each mode, load, group and sensor, on one ladder of amplitudes.

    decays: as from `bladeroot.decay.freevib.freevib`, with mode, force_N and simulated in the
    attributes. plateaus: of the same records; what is rejected there is left out. A record's curve
    is its own level plus a change with amplitude that all share: levels are taken off before the
    mean and their mean is put back, so that a record that begins or ends makes no step. The levels
    of a clamping are averaged, then the clampings, each weighted by its own variance and the
    scatter, which all forces of a mode share (DerSimonian-Laird); nothing is extrapolated. With the
    standard error a normal 95 % interval is right for few repeats, too (Student). Where no clamping
    repeats it is a lower bound, and says so.

    Returns:
        dims level (mode, force, group, sensor) and amplitude (m): frequency (Hz) and loss_factor
        with their standard errors, with and without that of the levels (`_std`, `_change_std`), and
        the scatter between records, levels included (NaN for one record alone); `_per_decade`, the
        mean change in a decade of amplitude; `quantity`, what was measured; and `records`, how
        many reach the amplitude.
    """
    facts = load_facts_of(decays)
    decays = [
        decay
        for decay, plateau in zip(decays, plateaus, strict=True)
        if decay.sizes["point"] > 1 and not str(plateau["verdict"].values).startswith("rejected")
    ]
    level_of = [_level_of(decay.attrs) for decay in decays]
    measured = {_level_of(d.attrs): str(d.attrs.get("quantity", "velocity")) for d in decays}
    levels = sorted(measured)
    ladder = ladder_of(decays)
    values = {name: np.full((len(levels), ladder.size), np.nan) for name in _names()}
    count = np.zeros((len(levels), ladder.size), dtype=int)
    unknown = []
    for kind in dict.fromkeys(_kind(own) for own in levels):
        rows = [k for k, own in enumerate(levels) if _kind(own) == kind]
        here = [d for d, own in zip(decays, level_of, strict=True) if _kind(own) == kind]
        level = np.unique([value_of(decay.attrs) for decay in here], return_inverse=True)[1]
        read = {
            name: np.array([on_ladder(decay, name, ladder) for decay in here])
            for name in (*CURVES, *(f"{name}_std" for name in CURVES))
        }
        for k, row in enumerate(rows):
            count[row] = np.isfinite(read["loss_factor"][level == k]).sum(axis=0)
        for name in CURVES:
            clamping = _clampings(here, level)
            *found, repeated = _means(read[name], read[f"{name}_std"], clamping, level)
            for part, made in zip(KINDS, found, strict=True):
                values[f"{name}{part}"][rows] = made
        unknown += [] if repeated else [kind[0]]
    for name in CURVES:
        both = zip(values[name], values[f"{name}_change_std"], strict=True)
        slopes = np.array([_slope(ladder, y, std) for y, std in both]).reshape(-1, 2)
        values |= {f"{name}_per_decade": slopes[:, 0], f"{name}_per_decade_std": slopes[:, 1]}
    made = values | {
        "amplitude": ladder,
        "mode": _strings(levels, 0),
        "force": [own[1] for own in levels],
        "group": _strings(levels, 2),
        "sensor": _strings(levels, 3),
        "quantity": np.array([measured[own] for own in levels], dtype=str),
        "records": count,
    }
    curves = dataset("pooling/curves", made).set_coords(["mode", "force", "group", "sensor"])
    curves["force"].attrs = load_attrs(facts)
    for name in CURVES if unknown else ():
        text = f"; clamping scatter of {', '.join(dict.fromkeys(unknown))} unknown: a lower bound"
        curves[f"{name}_std"].attrs["long_name"] += text
    simulated = max((int(d.attrs.get("simulated", 0)) for d in decays), default=0)
    return curves.assign_attrs(simulated=simulated, **facts)


def _level_of(attrs: Mapping) -> tuple[str, float, str, str]:
    """Mode, load, group and sensor: an amplitude is one at a sensor, and groups are no repeats."""
    own = (str(attrs.get(name, "")) for name in ("group", "sensor"))
    return str(attrs["mode"]), value_of(attrs), *own


def _kind(level: tuple[str, float, str, str]) -> tuple[str, str, str]:
    """What levels that share their scatter have in common: all but the load."""
    return level[0], level[2], level[3]


def _strings(levels: Sequence[tuple], k: int) -> ndarray:
    return np.array([own[k] for own in levels], dtype=str)


def _slope(
    ladder: Float[ndarray, " amplitude"],
    y: Float[ndarray, " amplitude"],
    std: Float[ndarray, " amplitude"],
) -> tuple[float, float]:
    """Mean change of a curve in a decade, by weighted least squares, and its standard error.

    Errors of neighbouring amplitudes are one over `LENGTH` in ln A.
    """
    known = np.isfinite(y) & np.isfinite(std)
    decades = np.log10(ladder[known])
    if not decades.size or np.ptp(decades) < SHORTEST:
        return np.nan, np.nan
    weight = std[known] ** -2.0
    apart = decades - np.average(decades, weights=weight)
    total = weight @ apart**2
    shared = POINTS_A_DECADE * LENGTH / np.log(10.0)
    return (weight * apart) @ y[known] / total, np.sqrt(shared / total)


def _clampings(decays: Sequence[xr.Dataset], level: Int[ndarray, " record"]) -> ndarray:
    """Numbers of the clampings; records that name none are clampings of their own."""
    names = [
        f"{own} {decay.attrs.get('hold', '') or f'record {k}'}"
        for k, (own, decay) in enumerate(zip(level, decays, strict=True))
    ]
    return np.unique(names, return_inverse=True)[1]


def _names() -> list[str]:
    return [f"{name}{part}" for name in CURVES for part in KINDS]


def _means(
    value: Float[ndarray, "record amplitude"],
    std: Float[ndarray, "record amplitude"],
    clamping: Int[ndarray, " record"],
    force: Int[ndarray, " record"],
) -> tuple[ndarray, ndarray, ndarray, ndarray, bool]:
    """What `KINDS` names, for each force, and whether clampings repeat.

    clamping, force: numbers from 0; a clamping belongs to one force.
    """
    known = np.isfinite(value) & (std > 0.0)
    variance = np.where(known, std, np.inf) ** 2
    weight = 1.0 / (variance + _grouped(value, variance, force).scatter)
    level = np.empty(force.size)
    for one in range(force.max() + 1):
        level[force == one] = levels_of(value[force == one], weight[force == one])
    with np.errstate(divide="ignore"):
        level_std = (1.0 / variance).sum(axis=1) ** -0.5
    own = (level[:, None], level_std[:, None])
    middle, middle_std, apart, repeated = _middle(*own, clamping, force)
    change = _grouped(value - level[:, None], variance, force)
    reached = np.isfinite(change.variance)
    mean, change_std = (
        np.where(reached, part, np.nan) for part in (change.mean, np.sqrt(change.variance))
    )
    several = _member(force) @ known > 1
    scatter = np.where(several, np.hypot(np.sqrt(change.scatter), apart), np.nan)
    return mean + middle, np.hypot(change_std, middle_std), change_std, scatter, repeated


def _middle(
    value: Float[ndarray, "record amplitude"],
    std: Float[ndarray, "record amplitude"],
    clamping: Int[ndarray, " record"],
    force: Int[ndarray, " record"],
) -> tuple[ndarray, ndarray, ndarray, bool]:
    """Mean of each force, its standard error, the scatter of records, and if clampings repeat."""
    first = np.unique(clamping, return_index=True)[1]
    known = np.isfinite(value) & (std > 0.0)
    records = _grouped(value, np.where(known, std, np.inf) ** 2, clamping)
    clampings = _grouped(records.mean, records.variance, force[first])
    by_records = records.scatter * (_member(force[first]) @ (clampings.share**2 * records.squares))
    by_clampings = clampings.scatter * clampings.squares
    with np.errstate(invalid="ignore", divide="ignore"):
        doubt = np.nan_to_num(by_records**2 / records.freedom)
        doubt = doubt + np.nan_to_num(by_clampings**2 / clampings.freedom)
        freedom = clampings.variance**2 / doubt  # Satterthwaite's
        error = np.sqrt(clampings.variance) * stdtrit(freedom, 0.975) / QUANTILE_95
    scatter = np.sqrt(records.scatter + clampings.scatter)
    scatter = np.where(records.freedom + clampings.freedom > 0, scatter, np.nan)
    reached = np.isfinite(clampings.variance)
    found = (np.where(reached, part, np.nan) for part in (clampings.mean, error, scatter))
    return *found, bool(clampings.freedom.any())


@dataclass(frozen=True)
class _Grouped:
    """Weighted means of groups of rows, with the scatter of rows (a variance) all groups share.

    freedom: degrees of freedom of scatter. share: of a row in its group's mean; squares: the sum of
    their squares.
    """

    mean: Float[ndarray, "group amplitude"]
    variance: Float[ndarray, "group amplitude"]
    scatter: Float[ndarray, " amplitude"]
    freedom: Int[ndarray, " amplitude"]
    share: Float[ndarray, "row amplitude"]
    squares: Float[ndarray, "group amplitude"]


def _grouped(
    value: Float[ndarray, "row amplitude"],
    variance: Float[ndarray, "row amplitude"],
    group: Int[ndarray, " row"],
) -> _Grouped:
    """DerSimonian-Laird's moments over all groups; rows of infinite variance have no part."""
    member = _member(group)
    known = np.isfinite(variance)
    value, weight = np.where(known, value, 0.0), 1.0 / variance
    with np.errstate(invalid="ignore", divide="ignore"):
        total = member @ weight
        rest = np.where(known, value - (member @ (weight * value) / total)[group], 0.0)
        freedom = known.sum(axis=0) - (total > 0.0).sum(axis=0)
        excess = np.maximum((weight * rest**2).sum(axis=0) - freedom, 0.0)
        scatter = excess / np.nansum(total - member @ weight**2 / total, axis=0)
        scatter = np.where(freedom > 0, scatter, 0.0)
        weight = 1.0 / (variance + scatter)
        total = member @ weight
        share = np.where(known, weight / total[group], 0.0)
        mean, squares = member @ (share * value), member @ share**2
        return _Grouped(mean, 1.0 / total, scatter, freedom, share, squares)


def _member(group: Int[ndarray, " row"]) -> Float[ndarray, "group row"]:
    return (np.arange(group.max() + 1)[:, None] == group).astype(float)
