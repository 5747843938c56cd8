"""Added mass: a mass that the model lacks is fixed to the beam near mid-span.

Size: the mass (kg); it moves with the middle line in all directions, 4 mm from mid-span.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "level"
UNIT = "kg"
BOUND = 5e-3
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, added_mass=conditions.added_mass + size, added_mass_x=4e-3)
