"""Whether groups of records (place of the blow, configuration, operator) differ, and by how much.

Records of one group are repeats, those of two are not: a mean over both would hide what sets them
apart. They are compared at the same amplitude of the same sensor, motion by motion: what several
sensors saw of one event counts once.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool
from numpy import ndarray
from scipy.sparse.csgraph import connected_components
from scipy.special import chdtrc, fdtrc, stdtrit

from bladeroot.loads import value_of
from bladeroot.pooling.components import STDS_OF_95
from bladeroot.pooling.level_curve import ladder_of, on_ladder, record_levels
from bladeroot.terms import length
from bladeroot.variables import dataset

QUANTITIES = ("frequency", "loss_factor")
# Groups are said to differ where the chance of as large a difference between equal groups is less.
DIFFER_CHANCE = 0.01
# The largest difference over all amplitudes is the one with the largest excess over this many of
# its standard errors, not the one that noise takes furthest: one of some hundred amplitudes.
LARGEST_DIFFERENCE_ERRORS = 5.0
# Points of a curve count where their standard error, relative, is below this.
POINT_ERROR_LIMIT = {"frequency": 1e-3, "loss_factor": 0.3}


@dataclass(frozen=True)
class _Motion:
    """One record's curve: who saw which motion at which load."""

    decay: xr.Dataset
    group: str
    event: str
    place: tuple[float, str]  # load and sensor


def group_differences(decays: Sequence[xr.Dataset], rejected: Sequence[bool]) -> xr.Dataset | None:
    """How groups differ in each mode; None where records name no two groups.

    decays: as from `bladeroot.decay.record.estimate`, with `mode`, `group`, `event`, `sensor`
    and the load in their attributes; rejected: which of them are left out. A record's level is its
    mean distance from the others over the amplitudes that they share.

    Returns:
        dim comparison (a mode and a quantity each): `compared_mode`, `compared_quantity`,
        `difference` (of the group that lies highest over the lowest, less 1), its
        `difference_std`, the two groups' names, `chance` of as much without a difference,
        `scatter` of the events of a group (of ln), `freedom`, and `told` (1: they differ); dim
        group_level: each group's level against the mean of the groups (of ln) with its standard
        error and its number of events.
    """
    usable = [
        decay
        for decay, bad in zip(decays, rejected, strict=True)
        if decay.sizes["point"] > 1 and not bad
    ]
    motions = [_motion(decay) for decay in usable]
    rows, levels = [], []
    for mode in sorted({str(one.decay.attrs["mode"]) for one in motions}):
        here = [one for one in motions if str(one.decay.attrs["mode"]) == mode and one.group]
        if len({one.group for one in here}) < 2:
            continue
        for quantity in QUANTITIES:
            found = _compared(here, quantity)
            if found is not None:
                rows.append({"mode": mode, "quantity": quantity, **found[0]})
                levels += [{"mode": mode, "quantity": quantity, **one} for one in found[1]]
    return _dataset(rows, levels) if rows else None


def _motion(decay: xr.Dataset) -> _Motion:
    facts = decay.attrs
    event = str(facts.get("event", "")) or f"record {facts['record']}"
    place = value_of(facts), str(facts.get("sensor", ""))
    return _Motion(decay, str(facts.get("group", "")), event, place)


