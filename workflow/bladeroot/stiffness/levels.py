"""Measured stick frequencies as the joint inference takes them: each with its own noise, and
which of them share clampings.
"""

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.sparse.csgraph import connected_components

# Least relative error of a level's frequency. No frequency repeats better: a steel's modulus
# changes by 2.5e-4 a kelvin, so 0.01 K is as much. The error of one clean record alone may be a
# thousand times smaller; beside the scatter of clampings it would be lost in rounding, and
# covariances would not be positive definite.
LEAST_FREQUENCY_STD = 1e-6


@dataclass(frozen=True)
class Levels:
    """One entry a mode and force.

    mode: index of the mode in `modes`. force: N. std: relative, without what a new clamping
    changes. clamping: the same number for levels that were measured on the same clampings;
    clampings: how many these are. clamping_std: relative scatter between clampings by each mode's
    repeats; clamping_freedom: its degrees of freedom (0: no repeats).
    """

    modes: tuple[str, ...]
    mode: Int[ndarray, " level"]
    force: Float[ndarray, " level"]
    ln_frequency: Float[ndarray, " level"]
    std: Float[ndarray, " level"]
    clamping: Int[ndarray, " level"]
    clampings: Float[ndarray, " level"]
    clamping_std: Float[ndarray, " mode"]
    clamping_freedom: Float[ndarray, " mode"]


def from_force(levels: Levels, least: float) -> Levels:
    """The levels at or above an axial force (N)."""
    kept = levels.force >= least
    names = ("mode", "force", "ln_frequency", "std", "clampings")
    parts = {name: getattr(levels, name)[kept] for name in names}
    clamping = np.unique(levels.clamping[kept], return_inverse=True)[1]
    return replace(levels, **parts, clamping=clamping)


def levels_of(stick: xr.Dataset, modes: tuple[str, ...]) -> Levels:
    """The levels of `bladeroot.pooling.stick` that belong to the given modes.

    A level's own noise is that within records and between records of a clamping, and at least
    `LEAST_FREQUENCY_STD`; of a table without records it is `frequency_std`. Two modes or forces
    share their clampings if the records say so. Raises ValueError if there is no level or a
    frequency has no error.
    """
    name, frequency = stick["mode"].values.astype(str), stick["frequency"].values
    chosen = np.flatnonzero(np.isin(name, modes) & np.isfinite(frequency))
    if not len(chosen):
        raise ValueError(f"no stick frequency of modes {', '.join(modes)}")
    here = stick.isel(level=chosen)
    mode = np.array([modes.index(one) for one in name[chosen]])
    force, frequency = here["force"].values.astype(float), here["frequency"].values.astype(float)
    repeated = here["hold_freedom"].values > 0
    records = np.maximum(here["records"].values, 1)
    scatter = np.nan_to_num(here["between_record_std"].values) / np.sqrt(records)
    own = np.where(
        repeated | (stick.sizes.get("record", 0) > 0),
        np.hypot(here["within_std"].values, scatter),
        here["frequency_std"].values,
    )
    if not np.all(own > 0.0):
        bad = int(np.flatnonzero(~(own > 0.0))[0])
        raise ValueError(
            f"a stick frequency must have a positive error, got {own[bad]} for mode "
            f"{modes[mode[bad]]} at {force[bad]:g} N"
        )
    clamping_std, freedom = np.zeros(len(modes)), np.zeros(len(modes))
    for m in range(len(modes)):
        of_mode = np.flatnonzero((mode == m) & repeated)
        if len(of_mode):
            relative = here["between_hold_std"].values[of_mode] / frequency[of_mode]
            clamping_std[m] = np.sqrt(np.mean(relative**2))
            freedom[m] = float(here["hold_freedom"].values[of_mode].max())
    return Levels(
        modes,
        mode,
        force,
        np.log(frequency),
        np.maximum(own / frequency, LEAST_FREQUENCY_STD),
        _clampings(stick, here, force),
        np.maximum(here["holds"].values, 1).astype(float),
        clamping_std,
        freedom,
    )


def _clampings(stick: xr.Dataset, here: xr.Dataset, force: ndarray) -> ndarray:
    """Numbers of clampings: levels have the same one if their records name one in common."""
    reached = stick["plateau_reached"].values == 1
    names = []
    for f, name in zip(force, here["mode"].values.astype(str), strict=True):
        own = reached & (stick["record_force"].values == f)
        own &= stick["record_mode"].values.astype(str) == name
        names.append(set(stick["hold"].values[own].astype(str)) - {""})
    shared = [[bool(one & two) for two in names] for one in names]
    return connected_components(np.array(shared), directed=False)[1]
