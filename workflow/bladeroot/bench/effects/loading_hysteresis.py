"""Loading hysteresis: the flanks are stiffer when a force was come down to than when gone up to.

Size: h in kn and kt times (1 + h/2) on the way down, (1 - h/2) on the way up.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "direction"
UNIT = "1"
BOUND = 0.10
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    factor = 1 + size / 2 * (1 if moment.direction == "down" else -1)
    return replace(conditions, kn=conditions.kn * factor, kt=conditions.kt * factor)
