"""Spell (in no catalogue): for a part of the campaign something lies between the flanks.

Size: the part by which kn and kt are lower while it lasts; it begins between a fifth and two fifths
of the campaign and lasts a quarter of it.
"""

from dataclasses import replace

from bladeroot.bench.chance import generator
from bladeroot.bench.conditions import Conditions, Moment

CLASS = "outside"
UNIT = "1"
BOUND = 0.10
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    begin = generator(moment.seed, "spell").uniform(0.2, 0.4)
    if not begin < moment.time / moment.duration < begin + 0.25:
        return conditions
    return replace(conditions, kn=conditions.kn * (1 - size), kt=conditions.kt * (1 - size))
