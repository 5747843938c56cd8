"""All that is estimated of one free decay: the curves, the second opinion, the source's bounds."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.decay.agreement import compare
from bladeroot.decay.band import in_band
from bladeroot.decay.error_bounds import published
from bladeroot.decay.freevib import freevib, no_decay
from bladeroot.decay.pff import no_peaks, peak_fit
from bladeroot.decay.thesis_filters import thesis_freevib

ESTIMATORS = {"blocks": freevib, "thesis": thesis_freevib}


def estimate(
    cut: xr.Dataset,
    estimator: str = "blocks",
    damping: str = "hysteretic",
    band_Hz: Sequence[float] | None = None,
) -> xr.Dataset:
    """Curves of a record with its peaks beside them and their differences.

    Args:
        cut: free decay as from `decay.cut.cut`, with `expected_Hz` in its attributes.
        estimator: "blocks" (`freevib`) or "thesis" (`thesis_freevib`).
        damping: law of damping, "hysteretic" or "viscous".
        band_Hz: a person's band, outside which nothing counts.

    Returns:
        Variables of `freevib`, `peak_fit` and `compare`, and the bounds of Appendix F; attributes
        of `cut`. A rejected record, or one that cannot be estimated, has no points.
    """
    if estimator not in ESTIMATORS:
        raise ValueError(f"estimator must be {' or '.join(ESTIMATORS)}, got {estimator!r}")
    facts = dict(cut.attrs)
    curves, peaks = no_decay(), no_peaks()
    if facts["verdict"] == "usable":
        velocity, usable = cut["velocity"].values.astype(float), cut["usable"].values.astype(bool)
        if band_Hz is not None:
            try:
                velocity, lost = in_band(
                    velocity, facts["sampling_Hz"], band_Hz, facts["expected_Hz"]
                )
            except ValueError as error:
                rejected = cut.assign_attrs(verdict="rejected", reason=str(error))
                return estimate(rejected, estimator, damping)
            usable = usable.copy()
            usable[:lost] = usable[velocity.size - lost :] = False
        first = int(np.argmax(usable))  # a start that is masked is no part of the decay
        begin_s = first / facts["sampling_Hz"]
        record = (
            velocity[first:],
            facts["sampling_Hz"],
            facts["expected_Hz"],
            facts["noise_velocity"],
        )
        options = {"damping": damping, "usable": usable[first:]}
        ours = dict(options)
        if estimator == "blocks" and "widening" in cut:
            time = cut["widening_time"].values - begin_s
            ours["taken"] = (time, cut["widening"].values, cut["doubt"].values)
        try:
            curves = _later(ESTIMATORS[estimator](*record, **ours), begin_s)
            if "taken" in ours:
                curves.attrs["other_modes_Hz"] = np.atleast_1d(facts["components_Hz"]).tolist()
            peaks = _later(peak_fit(*record, **options), begin_s)
        except ValueError as error:
            facts |= {"verdict": "rejected", "reason": str(error)}
    bounds = _published_bounds(curves, facts["noise_velocity"])
    whole = curves.assign(
        {**peaks.variables, **compare(curves, peaks).variables, **bounds.variables}
    )
    return whole.assign_attrs({**facts, "estimator": estimator, "damping": damping})


def _later(curves: xr.Dataset, seconds: float) -> xr.Dataset:
    """Curves whose times count from the start of the cut, which lies some seconds before theirs."""
    times = [name for name in ("time", "block_time", "pff_time") if name in curves]
    moved = {name: (curves[name] + seconds).assign_attrs(curves[name].attrs) for name in times}
    return curves.assign(moved)


def _published_bounds(curves: xr.Dataset, noise: float) -> xr.Dataset:
    """Scalars `frequency_bound_thesis` and `loss_factor_bound_thesis` of the whole decay."""
    frequency = loss = np.nan
    if curves.sizes["point"] > 1:
        middle_Hz = float(curves["frequency"].median())
        duration = float(curves["time"][-1] - curves["time"][0])
        ratio = noise / (2.0 * np.pi * middle_Hz * float(curves["amplitude"][0]))
        bound = published(
            middle_Hz, float(curves["loss_factor"].median()), ratio, middle_Hz * duration
        )
        frequency, loss = bound.frequency, bound.loss_factor
    text = "error bound of {} as Appendix F prints it, over the whole decay"
    return xr.Dataset(
        {
            "frequency_bound_thesis": (
                (), frequency,
                {"units": "Hz", "long_name": text.format("frequency"), "source": "App. F"},
            ),
            "loss_factor_bound_thesis": (
                (), loss,
                {"units": "1", "long_name": text.format("loss factor"), "source": "App. F"},
            ),
        }
    )  # fmt: skip
