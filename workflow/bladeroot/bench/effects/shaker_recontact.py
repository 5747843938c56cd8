"""Shaker re-contact: the tip touches the specimen once more during half of the decays.

Size: the step of the velocity over the mode's amplitude at that moment, within the first third of
the decay.
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
    chance = generator(moment.seed, "recontact", moment.record)
    if chance.uniform() > 0.5:
        return conditions
    return replace(conditions, touched=size, touched_at=float(chance.uniform(0.05, 0.3)))
