"""All that is estimated of one free decay: the curves, the second opinion, the source's bounds."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.decay.agreement import compare
from bladeroot.decay.curves import curves, later, used
from bladeroot.decay.error_bounds import published
from bladeroot.decay.freevib import freevib
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
        cut, damping, band_Hz: as of `decay.curves.curves`.
        estimator: "blocks" (`freevib`) or "thesis" (`thesis_freevib`).

    Returns:
        Variables of `freevib`, `peak_fit` and `compare`, and the bounds of Appendix F; attributes
        of `cut`. A rejected record, or one that cannot be estimated, has no points.
    """
    if estimator not in ESTIMATORS:
        raise ValueError(f"estimator must be {' or '.join(ESTIMATORS)}, got {estimator!r}")
    made = curves(cut, damping, band_Hz, ESTIMATORS[estimator])
    facts, peaks = made.attrs, no_peaks()
    if facts["verdict"] == "usable":
        velocity, usable, begin_s = used(cut, band_Hz)
        known = (facts[name] for name in ("sampling_Hz", "expected_Hz", "noise_velocity"))
        peaks = later(peak_fit(velocity, *known, usable=usable, damping=damping), begin_s)
    bounds = _published_bounds(made, facts["noise_velocity"])
    whole = made.assign({**peaks.variables, **compare(made, peaks).variables, **bounds.variables})
    return whole.assign_attrs(estimator=estimator)


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
