"""Force relaxation: the axial force creeps down after a clamping while the reading is kept.

Size: r in F = F_0 (1 - r log10(1 + t / 60 s)), with t since the hold's first record.
"""

from dataclasses import replace

import numpy as np

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "time"
UNIT = "1"
BOUND = 5e-3
SIGNED = False


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    lost = size * np.log10(1 + moment.since_clamping / 60)
    return replace(conditions, force=conditions.force * (1 - lost))
