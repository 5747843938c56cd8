"""Quadratic drag: the air brakes the beam with the square of its speed.

Size: growth of 1B's loss factor per metre of amplitude at the laser; the other modes follow from
the same drag a length of the beam.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "amplitude"
UNIT = "1/m"
BOUND = 50.0
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, drag=conditions.drag + size)
