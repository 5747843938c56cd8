"""Which records are of one clamping, and which of one motion."""

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis import guards


def hold_names(
    hold: ndarray, record: ndarray, force: ndarray, direction: ndarray, time: ndarray
) -> ndarray:
    """Names of the records' holds, all records of the campaign taken together.

    Of records without one, those that follow each other at one force and direction count as one
    clamping, as nobody takes a specimen out between two records that look alike: as clampings of
    their own, their likeness would pass for a scatter that is not there. A record without a time
    stands by itself, and all do where all times are one.
    """
    unknown = hold == ""
    names = np.where(unknown, np.char.add("record ", record), hold)
    order = np.flatnonzero(np.isfinite(time))
    order = order[np.argsort(time[order], kind="stable")]
    if not unknown.any() or not order.size or not np.ptp(time[order]) > 0.0:
        return names
    before, after = order[:-1], order[1:]
    alike = (force[before] == force[after]) & (direction[before] == direction[after])
    alike &= unknown[before] & unknown[after]
    first = order[np.concatenate([[0], np.flatnonzero(~alike) + 1])]
    names[order] = names[first][np.concatenate([[0], np.cumsum(~alike)])]
    return names


def directions(way: ndarray, hold: ndarray) -> ndarray:
    """+1 up, -1 down, 0 unknown; a record that says nothing was reached as others of its hold, or
    as all others where they say the same.
    """
    sign = np.where(way == "up", 1.0, np.where(way == "down", -1.0, 0.0))
    for one in np.unique(hold[sign == 0.0]):
        mine = hold == one
        said = np.unique(sign[mine & (sign != 0.0)])
        if said.size == 1:
            sign[mine] = said[0]
    said = np.unique(sign[sign != 0.0])
    return np.full(sign.size, said[0]) if said.size == 1 else sign


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


def thinned(
    row: Int[ndarray, " record"],
    mode: ndarray,
    hold: ndarray,
    level: ndarray,
    time: ndarray,
    most: int,
) -> Int[ndarray, " kept"]:
    """Of more than `most` records, the first and the last of each mode in a clamping, and more
    between them as far as that allows.

    Where these are too many, whole clampings are left out, evenly over levels, and over time in
    each. row: the records' numbers in the other arrays. level: what a level is told by, a row each.
    """
    if row.size <= most:
        return row
    time = np.nan_to_num(time)
    order = row[np.lexsort([row, time[row], mode[row], hold[row]])]
    last, then = order[:-1], order[1:]
    other = (mode[last] != mode[then]) | (hold[last] != hold[then])
    parts = np.split(order, np.flatnonzero(other) + 1)
    each = max(most // len(parts), 2)
    some = [part[_evenly(part.size, each)] for part in parts]
    kept = np.sort(np.concatenate(some))
    if kept.size > most:
        names, at = np.unique(hold[kept], return_index=True)
        first = kept[at]
        names = names[np.lexsort([first, time[first], *level[:, first]])]
        stay = names[_evenly(names.size, int(names.size * most / kept.size))]
        kept = kept[np.isin(hold[kept], stay)]
    return kept


def _evenly(count: int, most: int) -> Int[ndarray, " kept"]:
    """Numbers of `most` of `count` things in a row, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(int))


def one_of_each_event(seen: xr.Dataset) -> xr.Dataset:
    """The observations with the records of each mode's best sensor, where events have several.

    The best sensor of a mode is usable most often, and then has the smallest relative error of
    frequency; amplitudes of a mode are then those at one place. Noise is each sensor's own, but
    what happened is shared: a second sensor would pass for a repeat.
    """
    if "event" not in seen or "sensor" not in seen:
        return seen
    event, mode, sensor = (seen[name].values.astype(str) for name in ("event", "mode", "sensor"))
    keep = np.ones(event.size, bool)
    for one in np.unique(mode):
        mine = (mode == one) & (event != "")
        names = np.unique(sensor[mine])
        if names.size > 1:
            best = max(names, key=lambda name: _worth(seen, mine & (sensor == name)))
            keep &= ~mine | (sensor == best)
    return seen.isel(record=np.flatnonzero(keep)) if not keep.all() else seen


def _worth(seen: xr.Dataset, rows: np.ndarray) -> tuple[int, float]:
    """Usable records of a sensor, and minus the median relative error of their frequencies."""
    here = seen.isel(record=np.flatnonzero(rows & (seen["verdict"].values == "usable")))
    error = (here["frequency_std"] / here["frequency"]).values
    known = error[np.isfinite(error)]
    return here.sizes["record"], -float(np.median(known)) if known.size else -np.inf
