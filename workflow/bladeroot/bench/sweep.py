"""Slip of the sliders under given forces: pair by pair in turn, until none moves any more."""

from typing import no_type_check

import numpy as np

from bladeroot.compiled import njit

# Part of its limit from which on a pair is near it: what the slip of others may add in a step is
# less as a rule.
_NEAR_LIMIT = 0.8


@njit(cache=True)
@no_type_check
def copied(source, target):
    """Copy an array; a slice's assignment would compile its error message, too, for a second."""
    for i in range(target.size):
        target[i] = source[i]


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

    `force` (N) of the sliders and their `slip` (m) are changed in place; at the start `slip` may be
    any guess that `force` already contains. `give` (N/m) is by how much the forces fall for each
    slip, `rho` that of `own_give`, `tolerance` the largest move relative to the limit that counts
    as none; moves below a tenth of it are not made.
    """
    least = 0.1 * tolerance
    sweep = 0
    change = 1.0
    while change > tolerance and sweep < sweeps:
        change = 0.0
        sweep += 1
        for i in range(limit.size):
            p, q = 2 * i, 2 * i + 1
            trial_p = force[p] + rho[i] * slip[p]
            trial_q = force[q] + rho[i] * slip[q]
            square = trial_p * trial_p + trial_q * trial_q
            over = 0.0
            if square > limit[i] * limit[i]:
                over = 1.0 - limit[i] / np.sqrt(square)
            elif slip[p] == 0.0 and slip[q] == 0.0:
                continue
            move_p = over * trial_p / rho[i] - slip[p]
            move_q = over * trial_q / rho[i] - slip[q]
            moved = rho[i] * np.sqrt(move_p * move_p + move_q * move_q) / limit[i]
            if moved <= least:
                continue
            change = max(change, moved)
            slip[p] += move_p
            slip[q] += move_q
            for j in range(force.size):
                force[j] -= give[p, j] * move_p + give[q, j] * move_q
    return sweep


@njit(cache=True)
@no_type_check
def settle_leading(force, slip, before, give, rho, limit, tolerance, sweeps):
    """`settle`, quicker where the pairs are in the order in which they come to slip.

    Only those up to the last that is near its limit are swept over. The others' forces follow
    once, and if that brings one over its limit, all are settled. `before` is written to.
    """
    pairs = 0
    for i in range(limit.size):
        p, q = 2 * i, 2 * i + 1
        reach = force[p] * force[p] + force[q] * force[q]
        if slip[p] != 0.0 or slip[q] != 0.0 or reach > (_NEAR_LIMIT * limit[i]) ** 2:
            pairs = i + 1
    lead = 2 * pairs
    copied(slip[:lead], before[:lead])
    count = settle(force[:lead], slip[:lead], give, rho[:pairs], limit[:pairs], tolerance, sweeps)
    for p in range(lead):
        move = slip[p] - before[p]
        if move != 0.0:
            for j in range(lead, force.size):
                force[j] -= give[p, j] * move
    if largest(force[lead:], limit[pairs:]) > 1.0:
        count = max(count, settle(force, slip, give, rho, limit, tolerance, sweeps))
    return count


@njit(cache=True)
@no_type_check
def largest(force, limit):
    """Largest force of a pair over its limit."""
    square = 0.0
    for i in range(limit.size):
        own = force[2 * i] * force[2 * i] + force[2 * i + 1] * force[2 * i + 1]
        square = max(square, own / (limit[i] * limit[i]))
    return np.sqrt(square)
