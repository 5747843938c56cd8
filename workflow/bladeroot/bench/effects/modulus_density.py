"""Modulus: the material is stiffer (or softer) than the model's, in beam and slots.

Size: relative change of the modulus; a change of density by as much the other way differs only
under axial force.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "level"
UNIT = "1"
BOUND = 0.01
SIGNED = True


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, modulus=conditions.modulus * (1 + size))
