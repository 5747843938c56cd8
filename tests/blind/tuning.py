"""Hidden effects by name: their files, and the cause behind a size that says what is seen."""

from collections.abc import Sequence
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

import numpy as np
import pandas as pd
from bladeroot.bench import effects
from bladeroot.bench.clamping import clamp
from bladeroot.bench.conditions import Conditions, Moment, baseline, moments
from bladeroot.bench.joint import Parts
from cycle import cycle_curves

# Searched causes: friction coefficient and part of the pressure.
_CAUSES = np.geomspace(1e-3, 30.0, 600)


def ids() -> list[str]:
    """Names of all effects, in the order of the alphabet."""
    return sorted(module.name.replace("_", "-") for module in iter_modules(effects.__path__))


def effect(name: str) -> ModuleType:
    """The file of an effect. Raises ValueError if there is none of that name."""
    if name not in ids():
        raise ValueError(f"expected one of the effects {', '.join(ids())}, got {name!r}")
    return import_module(f"{effects.__name__}.{name.replace('-', '_')}")


def conditions_of(
    bench: dict, sheet: pd.DataFrame, hidden: Sequence[tuple[str, float]]
) -> list[Conditions]:
    """Conditions of each row of a sheet with hidden effects (name, cause).

    The joint answers to the force that there is, whatever order the effects are hidden in.
    """
    every = []
    for row, moment in zip(sheet.to_dict("records"), moments(bench, sheet), strict=True):
        true = baseline(bench, row)
        for name, cause in _force_first(hidden, true, moment):
            true = effect(name).change(true, cause, moment)
        every.append(true)
    return every


def _force_first(
    hidden: Sequence[tuple[str, float]], true: Conditions, moment: Moment
) -> list[tuple[str, float]]:
    """The effects, those that change the axial force before the others."""

    def keeps_force(one: tuple[str, float]) -> bool:
        name, cause = one
        return bool(effect(name).change(true, cause, moment).force == true.force)

    return sorted(hidden, key=keeps_force)


def cause_of(
    bench: dict,
    whole: Parts,
    rows: Sequence[dict],
    highest: dict[str, float],
    name: str,
    size: float,
) -> float:
    """What `change` of an effect takes for a size: the size, but for those that are TUNED.

    The sheet's rows at the middle force are moved through one cycle up to the `highest` amplitudes
    (m) of their modes. Raises ValueError if no cause gives so
    large an effect.
    """
    tuned = getattr(effect(name), "TUNED", None)
    if tuned is None:
        return size
    pressures = sorted({row["pressure_bar"] for row in rows})
    middle = pressures[len(pressures) // 2]
    some = {row["mode"]: row for row in rows if row["pressure_bar"] == middle}
    seen = np.zeros(_CAUSES.size)
    for mode, row in some.items():
        moment = Moment(bench["seed"], "", mode, "up", 0.0, 0.0, 1.0, 0.0, 0)
        one = effect(name).change(baseline(bench, row), 1.0, moment)
        clamping = clamp(bench, whole, row, one)
        # All limits are proportional to the cause, so an amplitude at cause c shows what the
        # amplitude over c does at cause 1.
        reach = np.geomspace(highest[mode] / _CAUSES[-1], highest[mode] / _CAUSES[0], 200)
        frequency, rate = cycle_curves(
            clamping.modes,
            clamping.number,
            float(clamping.loss_factor[clamping.number]),
            clamping.forces,
            clamping.limit,
            reach,
        )
        if tuned == "loss_factor":
            own = clamping.loss_factor[clamping.number]
            effect_at = rate / (np.pi * frequency) - own
        else:
            effect_at = 1 - frequency / clamping.frequency
        here = np.interp(highest[mode] / _CAUSES, reach, np.nan_to_num(effect_at, nan=np.inf))
        seen = np.maximum(seen, here)
    if seen.max() < size:
        raise ValueError(f"{name} cannot reach {size:g}, at most {seen.max():g}")
    last = np.flatnonzero(seen >= size).max()
    return float(_CAUSES[last])
