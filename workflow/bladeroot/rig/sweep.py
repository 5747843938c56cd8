"""Slip of the sliders under given forces: pair by pair in turn, until none moves any more."""

from typing import no_type_check

import numpy as np

from bladeroot.compiled import njit


@njit(cache=True)
@no_type_check
def own_give(give):
    """For each pair, the most that its force falls by for a unit of its own slip (N/m)."""
    pairs = give.shape[0] // 2
    most = np.zeros(pairs)
    for i in range(pairs):
        a, b, c = give[2 * i, 2 * i], give[2 * i, 2 * i + 1], give[2 * i + 1, 2 * i + 1]
        most[i] = 0.5 * (a + c) + np.sqrt(0.25 * (a - c) ** 2 + b * b)
    return most


@njit(cache=True)
@no_type_check
def settle(force, slip, give, rho, limit, tolerance, sweeps):
    """Let every pair slip until no force exceeds its limit; returns how many sweeps it took.

    `force` (N) of the sliders and their `slip` (m) are changed in place. `give` (N/m) is by how
    much the forces fall for each slip, `rho` that of `own_give`, `tolerance` the largest move
    relative to the limit that counts as none.
    """
    slip[:] = 0.0
    sweep = 0
    change = 1.0
    while change > tolerance and sweep < sweeps:
        change = 0.0
        sweep += 1
        for i in range(limit.size):
            p, q = 2 * i, 2 * i + 1
            trial_p = force[p] + rho[i] * slip[p]
            trial_q = force[q] + rho[i] * slip[q]
            size = np.sqrt(trial_p**2 + trial_q**2)
            over = 1.0 - limit[i] / size if size > limit[i] else 0.0
            move_p = over * trial_p / rho[i] - slip[p]
            move_q = over * trial_q / rho[i] - slip[q]
            if move_p == 0.0 and move_q == 0.0:
                continue
            change = max(change, rho[i] * np.sqrt(move_p**2 + move_q**2) / limit[i])
            slip[p] += move_p
            slip[q] += move_q
            for j in range(force.size):
                force[j] -= give[p, j] * move_p + give[q, j] * move_q
    return sweep
