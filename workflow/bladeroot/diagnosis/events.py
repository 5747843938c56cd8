"""One record of each event and mode: what several sensors saw of one motion is one observation."""

import numpy as np
import xarray as xr


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
