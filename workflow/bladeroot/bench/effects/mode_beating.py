"""Mode beating: the laser sees a second mode close to the measured one in every record.

Size: its velocity over the measured mode's; its frequency is 2 to 15 % away, the same for all
records of a mode.
"""

from dataclasses import replace

import numpy as np

from bladeroot.bench.chance import generator
from bladeroot.bench.conditions import Conditions, Moment

CLASS = "record"
UNIT = "1"
BOUND = 0.05
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    chance = generator(moment.seed, "beating", moment.mode)
    away = np.exp(chance.uniform(np.log(0.02), np.log(0.15)))
    ratio = 1 + away if chance.uniform() > 0.5 else 1 - away
    return replace(conditions, beating=size, beating_ratio=float(ratio))
