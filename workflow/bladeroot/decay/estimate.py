"""A judged free decay to its curves over amplitude, with a second opinion on them."""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr

from bladeroot.decay.agreement import compare
from bladeroot.decay.freevib import freevib, no_decay
from bladeroot.decay.overrides import banded
from bladeroot.decay.pff import no_peaks, peak_fit


def estimate(
    cut: xr.Dataset,
    damping: str = "hysteretic",
    band_Hz: Sequence[float] | None = None,
    estimator: Callable[..., xr.Dataset] = freevib,
) -> xr.Dataset:
    """Curves of a record with its peaks beside them and their differences.

    A rejected record has no points; one that cannot be estimated is rejected.

    Args:
        cut: free decay as from `decay.free_decay`, with `expected_Hz` in its attributes.
        damping: law of damping, "hysteretic" or "viscous".
        band_Hz: a person's band, outside which nothing counts.
        estimator: `freevib`, or another with its arguments.

    Returns:
        Variables of `freevib`, `peak_fit` and `compare`; attributes of `cut`.
    """
    if band_Hz is not None:
        cut = banded(cut, band_Hz)
    facts, made = cut.attrs | {"damping": damping}, None
    if facts["verdict"] == "usable":
        # a start that is masked is no part of the decay
        first = int(np.argmax(cut["usable"].values))
        begin_s = first / facts["sampling_Hz"]
        velocity = cut["velocity"].values[first:].astype(float)
        known = [facts[name] for name in ("sampling_Hz", "expected_Hz", "noise_velocity")]
        options = {"damping": damping, "usable": cut["usable"].values[first:].astype(bool)}
        separated = {}
        if estimator is freevib and "widening" in cut:
            time = cut["widening_time"].values - begin_s
            separated["taken"] = (time, cut["widening"].values, cut["doubt"].values)
        try:
            made = later(estimator(velocity, *known, **options, **separated), begin_s)
        except ValueError as error:
            facts |= {"verdict": "rejected", "reason": str(error)}
        else:
            peaks = later(peak_fit(velocity, *known, **options), begin_s)
            if separated:
                made.attrs["other_modes_Hz"] = np.atleast_1d(facts["components_Hz"]).tolist()
    if made is None:
        made, peaks = no_decay(), no_peaks()
    whole = made.assign({**peaks.variables, **compare(made, peaks).variables})
    return whole.assign_attrs(facts, estimator=estimator.__name__)


def later(made: xr.Dataset, seconds: float) -> xr.Dataset:
    """Curves whose times count from the start of the cut, which lies some seconds before theirs."""
    if not seconds:
        return made
    times = [name for name in ("time", "block_time", "pff_time") if name in made]
    moved = {name: (made[name] + seconds).assign_attrs(made[name].attrs) for name in times}
    return made.assign(moved)
