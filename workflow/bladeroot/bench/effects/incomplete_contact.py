"""Incomplete contact: at low force only a part of each flank touches.

Size: the force F_c of the part in contact, 1 - exp(-F / F_c), by which kn and kt are multiplied;
F is the true axial force.
"""

from dataclasses import replace

import numpy as np

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "force-law"
UNIT = "N"
BOUND = 2.5e3
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    part = -np.expm1(-conditions.force / size)
    return replace(conditions, kn=conditions.kn * part, kt=conditions.kt * part)
