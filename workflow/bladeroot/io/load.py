"""The load that a campaign varies: an axial force, a bolt's torque, a preload, a speed, or none.

It generalises the axial force: artifacts call its value `force` and say its name and unit in their
attributes. Forces are kept in newtons; every other load in the unit that the campaign states.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from bladeroot.loads import AXIAL_FORCE

# Unit of a column of the sheet, and its factor to the unit that is kept.
COLUMNS = {
    "force_N": ("N", 1.0),
    "force_kN": ("N", 1e3),
    "preload_N": ("N", 1.0),
    "preload_kN": ("N", 1e3),
    "pressure_bar": ("bar", 1.0),
    "torque_Nm": ("Nm", 1.0),
    "speed_rpm": ("rpm", 1.0),
    "temperature_C": ("C", 1.0),
    "load": ("", 1.0),
}
_FORCES = {"N": 1.0, "kN": 1e3}
# What turns a gauge's reading into a force, its full scale last.
_GAUGES = {
    "pressure": ("piston_area_cm2", "full_scale_bar"),
    "strain": ("section_mm2", "modulus_GPa", "full_scale_microstrain"),
}
# Loads that may be zero or negative.
_SIGNED = ("C", "K", "rpm", "Hz")


@dataclass(frozen=True)
class Load:
    """What is varied, and how well its reading is known.

    scale: of the load per unit of the gauge's reading (N per bar). full_scale: of the gauge, in the
    load's unit; inf where there is no gauge. accuracy_of: `full-scale`, `reading` or `absolute`;
    accuracy: its standard deviation, a part of the full scale or of the reading, or in the unit.
    given: factor from the unit that campaign.yaml states to `unit`.
    """

    name: str
    unit: str
    gauge: str = ""
    scale: float = 1.0
    full_scale: float = math.inf
    accuracy: float = 0.0
    accuracy_of: str = "absolute"
    given: float = 1.0

    @property
    def is_force(self) -> bool:
        """Whether a structure can be prestressed with it."""
        return self.unit == "N"

    @property
    def signed(self) -> bool:
        """Whether it may be zero or negative."""
        return self.unit in _SIGNED

    @property
    def same_everywhere(self) -> float:
        """Standard deviation of a reading that is the same at all loads, in the load's unit."""
        if self.accuracy_of == "full-scale":
            return self.full_scale * self.accuracy
        return self.accuracy if self.accuracy_of == "absolute" else 0.0

    @property
    def of_full_scale(self) -> float:
        """Standard deviation of a reading if the accuracy is meant of the full scale."""
        known = self.accuracy_of != "absolute" and math.isfinite(self.full_scale)
        return self.full_scale * self.accuracy if known else self.same_everywhere

    @property
    def of_reading(self) -> float:
        """Standard deviation of a reading over itself."""
        return 0.0 if self.accuracy_of == "absolute" else self.accuracy


def force_scale(gauge: Mapping) -> float:
    """Newtons per bar (F = A p) or per microstrain (F = A E strain) of a gauge (section 2.1.6)."""
    if gauge["gauge"] == "pressure":
        return gauge["piston_area_cm2"] * 1e-4 * 1e5
    return gauge["section_mm2"] * 1e-6 * gauge["modulus_GPa"] * 1e9 * 1e-6


def load_of(description: Mapping) -> Load | None:
    """The load of a checked campaign.yaml, None where it states none.

    Raises:
        ValueError: both `force` and `load`, or a gauge whose keys do not fit.
    """
    if "force" in description and "load" in description:
        raise ValueError("force and load say the same thing; one of them must go")
    said = dict(description.get("load") or description.get("force") or {})
    if not said:
        return None
    if "force" in description:
        said |= {"name": AXIAL_FORCE, "unit": "N"}
    factor = _FORCES.get(said["unit"], 1.0)
    unit = "N" if said["unit"] in _FORCES else said["unit"]
    gauge = said.get("gauge", "")
    scale, full_scale = factor, math.inf
    if gauge in _GAUGES:
        keys = _GAUGES[gauge]
        missing = [key for key in keys if key not in said]
        if missing:
            raise ValueError(f"a {gauge} gauge needs {', '.join(missing)}")
        if unit != "N":
            raise ValueError(f"a {gauge} gauge tells a force in N or kN, got unit {said['unit']!r}")
        scale = force_scale(said)
        full_scale = said[keys[-1]] * scale
    elif "full_scale" in said:
        full_scale = said["full_scale"] * factor
    of = said.get("accuracy_of", "reading")
    if {"accuracy", "accuracy_percent"} <= set(said):
        raise ValueError("accuracy and accuracy_percent say the same thing; one of them must go")
    if "accuracy_percent" in said:
        if of == "full-scale" and not math.isfinite(full_scale):
            raise ValueError("accuracy_of full-scale needs a full_scale")
        accuracy = said["accuracy_percent"] / 100.0
    else:
        accuracy, of = said.get("accuracy", 0.0) * factor, "absolute"
    return Load(said["name"], unit, gauge, scale, full_scale, accuracy, of, factor)


def factor_of(column: str, load: Load) -> float:
    """The factor from a column of the sheet to the load's unit.

    Raises:
        ValueError: the column is in another unit.
    """
    if column == "load":
        return load.given
    if column == "pressure_bar" and load.unit == "N":
        if load.gauge != "pressure":
            raise ValueError("pressure_bar needs a pressure gauge in campaign.yaml")
        return load.scale
    unit, factor = COLUMNS[column]
    if unit != load.unit:
        raise ValueError(
            f"{column} is in {unit}, the load of campaign.yaml ({load.name}) in {load.unit}"
        )
    return factor


def load_facts(load: Load | None) -> dict[str, str]:
    """Attributes that say what `force` is in an artifact; both empty without a load."""
    return {"load_name": load.name if load else "", "load_unit": load.unit if load else ""}