def _compared(here: Sequence[_Motion], quantity: str) -> tuple[dict, list[dict]] | None:
    """The comparison of one mode's groups; None where no two groups share load and amplitude."""
    of_event: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for place in sorted({one.place for one in here}):
        mine = [one for one in here if one.place == place]
        for one, level, std in _levels(mine, quantity):
            of_event.setdefault((one.group, one.event), []).append((level, std))
    names = sorted({group for group, _ in of_event})
    if len(names) < 2:
        return None
    # sensors of one motion share what happened: their mean is its level, no repeat
    values = {
        key: (float(np.mean([v for v, _ in seen])), float(np.mean([s for _, s in seen])))
        for key, seen in of_event.items()
    }
    groups = [np.array([v for (g, _), v in sorted(values.items()) if g == name]) for name in names]
    mean, scatter, freedom = _spread([one[:, 0] for one in groups])
    count = np.array([len(one) for one in groups])
    stated = np.array([np.sqrt((one[:, 1] ** 2).sum()) / len(one) for one in groups])
    error = np.hypot(scatter / np.sqrt(count), 0.0 if freedom else stated)
    error = np.maximum(error, stated)
    weight = 1.0 / error**2
    middle = (weight @ mean) / weight.sum()
    excess = float(weight @ (mean - middle) ** 2)
    between = count.size - 1
    chance = fdtrc(between, freedom, excess / between) if freedom else chdtrc(between, excess)
    low, high = int(np.argmin(mean)), int(np.argmax(mean))
    ratio = float(np.exp(mean[high] - mean[low]))
    wide = stdtrit(freedom, 0.975) / STDS_OF_95 if freedom else 1.0
    row = {
        "difference": ratio - 1.0,
        "difference_std": float(ratio * wide * np.hypot(error[low], error[high])),
        "low_group": names[low], "high_group": names[high], "chance": float(chance),
        "scatter": scatter if freedom else np.nan, "freedom": freedom,
        "told": int(chance < DIFFER_CHANCE), **_largest(here, quantity, scatter),
    }  # fmt: skip
    levels = [
        {"group": name, "level": m - mean.mean(), "level_std": e, "events": n}
        for name, m, e, n in zip(names, mean, error, count, strict=True)
    ]
    return row, levels


def _spread(groups: Sequence[ndarray]) -> tuple[ndarray, float, int]:
    """Mean of each group, the scatter within groups, and its degrees of freedom."""
    mean = np.array([one.mean() for one in groups])
    freedom = sum(one.size - 1 for one in groups)
    rest = sum(((one - own) ** 2).sum() for one, own in zip(groups, mean, strict=True))
    return mean, float(np.sqrt(rest / freedom)) if freedom else 0.0, freedom


def _largest(here: Sequence[_Motion], quantity: str, scatter: float) -> dict:
    """Where groups lie furthest apart: a mean over amplitudes would hide what only some show.

    scatter: of ln between events, as their levels have it; at one amplitude it counts if larger.
    """
    found = {"largest": np.nan, "largest_std": np.nan, "largest_amplitude": np.nan,
             "largest_sensor": "", "largest_high": "", "largest_low": ""}  # fmt: skip
    best = 0.0
    for place in sorted({one.place for one in here}):
        mine = [one for one in here if one.place == place]
        ladder, log, error = _curves(mine, quantity)
        names = sorted({one.group for one in mine})
        rows = [np.array([one.group == name for one in mine]) for name in names]
        known = np.isfinite(log)
        count = np.array([known[own].sum(axis=0) for own in rows])
        for k in np.flatnonzero((count > 0).sum(axis=0) > 1):
            seen = [g for g in range(len(names)) if count[g, k]]
            values = [log[rows[g], k][known[rows[g], k]] for g in seen]
            mean, here_std, _ = _spread(values)
            here_std = max(scatter, here_std)
            stated = np.array([np.nanmean(error[rows[g], k]) for g in seen])
            std = np.hypot(here_std, stated) / np.sqrt([one.size for one in values])
            low, high = int(np.argmin(mean)), int(np.argmax(mean))
            apart, own = mean[high] - mean[low], float(np.hypot(std[low], std[high]))
            if apart - LARGEST_DIFFERENCE_ERRORS * own > best:
                best = float(apart - LARGEST_DIFFERENCE_ERRORS * own)
                found = {
                    "largest": float(np.expm1(apart)), "largest_std": float(np.exp(apart) * own),
                    "largest_amplitude": float(ladder[k]), "largest_sensor": place[1],
                    "largest_high": names[seen[high]], "largest_low": names[seen[low]],
                }  # fmt: skip
    return found


