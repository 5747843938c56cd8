"""Geometric hardening: bending stretches the beam between its roots, which stiffens it.

Size: alpha in 1B's restoring force, proportional to x (1 + alpha x^2) with x at the laser; the
other modes follow from the same axial stiffness.
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "amplitude"
UNIT = "1/m^2"
BOUND = 3e6
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    return replace(conditions, hardening=conditions.hardening + size)
