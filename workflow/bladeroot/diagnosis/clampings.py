"""Which records are of one clamping."""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis import guards


def stated(
    hold: ndarray, record: ndarray, force: ndarray, direction: ndarray, time: ndarray
) -> tuple[ndarray, bool]:
    """Names of the records' holds, and whether any is only assumed.

    Of records without one, those that follow each other at one force and direction count as one
    clamping, as nobody takes a specimen out between two records that look alike: as clampings of
    their own, their likeness would pass for a scatter that is not there. Where times are missing
    each stands by itself.
    """
    unknown = hold == ""
    names = np.where(unknown, np.char.add("record ", record), hold)
    if not unknown.any() or not np.isfinite(time).all():
        return names, False
    order = np.argsort(time, kind="stable")
    before, after = order[:-1], order[1:]
    alike = (force[before] == force[after]) & (direction[before] == direction[after])
    alike &= unknown[before] & unknown[after]
    first = order[np.concatenate([[0], np.flatnonzero(~alike) + 1])]
    run = np.concatenate([[0], np.cumsum(~alike)])
    made = np.empty_like(names)
    made[order] = names[first][run]
    return made, bool(alike.any())


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
