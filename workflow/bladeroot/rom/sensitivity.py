"""What else moves a frequency: added mass, moduli, densities, compliant slots, kn, kt and force.

Linear changes of the joint's matrices inside the basis of one mode.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.ritz import Ritz


@dataclass(frozen=True)
class Change:
    """Stiffness and mass that one unit of a parameter adds, in the basis of one mode."""

    stiffness: Float[ndarray, "vector vector"]
    mass: Float[ndarray, "vector vector"]


def scaled(ritz: Ritz, part: str) -> Change:
    """One unit doubles the part: `beam_stiffness` (modulus), `slot_stiffness`, `beam_mass`, ...

    The geometric stiffness depends on the force alone and is not scaled.
    """
    nothing, unit = np.zeros_like(ritz.beam), np.eye(len(ritz.beam))
    changes = {
        "beam_stiffness": Change(ritz.beam, nothing),
        "slot_stiffness": Change(ritz.slots, nothing),
        "beam_mass": Change(nothing, ritz.beam_mass),
        "slot_mass": Change(nothing, unit - ritz.beam_mass),
    }
    if part not in changes:
        raise ValueError(f"a scaled part must be one of {', '.join(changes)}, got {part!r}")
    return changes[part]


def motion(ritz: Ritz, x: float) -> Float[ndarray, "3 vector"]:
    """Motion (X, Y, Z) of the display line at x (m) by basis vector, linear between its nodes."""
    order = np.argsort(ritz.display_x)
    along, rows = ritz.display_x[order], ritz.display[order]
    if not along[0] <= x <= along[-1]:
        raise ValueError(
            f"x must lie on the display line, {along[0]:g} to {along[-1]:g} m, got {x}"
        )
    right = int(np.clip(np.searchsorted(along, x), 1, len(along) - 1))
    share = (x - along[right - 1]) / (along[right] - along[right - 1])
    return (1.0 - share) * rows[right - 1] + share * rows[right]
