"""Mass on the beam that the model does not have."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter
from bladeroot.rom.ritz import Ritz
from bladeroot.rom.sensitivity import Change, motion

_PLACE_STEP = 1e-3  # m, over which the derivative by the place is a difference


def structure(ritz: Ritz, values: np.ndarray) -> tuple[Change, list[Change]]:
    """Mass (kg) at a place on the display line (m from its middle), moving with it."""
    mass, x = values
    first, last = float(ritz.display_x.min()), float(ritz.display_x.max())
    reach = 0.5 * (last - first) - 1.01 * _PLACE_STEP
    x = 0.5 * (first + last) + float(np.clip(x, -reach, reach))
    none = np.zeros_like(ritz.beam)

    def unit(place: float) -> np.ndarray:
        rows = motion(ritz, place)
        return rows.T @ rows

    along = (unit(x + _PLACE_STEP) - unit(x - _PLACE_STEP)) / (2.0 * _PLACE_STEP)
    here = unit(x)
    return Change(none, mass * here), [Change(none, here), Change(none, mass * along)]


MECHANISM = Mechanism(
    id="added-mass",
    kind="level",
    sentence="something on the {beam} that the model lacks: a sensor, a target, a shaker's pad",
    parameters=(
        Parameter(
            "mass", "kg", 0.0, 0.015, 0.0, 0.1,
            "an accelerometer with its cable 2 to 30 g",
        ),
        Parameter(
            "place", "m", 0.0, 0.01, -0.15, 0.15,
            "sensors and shaker sit at mid-span",
        ),
    ),
    splitter="weigh the {beam} as tested, or ring it down free-free with what is mounted on it",
    structure=structure,
    starts=((0.02, 0.0),),
    measured_by="weighing",
)  # fmt: skip
