"""Cubic softening: the tangential springs soften elastically, without any loss.

Size: s in the spring's force kt (u - s u^3), with the shear displacement u of a pair.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "amplitude"
UNIT = "1/m^2"
BOUND = 2e12
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, tangential_cubic=size)
