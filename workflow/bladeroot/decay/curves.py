"""A judged free decay to its curves over amplitude."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.decay.freevib import freevib, no_decay


def curves(
    cut: xr.Dataset,
    damping: str = "hysteretic",
    estimator: Callable[..., xr.Dataset] = freevib,
) -> xr.Dataset:
    """Variables of `freevib` and attributes of the cut.

    A rejected record has no points; one that cannot be estimated is rejected.

    Args:
        cut: free decay as from `decay.free_decay`, with `expected_Hz` in its attributes.
        damping: law of damping, "hysteretic" or "viscous".
        estimator: `freevib`, or another with its arguments.
    """
    facts, made = dict(cut.attrs), no_decay()
    if facts["verdict"] == "usable":
        try:
            made = _estimated(cut, damping, estimator)
        except ValueError as error:
            facts |= {"verdict": "rejected", "reason": str(error)}
    return made.assign_attrs(facts | {"damping": damping})


def used(cut: xr.Dataset) -> tuple[Float[ndarray, " sample"], Bool[ndarray, " sample"], float]:
    """Velocity and its mask, from the first usable sample on, and that sample's time, s.

    A start that is masked is no part of the decay.
    """
    velocity, usable = cut["velocity"].values.astype(float), cut["usable"].values.astype(bool)
    first = int(np.argmax(usable))
    return velocity[first:], usable[first:], first / cut.attrs["sampling_Hz"]


def later(made: xr.Dataset, seconds: float) -> xr.Dataset:
    """Curves whose times count from the start of the cut, which lies some seconds before theirs."""
    times = [name for name in ("time", "block_time", "pff_time") if name in made]
    moved = {name: (made[name] + seconds).assign_attrs(made[name].attrs) for name in times}
    return made.assign(moved)


def _estimated(cut: xr.Dataset, damping: str, estimator: Callable[..., xr.Dataset]) -> xr.Dataset:
    velocity, usable, begin_s = used(cut)
    facts, options = cut.attrs, {"damping": damping, "usable": usable}
    separated = estimator is freevib and "widening" in cut
    if separated:
        time = cut["widening_time"].values - begin_s
        options["taken"] = (time, cut["widening"].values, cut["doubt"].values)
    known = (facts[name] for name in ("sampling_Hz", "expected_Hz", "noise_velocity"))
    made = later(estimator(velocity, *known, **options), begin_s)
    if separated:
        made.attrs["other_modes_Hz"] = np.atleast_1d(facts["components_Hz"]).tolist()
    return made
