"""Joint slip: node pairs of the flanks slip where the shear exceeds Coulomb's limit.

Size: the largest rise of a loss factor at a record's highest amplitude at the middle force, over
modes; the friction coefficient that gives it is the same at all forces, and the limits grow with
the force.
"""

from dataclasses import replace

import numpy as np

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "amplitude"
UNIT = "1"
BOUND = 1e-3
SIGNED = False
TUNED = "loss_factor"


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    slip = conditions.friction if np.isfinite(conditions.friction) else 1.0
    return replace(conditions, friction=slip * size)
