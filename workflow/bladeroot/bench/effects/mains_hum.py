"""Mains hum: the laser's signal carries a line of the mains in every record.

Size: its velocity (m/s, peak), at 50 Hz or its third harmonic.
"""

from dataclasses import replace

from bladeroot.bench.chance import generator
from bladeroot.bench.conditions import Conditions, Moment

CLASS = "record"
UNIT = "m/s"
BOUND = 2e-4
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    chance = generator(moment.seed, "hum")
    return replace(conditions, hum=size, hum_Hz=float(chance.choice([50.0, 150.0])))
