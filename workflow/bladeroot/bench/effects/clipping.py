"""Clipping: the converter's range is too small for half of the records.

Size: the part of the free decay's peak that is cut off.
"""

from dataclasses import replace

from bladeroot.bench.chance import generator
from bladeroot.bench.conditions import Conditions, Moment

CLASS = "record"
UNIT = "1"
BOUND = 0.10
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    chance = generator(moment.seed, "clipping", moment.record)
    if chance.uniform() > 0.5:
        return conditions
    return replace(conditions, clipped=size)
