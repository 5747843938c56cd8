"""What the other modes of one motion may do to a mode's curves.

After a blow several modes ring at once, and what one of them does to a joint that they share, the
others feel: a small mode softens with the amplitude of a large one. No law over a mode's own
amplitude holds that, so it is an error of the curve, not a cause: for each other mode its own
change since small amplitudes, by its share of the displacement at the sensor.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.pooling.level_curve import COUPLING_VARIABLES, on_ladder


def coupling(
    decays: Sequence[xr.Dataset | None],
    rows: Sequence[dict],
    ladder: Float[ndarray, " amplitude"],
) -> dict[str, Float[ndarray, "record amplitude"]]:
    """Error of ln f and of the loss factor by the event's other modes at the same sensor.

    Args:
        decays: curves of the records, None where there is none.
        rows: `event`, `sensor` and `mode` of each record.
        ladder: amplitudes, m.
    """
    made = {name: np.zeros((len(rows), ladder.size)) for name in COUPLING_VARIABLES}
    place = [(row["event"], row["sensor"]) for row in rows]
    for i, own in enumerate(decays):
        others = [
            other
            for k, other in enumerate(decays)
            if place[k] == place[i] and rows[k]["mode"] != rows[i]["mode"] and other is not None
        ]
        if own is None or not place[i][0] or not others:
            continue
        for name, curve in zip(COUPLING_VARIABLES, ("frequency", "loss_factor"), strict=True):
            error = sum(_by(other, own, curve) for other in others)
            at = on_ladder(own.assign({name: ("point", error)}), name, ladder)
            made[name][i] = np.nan_to_num(at)
    return made


def _by(other: xr.Dataset, own: xr.Dataset, curve: str) -> Float[ndarray, " point"]:
    """The other mode's change at the times of this one's points, by its share of the motion."""
    value = other[curve].values
    value = np.log(value) if curve == "frequency" else value
    log_a = np.log(other["amplitude"].values)
    known = np.flatnonzero(np.isfinite(value) & np.isfinite(log_a))
    time = own["time"].values + own.attrs["start_s"]
    if known.size < 2:
        return np.zeros(time.size)
    small = log_a[known] <= np.median(log_a[known])
    change = np.abs(value[known] - np.median(value[known][small]))
    clock = other["time"].values[known] + other.attrs["start_s"]
    amplitude = np.exp(np.interp(time, clock, log_a[known], right=-np.inf))
    return np.interp(time, clock, change) * amplitude / (amplitude + own["amplitude"].values)
