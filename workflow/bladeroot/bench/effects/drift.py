"""Drift: the specimen warms up or cools, and its modulus with it.

Size: relative change of the frequencies from the campaign's first record to its last, linear in
time (half the change of the modulus).
"""

from dataclasses import replace

from bladeroot.bench.conditions import Conditions, Moment

CLASS = "time"
UNIT = "1"
BOUND = 2e-3
SIGNED = True


def change(conditions: Conditions, size: float, moment: Moment) -> Conditions:
    """Conditions of a record with the effect of the given size."""
    grown = 1 + 2 * size * moment.time / moment.duration
    return replace(conditions, modulus=conditions.modulus * grown)
