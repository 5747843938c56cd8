"""Ageing: each new clamping flattens the flanks a little more.

Size: b in kn and kt proportional to (1 + number of clampings before)^b.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "time"
UNIT = "1"
BOUND = 0.10
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    factor = (1 + moment.clampings) ** size
    return replace(conditions, kn=conditions.kn * factor, kt=conditions.kt * factor)
