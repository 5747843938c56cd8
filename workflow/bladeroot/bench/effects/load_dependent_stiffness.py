"""Load-dependent contact stiffness: the flanks' asperities are pressed together by the axial force.

Size: the exponent n of kn and kt proportional to F^n, with F the true axial force; both have
their drawn values at 12 kN.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "force-law"
UNIT = "1"
BOUND = 0.15
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    factor = (conditions.force / 12e3) ** size
    return replace(conditions, kn=conditions.kn * factor, kt=conditions.kt * factor)
