"""Rig compliance: the slots give way more than the model's, as the rig behind them does.

Size: the part by which the slots' stiffness is lower.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "level"
UNIT = "1"
BOUND = 0.05
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, slot=conditions.slot * (1 - size))
