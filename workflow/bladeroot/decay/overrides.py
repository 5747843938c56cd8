"""What a person overrules is done: where the decay begins and ends, its band, that it is kept."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.decay.cut import AMBIENT, cut_out
from bladeroot.decay.release import BEGUN

# The filter of a band: Kaiser's window of this shape and half length, in inverse widths of what
# lies between the band and what is taken off. The gain in the band is then one within 3e-4; longer
# loses more of the decay's ends.
SHAPE = 6.76
REACH = 2.2


def shortened(
    decay: xr.Dataset,
    whole: Float[ndarray, " whole"],
    start_s: float | None,
    end_s: float | None,
) -> xr.Dataset:
    """A cut with the start and the end (s in the raw record) that a person gives.

    decay: from `bladeroot.decay.cut.cut`; a side that is not given stays, or is the record's own
    where nothing was found or the other side lies beyond it. whole: the record it was cut from,
    m/s. What the cut found amiss is then a person's to judge, unless nothing is left.
    """
    rate = float(decay.attrs["sampling_Hz"])
    if start_s is None and end_s is None:
        return decay
    begin, finish = 0.0, (whole.size - 1) / rate
    if decay.sizes["time"]:
        found = decay.attrs["start_s"], decay.attrs["end_s"]
        begin = found[0] if end_s is None or found[0] < end_s else begin
        finish = found[1] if start_s is None or start_s < found[1] else finish
    begin = begin if start_s is None else start_s
    finish = finish if end_s is None else end_s
    first = int(np.clip(np.ceil(begin * rate), 0, whole.size))
    stop = int(np.clip(np.floor(finish * rate) + 1, first, whole.size))
    piece = whole[first:stop]
    finding = "" if piece.any() else f"nothing between start_s {begin:g} and end_s {finish:g}"
    facts = {"start_s": first / rate, "end_s": max(stop - 1, first) / rate,
             "end_reason": decay.attrs["end_reason"] if end_s is None else "end_s",
             "verdict": "rejected" if finding else "usable", "findings": finding}  # fmt: skip
    if start_s is not None:
        facts |= {"release_s": first / rate, "release_std_s": 0.0}
    if decay.attrs["excitation"] in ("", AMBIENT):
        facts["excitation"] = BEGUN
    return cut_out(whole, rate, (first, stop), decay.attrs | facts)


def kept(judged: xr.Dataset) -> xr.Dataset:
    """A judged record whose findings warn and no longer drop; without samples there is nothing."""
    if judged.attrs["verdict"] == "usable" or not judged.sizes["time"]:
        return judged
    consequence = judged["finding_consequence"]
    warn = xr.where(consequence == "drop", "warn", consequence).astype(str)
    return judged.assign(finding_consequence=warn.assign_attrs(consequence.attrs)).assign_attrs(
        verdict="usable", reason=""
    )


def banded(cut: xr.Dataset, band_Hz: Sequence[float]) -> xr.Dataset:
    """A judged cut without what lies outside a person's band; rejected where that cannot be.

    The samples at its ends that the filter does not reach lose their weight.
    """
    if cut.attrs["verdict"] != "usable":
        return cut
    velocity, rate = cut["velocity"].values.astype(float), cut.attrs["sampling_Hz"]
    try:
        velocity, lost = in_band(velocity, rate, band_Hz, cut.attrs["expected_Hz"])
    except ValueError as error:
        return cut.assign_attrs(verdict="rejected", reason=str(error))
    usable = cut["usable"].values.copy()
    usable[:lost] = usable[usable.size - lost :] = 0
    made = {"velocity": velocity, "usable": usable}
    return cut.assign({name: cut[name].copy(data=values) for name, values in made.items()})


def in_band(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    band_Hz: Sequence[float],
    own_Hz: float,
) -> tuple[Float[ndarray, " sample"], int]:
    """The decay without what lies outside the band, and how many samples at each end are not it.

    A symmetric filter, so that no phase is turned. Its gain is one all over the band, in which the
    mode's frequency moves, and nothing half the band's width outside, or at 0 Hz.

    Raises:
        ValueError: the mode is not in the band, the band is not between 0 Hz and half the sampling
            frequency, or the decay is too short for it.
    """
    from scipy.signal import fftconvolve  # late: few records have a band

    low, high = band_Hz
    if not low < own_Hz < high:
        raise ValueError(f"band_Hz must hold the mode's {own_Hz:g} Hz, got {low:g} to {high:g}")
    if low <= 0.0:
        raise ValueError(f"band_Hz must begin above 0 Hz, got {low:g} to {high:g}")
    if fault := beyond_samples(band_Hz, sampling_Hz):
        raise ValueError(fault)
    beside = min(0.5 * (high - low), low)
    reach = int(np.ceil(REACH / beside * sampling_Hz))
    if 2 * reach >= velocity.size:
        least_s = 2 * reach / sampling_Hz
        raise ValueError(f"a band of {low:g} to {high:g} Hz needs a decay of over {least_s:.3g} s")
    time = np.arange(-reach, reach + 1) / sampling_Hz
    edges = low - 0.5 * beside, min(high + 0.5 * beside, 0.5 * sampling_Hz)
    below, above = (2.0 * edge * np.sinc(2.0 * edge * time) for edge in edges)
    taps = (above - below) * np.kaiser(time.size, SHAPE)
    taps /= taps @ np.cos(2.0 * np.pi * own_Hz * time)
    return fftconvolve(velocity, taps, mode="same"), reach


def beyond_samples(band_Hz: Sequence[float], sampling_Hz: float) -> str:
    """Why a band asks for more than the samples hold; empty if it does not."""
    if band_Hz[1] < 0.5 * sampling_Hz:
        return ""
    return (
        f"band_Hz must end below half the sampling frequency {sampling_Hz:g} Hz, got {band_Hz[1]:g}"
    )


def within(curves: xr.Dataset, band_Hz: Sequence[float]) -> xr.Dataset:
    """Curves where the mode lies in a person's band: outside, the filter changes it.

    ValueError where it does in no point.
    """
    low, high = band_Hz
    inside = np.flatnonzero((curves["frequency"] > low) & (curves["frequency"] < high))
    if not inside.size:
        raise ValueError(f"the mode lies outside band_Hz, {low:g} to {high:g} Hz, all along")
    first, last = curves["time"].values[inside[[0, -1]]]
    block = curves["block_time"].values
    blocks = np.flatnonzero((block >= first) & (block <= last))
    return curves.isel(point=inside, block=blocks)
