"""A judged free decay to its curves over amplitude."""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.decay.freevib import freevib, no_decay
from bladeroot.decay.overrides import in_band


def curves(
    cut: xr.Dataset,
    damping: str = "hysteretic",
    band_Hz: Sequence[float] | None = None,
    estimator: Callable[..., xr.Dataset] = freevib,
) -> xr.Dataset:
    """Variables of `freevib` and attributes of the cut.

    A rejected record has no points; one that cannot be estimated is rejected.

    Args:
        cut: free decay as from `decay.free_decay`, with `expected_Hz` in its attributes.
        damping: law of damping, "hysteretic" or "viscous".
        band_Hz: a person's band, outside which nothing counts.
        estimator: `freevib`, or another with its arguments.
    """
    facts, made = dict(cut.attrs), no_decay()
    if facts["verdict"] == "usable":
        try:
            made = _estimated(cut, damping, band_Hz, estimator)
        except ValueError as error:
            facts |= {"verdict": "rejected", "reason": str(error)}
    return made.assign_attrs(facts | {"damping": damping})


def used(
    cut: xr.Dataset, band_Hz: Sequence[float] | None = None
) -> tuple[Float[ndarray, " sample"], Bool[ndarray, " sample"], float]:
    """Velocity within the band and its mask, from the first usable sample on, and its time, s.

    A start that is masked is no part of the decay. Raises ValueError as `in_band` does.
    """
    velocity, usable = cut["velocity"].values.astype(float), cut["usable"].values.astype(bool)
    rate = cut.attrs["sampling_Hz"]
    if band_Hz is not None:
        velocity, lost = in_band(velocity, rate, band_Hz, cut.attrs["expected_Hz"])
        usable = usable.copy()
        usable[:lost] = usable[velocity.size - lost :] = False
    first = int(np.argmax(usable))
    return velocity[first:], usable[first:], first / rate


def later(made: xr.Dataset, seconds: float) -> xr.Dataset:
    """Curves whose times count from the start of the cut, which lies some seconds before theirs."""
    times = [name for name in ("time", "block_time", "pff_time") if name in made]
    moved = {name: (made[name] + seconds).assign_attrs(made[name].attrs) for name in times}
    return made.assign(moved)


def _estimated(
    cut: xr.Dataset,
    damping: str,
    band_Hz: Sequence[float] | None,
    estimator: Callable[..., xr.Dataset],
) -> xr.Dataset:
    velocity, usable, begin_s = used(cut, band_Hz)
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
