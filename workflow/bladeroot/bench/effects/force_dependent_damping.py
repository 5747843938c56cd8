"""Force-dependent damping: the material's damping depends on the axial stress.

Size: p in loss factors proportional to F^p, as drawn at 12 kN.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "force-law"
UNIT = "1"
BOUND = 0.10
SIGNED = True


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, loss=conditions.loss * (conditions.force / 12e3) ** size)
