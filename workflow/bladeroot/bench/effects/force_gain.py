"""Force gain: the axial force is not what the gauge shows.

Size: g in F = (1 + g) times the reading.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "force-law"
UNIT = "1"
BOUND = 0.08
SIGNED = True


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, force=conditions.force + size * moment.reading)
