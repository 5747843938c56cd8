"""Normal-load variation: vibration opens pairs of a flank that little pressure keeps closed.

Size: the largest relative fall of a frequency at a record's highest amplitude at the middle
force, over modes; the part of the nominal pressure that acts, the same at all forces, follows from
it. A pair that has parted carries no normal load; there is no loss.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "amplitude"
UNIT = "1"
BOUND = 3e-4
SIGNED = False
TUNED = "frequency"


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, preload=size)