def _curves(here: Sequence[_Motion], quantity: str) -> tuple[ndarray, ndarray, ndarray]:
    """A ladder of amplitudes, ln of each record's curve on it, and its standard errors."""
    ladder = ladder_of([one.decay for one in here])
    value = np.array([on_ladder(one.decay, quantity, ladder) for one in here])
    std = np.array([on_ladder(one.decay, f"{quantity}_std", ladder) for one in here])
    with np.errstate(invalid="ignore", divide="ignore"):
        known = (value > 0.0) & (std < POINT_ERROR_LIMIT[quantity] * value)
        return ladder, np.log(np.where(known, value, np.nan)), np.where(known, std / value, np.nan)


def _levels(here: Sequence[_Motion], quantity: str) -> list[tuple[_Motion, float, float]]:
    """Records of one sensor and load that share amplitudes with a record of another group, each
    with its level (of ln) and standard error.
    """
    _, log, error = _curves(here, quantity)
    known = np.isfinite(log)
    linked = _linked(known)
    if len({one.group for one, own in zip(here, linked, strict=True) if own}) < 2:
        return []
    log, known, error = log[linked], known[linked], error[linked]
    level = record_levels(log, known.astype(float))
    # errors of neighbouring amplitudes are hardly independent: the mean is no better than a point
    typical = np.array([float(np.median(e[k])) for e, k in zip(error, known, strict=True)])
    mine = [one for one, own in zip(here, linked, strict=True) if own]
    return list(zip(mine, level.tolist(), typical.tolist(), strict=True))


def _linked(known: Bool[ndarray, "record amplitude"]) -> Bool[ndarray, " record"]:
    """The largest set of records that common amplitudes link; others cannot be compared."""
    part = connected_components(known.astype(int) @ known.T.astype(int), directed=False)[1]
    own = known.any(axis=1)
    return own & (part == np.argmax(np.bincount(part, own)))


def _dataset(rows: list[dict], levels: list[dict]) -> xr.Dataset:
    plain = {f"compared_{name}" if name in ("mode", "quantity") else name: name for name in rows[0]}
    made = {key: np.array([one[name] for one in rows]) for key, name in plain.items()}
    made |= {f"of_group_{name}": np.array([one[name] for one in levels]) for name in levels[0]}
    return dataset("pooling/groups", made)


def _at(one: xr.Dataset) -> str:
    """The largest difference in words."""
    sensor = one["largest_sensor"].item()
    size, std = 100.0 * float(one["largest"]), 100.0 * float(one["largest_std"])
    digits = max(0, -int(np.floor(np.log10(max(std, 1e-9)))))
    return (
        f"{length(float(one['largest_amplitude']))}{' at ' + sensor if sensor else ''} "
        f"{size:.{digits}f} ± {std:.{digits}f} % larger "
        f"in {one['largest_high'].item()} than in {one['largest_low'].item()}"
    )


def group_sentences(differences: xr.Dataset) -> list[str]:
    """A sentence for each mode and quantity in which groups differ."""
    lines = []
    for k in np.flatnonzero(differences["told"].values):
        one = differences.isel(comparison=int(k))
        name = str(one["compared_quantity"].item()).replace("_", " ")
        size, std = 100.0 * float(one["difference"]), 100.0 * float(one["difference_std"])
        digits = max(0, 1 - int(np.floor(np.log10(max(std, 1e-9)))))
        lines.append(
            f"the {name} of mode {one['compared_mode'].item()} depends on the group: in "
            f"{one['high_group'].item()} it is {size:.{digits}f} ± {std:.{digits}f} % larger than "
            f"in {one['low_group'].item()}, mean over the amplitudes that both reach"
            + (f", and at {_at(one)}" if np.isfinite(one["largest"]) else "")
        )
    return lines
