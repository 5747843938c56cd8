"""Which records are of one clamping."""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis import guards


def clampings(
    mode: ndarray,
    hold: Int[ndarray, " record"],
    time: Float[ndarray, " record"],
    ln_f: Float[ndarray, " record"],
    std: Float[ndarray, " record"],
) -> tuple[Int[ndarray, " record"], list[int]]:
    """Numbers of the clampings, and the numbers of the holds that count as two.

    A hold is one clamping unless a frequency jumps within it. The jump would pass for noise of all
    records, and what tells causes in time from others, how little records of a hold differ, would
    be lost.
    """
    split, jumped = hold.copy(), []
    for one in np.unique(mode):
        order = np.flatnonzero(mode == one)
        order = order[np.lexsort((time[order], hold[order]))]
        before, after = order[:-1], order[1:]
        within = hold[before] == hold[after]
        before, after = before[within], after[within]
        if not after.size:
            continue
        change = ln_f[after] - ln_f[before]
        off = np.abs(change - np.median(change))
        far = off / np.hypot(np.median(off), np.hypot(std[before], std[after]))
        for k in np.flatnonzero(far > guards.JUMP):
            number = int(hold[after[k]])
            if number not in jumped:
                jumped.append(number)
                split[(hold == number) & (time >= time[after[k]])] = hold.max() + len(jumped)
    return split, jumped
