"""Mode coupling (in no catalogue): a loose part resonates with 1B at one of the forces.

Size: its mass (kg) at mid-span; its frequency lies in the range that 1B covers, its loss factor
is 0.02.
"""

from dataclasses import replace

from bladeroot.bench.chance import generator
from bladeroot.bench.conditions import Conditions, Moment

CLASS = "outside"
UNIT = "kg"
BOUND = 2e-5
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    chance = generator(moment.seed, "coupling")
    return replace(
        conditions,
        oscillator=size,
        oscillator_Hz=float(chance.uniform(535.0, 555.0)),
        oscillator_loss=0.02,
    )
