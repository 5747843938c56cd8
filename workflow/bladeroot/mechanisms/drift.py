"""A modulus that wanders through the campaign, as with the temperature of the rig."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records
from bladeroot.structure.ritz import Ritz
from bladeroot.structure.sensitivity import Change, scaled


def structure(ritz: Ritz, values: np.ndarray) -> tuple[Change, list[Change]]:
    """Twice the change in the modulus of beam and slots; the axial force's stiffness stays."""
    parts = [scaled(ritz, part) for part in ("beam_stiffness", "slot_stiffness")]
    stiffness = 2.0 * (parts[0].stiffness + parts[1].stiffness)
    none = parts[0].mass
    return Change(values[0] * stiffness, none), [Change(stiffness, none)]


def course(records: Records) -> np.ndarray:
    """In proportion to time; none half-way through."""
    return records.time / records.span - 0.5 if records.span > 0.0 else 0.0 * records.time


MECHANISM = Mechanism(
    id="drift",
    kind="time",
    sentence="the modulus drifts through the campaign, as with the temperature of the rig",
    parameters=(
        Parameter(
            "change", "1", 0.0, 0.005, -0.03, 0.03,
            "of frequencies: steel's modulus falls by 2.4e-4 a kelvin, 10 K make 0.12 %",
        ),
    ),
    splitter="a thermometer on beam and rig; the first forces again at the end",
    structure=structure,
    course=course,
    over=("time",),
)  # fmt: skip
