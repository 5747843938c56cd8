"""A rig that gives more than the model's slots."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter
from bladeroot.rom.ritz import Ritz
from bladeroot.rom.sensitivity import Change, scaled


def structure(ritz: Ritz, values: np.ndarray) -> tuple[Change, list[Change]]:
    """The slots' stiffness times 1 - loss."""
    unit = scaled(ritz, "slot_stiffness")
    loss = min(float(values[0]), 0.9)
    return Change(-loss * unit.stiffness, unit.mass), [Change(-unit.stiffness, unit.mass)]


MECHANISM = Mechanism(
    id="rig-compliance",
    kind="level",
    sentence="slots and rig give more than the model's, which is fixed at the slots' far end",
    parameters=(
        Parameter(
            "loss", "1", 0.0, 0.15, -0.5, 0.9,
            "the slots' depth and base are not published: 14 to 40 mm were tried",
        ),
    ),
    splitter="an independent measure of the slots' stiffness: a tap test of the empty rig",
    structure=structure,
    starts=((0.15,),),
    measured_by="rig stiffness",
    needed=True,
)  # fmt: skip
