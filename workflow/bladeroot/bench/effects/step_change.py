"""Step change: something at the flanks gives way at one moment of the campaign.

Size: the part by which kn and kt are lower from then on; the moment lies between a quarter and
three quarters of the campaign.
"""

from dataclasses import replace

from bladeroot.bench.chance import generator
from bladeroot.bench.conditions import Conditions, Moment

CLASS = "time"
CAUSE = "ageing"  # of the catalogue: contact stiffness that changes at once
UNIT = "1"
BOUND = 0.10
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    moment_of_change = generator(moment.seed, "step").uniform(0.25, 0.75) * moment.duration
    if moment.time < moment_of_change:
        return conditions
    return replace(conditions, kn=conditions.kn * (1 - size), kt=conditions.kt * (1 - size))
