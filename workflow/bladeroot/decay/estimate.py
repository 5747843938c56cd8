"""All that is estimated of one free decay: its curves and a second opinion on them."""

from collections.abc import Callable, Sequence

import xarray as xr

from bladeroot.decay.agreement import compare
from bladeroot.decay.curves import curves, later, used
from bladeroot.decay.freevib import freevib
from bladeroot.decay.overrides import banded
from bladeroot.decay.pff import no_peaks, peak_fit


def estimate(
    cut: xr.Dataset,
    damping: str = "hysteretic",
    band_Hz: Sequence[float] | None = None,
    estimator: Callable[..., xr.Dataset] = freevib,
) -> xr.Dataset:
    """Curves of a record with its peaks beside them and their differences.

    Arguments as of `decay.curves.curves`; band_Hz: a person's band, outside which nothing counts.

    Returns:
        Variables of `freevib`, `peak_fit` and `compare`; attributes of `cut`. A rejected record, or
        one that cannot be estimated, has no points.
    """
    if band_Hz is not None:
        cut = banded(cut, band_Hz)
    made = curves(cut, damping, estimator)
    facts, peaks = made.attrs, no_peaks()
    if facts["verdict"] == "usable":
        velocity, usable, begin_s = used(cut)
        known = (facts[name] for name in ("sampling_Hz", "expected_Hz", "noise_velocity"))
        peaks = later(peak_fit(velocity, *known, usable=usable, damping=damping), begin_s)
    whole = made.assign({**peaks.variables, **compare(made, peaks).variables})
    return whole.assign_attrs(estimator=estimator.__name__)
