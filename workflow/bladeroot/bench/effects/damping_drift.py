"""Damping drift: damping alone changes with time, as with a glue that warms up.

Size: relative change of all loss factors from the campaign's first record to its last.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "time"
UNIT = "1"
BOUND = 0.10
SIGNED = True


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, loss=conditions.loss * (1 + size * moment.time / moment.duration))
