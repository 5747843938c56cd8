"""A modulus or a density that is not the model's."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter
from bladeroot.rom.ritz import Ritz
from bladeroot.rom.sensitivity import Change, scaled


def structure(ritz: Ritz, values: np.ndarray) -> tuple[Change, list[Change]]:
    """Modulus and density of beam and slots, relative to the model's."""
    modulus, density = values
    none = np.zeros_like(ritz.beam)
    stiff = scaled(ritz, "beam_stiffness").stiffness + scaled(ritz, "slot_stiffness").stiffness
    mass = scaled(ritz, "beam_mass").mass + scaled(ritz, "slot_mass").mass
    whole = Change(modulus * stiff, density * mass)
    return whole, [Change(stiff, none), Change(none, mass)]


MECHANISM = Mechanism(
    id="modulus-density",
    kind="level",
    sentence="the material is stiffer, softer, lighter or heavier than the model's",
    parameters=(
        Parameter(
            "modulus", "1", 0.0, 0.015, -0.1, 0.1,
            "steels of one grade scatter by 1 to 2 % in modulus",
        ),
        Parameter(
            "density", "1", 0.0, 0.005, -0.05, 0.05,
            "density scatters by half a per cent",
        ),
    ),
    splitter="a free-free test of the {beam} and its weight",
    structure=structure,
    starts=((0.02, 0.0), (-0.02, 0.0)),
    measured_by="free-free",
    needed=True,
)  # fmt: skip
