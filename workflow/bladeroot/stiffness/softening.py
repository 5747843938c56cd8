"""Measured curves as the inference takes them: how far frequency falls and damping rises by slip.

Each record is counted from its own stick frequency and loss factor, so that what a clamping or the
gauge does to these drops out. Records of a level are averaged.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, fields

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

A_DECADE = 10  # amplitudes of the ladder
_LEAST = 2e-4  # of the stick frequency: less softening than this is not used
_CLEAR = 4.0  # in standard errors


@dataclass(frozen=True)
class Softening:
    """Points of the curves, one entry a level and amplitude (m).

    level: number of the level. fall: f / f_stick - 1. rise: eta - eta_stick. Their standard errors
    are of the measurement alone. holds: clampings behind the point.
    """

    level: Int[ndarray, " point"]
    amplitude: Float[ndarray, " point"]
    fall: Float[ndarray, " point"]
    fall_std: Float[ndarray, " point"]
    rise: Float[ndarray, " point"]
    rise_std: Float[ndarray, " point"]
    holds: Float[ndarray, " point"]


def softening_of(
    decays: Mapping[str, xr.Dataset], stick: xr.Dataset, levels: list[tuple[str, float]]
) -> Softening:
    """Points of the given levels (mode, force as read in N).

    decays: from `bladeroot.decay.estimate`, by record. stick: from `bladeroot.pooling.stick`.
    Only records that reach their plateau count, and points at which the frequency has clearly
    fallen.
    """
    rows: list[tuple] = []
    for number, (mode, force) in enumerate(levels):
        own = (
            (stick["record_mode"].values.astype(str) == mode)
            & (stick["record_force"].values == force)
            & (stick["plateau_reached"].values == 1)
        )
        records = [str(name) for name in stick["record"].values[own] if str(name) in decays]
        hold = dict(zip(stick["record"].values.astype(str), stick["hold"].values, strict=True))
        curves = [_on_ladder(decays[name], stick.sel(record=name)) for name in records]
        for k in sorted({k for curve in curves for k in curve}):
            here = [(name, c[k]) for name, c in zip(records, curves, strict=True) if k in c]
            value = np.array([point for _, point in here])
            fall, fall_std, rise, rise_std = _mean(value[:, 0], value[:, 1]) + _mean(
                value[:, 2], value[:, 3]
            )
            if fall < -_LEAST and -fall > _CLEAR * fall_std:
                holds = len({str(hold[name]) for name, _ in here})
                size = 10.0 ** (k / A_DECADE)
                rows.append((number, size, fall, fall_std, rise, rise_std, float(holds)))
    columns = np.array(rows).reshape(-1, 7).T
    return Softening(columns[0].astype(int), *columns[1:])


def of_modes(
    softening: Softening, levels: list[tuple[str, float]], modes: Collection[str]
) -> Softening:
    """The points of some modes."""
    own = np.array([levels[k][0] in modes for k in softening.level])
    return Softening(*(getattr(softening, field.name)[own] for field in fields(Softening)))


def _mean(value: ndarray, std: ndarray) -> tuple[float, float]:
    weight = 1.0 / std**2
    return float(weight @ value / weight.sum()), float(weight.sum() ** -0.5)


def _on_ladder(decay: xr.Dataset, stick: xr.Dataset) -> dict[int, tuple[float, ...]]:
    """Fall and rise with their errors at the rungs that a record's curve reaches."""
    amplitude = decay["amplitude"].values
    order = np.argsort(amplitude)
    order = order[np.isfinite(amplitude[order])]
    x = A_DECADE * np.log10(amplitude[order])
    if len(x) < 2:
        return {}
    rungs = np.arange(np.ceil(x[0]), np.floor(x[-1]) + 1).astype(int)
    columns = [
        np.interp(rungs, x, decay[name].values[order])
        for name in ("frequency", "frequency_std", "loss_factor", "loss_factor_std")
    ]
    f0, f0_std = float(stick["stick_frequency"]), float(stick["stick_frequency_std"])
    e0, e0_std = float(stick["record_loss_factor"]), float(stick["record_loss_factor_std"])
    f, f_std, e, e_std = columns
    values = (f / f0 - 1.0, np.hypot(f_std, f0_std) / f0, e - e0, np.hypot(e_std, e0_std))
    good = np.isfinite(np.array(values)).all(axis=0)
    return {
        int(k): tuple(v) for k, v, ok in zip(rungs, np.array(values).T, good, strict=True) if ok
    }
