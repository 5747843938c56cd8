"""Frequency and damping over amplitude at each load: the mean curves and levels, as one Dataset."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Int
from numpy import ndarray

from bladeroot.loads import load_attrs, load_facts_of, value_of
from bladeroot.pooling.components import pool
from bladeroot.pooling.level_curve import (
    LevelCurve,
    ladder_of,
    level_curve,
    on_one_ladder,
)
from bladeroot.variables import dataset

CURVES = ("frequency", "loss_factor")
# Endings of a curve's variables: the mean; its standard error with and without that of the records'
# levels; the scatter of records.
CURVE_PARTS = ("", "_std", "_change_std", "_scatter")
# Variables of a record's plateau that its level is taken from.
PLATEAU_VARIABLES = ("stick_frequency", "stick_frequency_std", "loss_factor", "loss_factor_std")

# Decades of amplitude that a curve reaches over, at least, to tell its change per decade.
SHORTEST_SLOPE_DECADES = 0.3


def mean_curves(decays: Sequence[xr.Dataset], plateaus: Sequence[xr.Dataset]) -> xr.Dataset:
    """The mean curve of each mode, load, group and sensor, on one ladder of amplitudes.

    decays: as from `bladeroot.decay.freevib.freevib`, with mode, force_N and simulated in the
    attributes. plateaus: of the same records; what is rejected there is left out. The change with
    amplitude is that of `bladeroot.pooling.level_curve`; the mean of the records' levels, pooled
    over all loads and groups of a mode as stick frequencies are (`bladeroot.pooling.components`),
    is put back. Nothing is extrapolated. Where no clamping repeats the error is a lower bound, and
    says so.

    Returns:
        dims level (mode, force, group, sensor) and amplitude (m): frequency (Hz) and loss_factor
        with their standard errors, with and without that of the levels (`_std`, `_change_std`), and
        the scatter between records, levels included (NaN for one record alone); `_per_decade`, the
        mean change in a decade of amplitude; `quantity`, what was measured; and `records`, how
        many reach the amplitude.
    """
    facts = load_facts_of(decays)
    pairs = [
        (decay, plateau)
        for decay, plateau in zip(decays, plateaus, strict=True)
        if decay.sizes["point"] > 1 and not str(plateau["verdict"].values).startswith("rejected")
    ]
    decays = [decay for decay, _ in pairs]
    level_of = [_level_of(decay.attrs) for decay in decays]
    measured = {_level_of(d.attrs): str(d.attrs.get("quantity", "velocity")) for d in decays}
    levels = sorted(measured)
    seen = _on_ladder(pairs)
    ladder = seen["amplitude"].values
    rows = [np.flatnonzero([one == own for one in level_of]) for own in levels]
    found = [level_curve(seen.isel(record=own)) for own in rows]
    shape = (len(levels), ladder.size)
    values = {f"{name}{part}": np.full(shape, np.nan) for name in CURVES for part in CURVE_PARTS}
    count, unknown = np.zeros(shape, dtype=int), []
    for kind in dict.fromkeys(_kind(own) for own in levels):
        here = [k for k, own in enumerate(levels) if _kind(own) == kind and found[k] is not None]
        if not here:
            continue
        level = np.repeat(np.arange(len(here)), [rows[k].size for k in here])
        clamping = _clampings([decays[i] for k in here for i in rows[k]])
        at = [np.searchsorted(ladder, found[k].amplitude) for k in here]
        for q, name in enumerate(CURVES):
            made, repeated = _absolute([found[k] for k in here], q, level, clamping)
            for k, own, parts in zip(here, at, made, strict=True):
                count[k, own] = found[k].records
                for part, value in zip(CURVE_PARTS, parts, strict=True):
                    values[f"{name}{part}"][k, own] = value
        unknown += [] if repeated else [kind[0]]
    for q, name in enumerate(CURVES):
        slopes = np.array([_slope(curve, q) for curve in found]).reshape(-1, 2)
        if q == 0 and len(slopes):  # of ln f so far
            slopes *= np.nanmean(values[name], axis=1, keepdims=True)
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


def _kind(level: tuple[str, float, str, str]) -> tuple[str, str]:
    """What levels that share their scatter have in common: the mode and the sensor."""
    return level[0], level[3]


def _strings(levels: Sequence[tuple], k: int) -> ndarray:
    return np.array([own[k] for own in levels], dtype=str)


def _slope(curve: LevelCurve | None, q: int) -> tuple[float, float]:
    """Mean change of a curve in a decade by a straight line, and its standard error."""
    if curve is None or np.ptp(decades := np.log10(curve.amplitude)) < SHORTEST_SLOPE_DECADES:
        return np.nan, np.nan
    apart = decades - decades.mean()
    weight = apart / (apart @ apart)
    covariance = curve.stated[q] + curve.repeats[q]
    return weight @ curve.mean[q], np.sqrt(weight @ covariance @ weight)


def _clampings(decays: Sequence[xr.Dataset]) -> Int[ndarray, " record"]:
    """Numbers of the clampings; records that name none are clampings of their own."""
    names = [str(own.attrs.get("hold", "")) or f"record {k}" for k, own in enumerate(decays)]
    return np.unique(names, return_inverse=True)[1]


def _on_ladder(pairs: Sequence[tuple[xr.Dataset, xr.Dataset]]) -> xr.Dataset:
    """Curves and plateaus of the records as `bladeroot.pooling.level_curve` reads them."""
    decays = [decay for decay, _ in pairs]
    ladder = ladder_of(decays)
    curves = {
        name: (("record", "amplitude"), value)
        for name, value in on_one_ladder(decays, ladder).items()
    }
    plateau = {
        name if "stick" in name else f"stick_{name}": (
            "record", np.array([float(one[name]) for _, one in pairs])
        )
        for name in PLATEAU_VARIABLES
    }  # fmt: skip
    seen = xr.Dataset({**curves, **plateau, "amplitude": ladder})
    return seen.assign(correlation_decades=("record", np.full(len(pairs), np.nan)))


def _absolute(
    curves: Sequence[LevelCurve],
    q: int,
    level: Int[ndarray, " record"],
    clamping: Int[ndarray, " record"],
) -> tuple[list[tuple[ndarray, ...]], bool]:
    """What `CURVE_PARTS` names of each level's curve, and whether clampings repeat.

    level, clamping: numbers of all their records. q: 0 the frequency, 1 the loss factor.
    """
    own, std = (
        np.concatenate([getattr(c, part)[q] for c in curves]) for part in ("own", "own_std")
    )
    use = np.isfinite(own)
    clamping = np.unique(clamping[use], return_inverse=True)[1]
    pooled = pool(own[use], std[use], level[use], clamping, np.zeros(use.sum()))
    apart = np.nan_to_num([pooled.record_std, pooled.clamping_std])
    made = []
    for curve, middle, middle_std in zip(curves, pooled.mean, pooled.std, strict=True):
        mean = curve.mean[q] + middle
        change = np.sqrt(np.diag(curve.stated[q] + curve.repeats[q]))
        scatter = np.sqrt(curve.scatter[q] ** 2 + apart @ apart)
        scatter = np.where(curve.records > 1, scatter, np.nan)
        mean, unit = (np.exp(mean), np.exp(mean)) if q == 0 else (mean, 1.0)
        made.append((mean, unit * np.hypot(change, middle_std), unit * change, unit * scatter))
    return made, pooled.clamping_freedom > 0
