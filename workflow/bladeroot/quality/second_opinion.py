"""A second opinion on a record's curves: peak fitting, and whether the two agree."""

import numpy as np
import xarray as xr

from bladeroot.quality.agreement import compare
from bladeroot.quality.peak_fit import no_peaks, peak_fit


def with_second_opinion(curves: xr.Dataset, decay: xr.Dataset) -> xr.Dataset:
    """Curves over amplitude with the peaks of their decay beside them, and the differences.

    Nothing is rejected for what the two differ by.

    Args:
        curves: as from `bladeroot.decay.freevib.freevib`, with `verdict` and `damping` in their
            attributes; of a rejected record without points.
        decay: the judged free decay that they were made of, with `usable`.

    Returns:
        `curves` with the variables of `peak_fit` and `compare`.
    """
    peaks = no_peaks()
    if curves.attrs["verdict"] == "usable":
        facts = decay.attrs
        first = int(np.argmax(decay["usable"].values))  # a masked start is no part of the decay
        peaks = peak_fit(
            decay["velocity"].values[first:].astype(float),
            *(facts[name] for name in ("sampling_Hz", "expected_Hz", "noise_velocity")),
            usable=decay["usable"].values[first:].astype(bool),
            damping=curves.attrs["damping"],
        )
        time = peaks["pff_time"]
        peaks["pff_time"] = time.copy(data=time.values + first / facts["sampling_Hz"])
    return curves.assign({**peaks.variables, **compare(curves, peaks).variables})
