"""Force offset: something besides the oil pulls at the specimen (own weight, a stuck piston).

Size: the axial force (N) that acts at a reading of zero.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "level"
UNIT = "N"
BOUND = 1.5e3
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, force=conditions.force + size)
