"""A campaign's own load and amplitude in the catalogue's terms, and back.

The priors of the catalogue are of the order of one machine: some kilonewtons and some micrometres.
Without a structure that ties a campaign to that machine, its load is taken in units of its own
range's geometric middle and its amplitude in units of its largest one, and the sizes that are found
are told in the campaign's units.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from bladeroot.loads import shown
from bladeroot.stiffness.priors import REFERENCE_FORCE

# The largest amplitude that the catalogue's priors are made for, m.
REFERENCE_AMPLITUDE = 2e-5
_TOKEN = re.compile(r"([A-Za-z]+)(\d*)")
_LOADS = ("force", "stick_force", "curve_force", "law_force", "interface_load", "new_force")
_AMPLITUDES = ("amplitude", "curve_amplitude", "onset_amplitude")


@dataclass(frozen=True)
class OwnRange:
    """per_load: newtons of the catalogue for one unit of the load, after `shift` is added to it;
    per_metre: metres of the catalogue for one of the amplitude. unit, name: the load's.
    """

    per_load: float
    shift: float
    per_metre: float
    unit: str
    name: str

    def factor(self, unit: str) -> tuple[float, str]:
        """From a size in the catalogue's unit to the campaign's, and that unit as text."""
        top, _, bottom = unit.partition("/")
        scale, parts = 1.0, {"N": self.per_load, "m": self.per_metre}
        if not set(re.findall(r"[A-Za-z]+", unit)) & {"N", "m"}:
            return 1.0, unit
        names = {"N": self.unit, "m": "m"}
        said = []
        for part, sign in ((top, -1.0), (bottom, 1.0)):
            for symbol, power in _TOKEN.findall(part):
                if symbol in parts:
                    scale *= parts[symbol] ** (sign * float(power or 1))
            text = _TOKEN.sub(lambda one: names.get(one[1], one[1]) + one[2], part)
            said.append(text.strip())
        return scale, said[0] + (f"/{said[1]}" if said[1] else "")


def own_range(seen: xr.Dataset) -> OwnRange:
    """From the observations: the load's range and the largest amplitude of any record."""
    force = seen["force"].values.astype(float)
    _, unit, name = shown(seen.attrs)
    unit = "N" if unit == "kN" else unit
    low, high = (float(edge(force)) for edge in (np.min, np.max)) if force.size else (0.0, 0.0)
    if not name or not force.size:
        per_load, shift = REFERENCE_FORCE, 1.0 - low  # one condition: the reference itself
    elif low > 0.0:
        per_load, shift = REFERENCE_FORCE / float(np.sqrt(low * high)), 0.0
    else:  # a load with no zero of its own: half to one and a half of the reference
        wide = max(high - low, 1e-9)
        per_load, shift = REFERENCE_FORCE / wide, 0.5 * wide - low
    known = np.isfinite(seen["frequency"].values) if "frequency" in seen else np.zeros((0, 0))
    top = seen["amplitude"].values[known.any(axis=0)].max(initial=0.0) if known.size else 0.0
    per_metre = REFERENCE_AMPLITUDE / top if top > 0.0 else 1.0
    return OwnRange(per_load, shift, per_metre, unit, name)


def in_catalogue(seen: xr.Dataset, own: OwnRange) -> xr.Dataset:
    """Observations with load and amplitude in the catalogue's terms."""
    made = seen.copy()
    made["force"] = (seen["force"] + own.shift) * own.per_load
    made = made.assign_coords(amplitude=seen["amplitude"] * own.per_metre)
    made["onset_amplitude"] = seen["onset_amplitude"] * own.per_metre
    for name in ("gauge_full_scale_std_N", "gauge_resolution_N"):
        made.attrs[name] = float(seen.attrs[name]) * own.per_load
    return made


def dataset_in_own(found: xr.Dataset, own: OwnRange) -> xr.Dataset:
    """A diagnosis's Dataset with load and amplitude in the campaign's units."""
    made = found.copy()
    about = {"units": own.unit, "long_name": own.name or "no load"}
    for name in _LOADS:
        if name in made.variables:
            values = made[name].values / own.per_load - own.shift
            made[name] = (made[name].dims, values if own.name else 0.0 * values, about)
    for name in _AMPLITUDES:
        if name in made.variables:
            made[name] = (made[name].dims, made[name].values / own.per_metre, made[name].attrs)
    return made


def verdict_in_own(said: Mapping, own: OwnRange) -> dict:
    """A verdict with the sizes of its causes in the campaign's units."""
    made = dict(said)
    made["causes"] = [
        cause | {"parameters": [_sized(one, own) for one in cause["parameters"]]}
        for cause in said["causes"]
    ]
    made["next"] = [
        one if one["load"] is None else one | {"load": one["load"] / own.per_load - own.shift}
        for one in said["next"]
    ]
    return made


def _sized(one: Mapping, own: OwnRange) -> dict:
    factor, unit = own.factor(one["unit"])
    shift = own.shift if one["unit"] == "N" else 0.0
    return {**one, "value": factor * one["value"] - shift, "std": factor * one["std"], "unit": unit}
