"""One ring-down, from a file or an array to its curves over amplitude and its stick frequency."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from jaxtyping import Real
from numpy import ndarray

from bladeroot.decay.cut import decay_starts, too_fast_or_short
from bladeroot.decay.from_file import of_recording as analysed
from bladeroot.decay.from_file import recorded
from bladeroot.decay.overrides import beyond_samples
from bladeroot.io.campaign import Campaign
from bladeroot.io.channel import RATE_TOLERANCE
from bladeroot.io.expected import expected_at
from bladeroot.io.overrides import overruled
from bladeroot.io.read import read
from bladeroot.io.recording import part, recording
from bladeroot.io.units import same, seconds
from bladeroot.signal.recording import SI, Recording, uncut, velocity
from bladeroot.terms import length

Source = (
    str | Path | xr.DataArray | pd.Series | Real[ndarray, " sample"] | Real[ndarray, "sample 1"]
)


@dataclass(frozen=True)
class Ringdown:
    """What one record says of one mode.

    free_decay: the cut-out decay (`velocity` in m/s) with its findings. curves: `amplitude` (m),
    `frequency` (Hz), `loss_factor` (1) and their `_std` along `point`, with what they were made of
    along `block` and `peak`: `curves.drop_dims(["block", "peak"]).to_dataframe()` is a table of the
    points. plateau: stick frequency,
    loss factor and onset of slip, NaN where the record does not reach its plateau.
    """

    free_decay: xr.Dataset
    curves: xr.Dataset
    plateau: xr.Dataset

    @property
    def verdict(self) -> str:
        """Usable, or why the record is rejected."""
        attrs = self.curves.attrs
        return attrs["verdict"] if attrs["verdict"] == "usable" else f"rejected: {attrs['reason']}"

    @property
    def stick_frequency(self) -> tuple[float, float]:
        """Frequency of the stick plateau and its standard error, Hz; NaN without a plateau."""
        return tuple(
            float(self.plateau[name]) for name in ("stick_frequency", "stick_frequency_std")
        )

    @property
    def findings(self) -> tuple[str, ...]:
        """What was found wrong in the record, a line each."""
        return tuple(dict.fromkeys(map(str, self.free_decay["finding_text"].values)))

    def plot(self):
        """Frequency and loss factor over amplitude with their standard errors.

        Returns:
            a Figure, none of pyplot's: `decay.plot().savefig("a.png")` saves it.

        Raises:
            ValueError: there are no curves.
        """
        from bladeroot.figures.curves import records
        from bladeroot.figures.still import still

        drawn = records([self.curves])
        if drawn is None:
            raise ValueError(f"there are no curves to plot: {self.verdict}")
        return still(drawn)

    def __repr__(self) -> str:
        """A short table."""
        lines = [f"ring-down of the mode near {self.curves.attrs['expected_Hz']:.5g} Hz"]
        lines.append(f"  {self.verdict}")
        if self.curves.sizes["point"]:
            ends = self.curves.isel(point=[0, -1])
            lines += [
                f"  amplitude       {' to '.join(map(length, ends['amplitude'].values))}",
                "  frequency       {:.5g} to {:.5g} Hz".format(*ends["frequency"].values),
                "  loss factor     {:.3g} to {:.3g} %".format(*100.0 * ends["loss_factor"].values),
                "  decay           {start_s:.4g} to {end_s:.4g} s, its end: {end_reason}".format(
                    **self.free_decay.attrs
                ),
            ]
        value, std = self.stick_frequency
        if np.isfinite(value):
            digits = max(0, 1 - int(np.floor(np.log10(std)))) if std > 0.0 else 3
            lines.append(f"  stick frequency {value:.{digits}f} ± {std:.{digits}f} Hz")
        else:
            told = str(self.plateau["verdict"].item()).removeprefix("plateau ")
            lines.append(f"  plateau         {told}")
        return "\n".join([*lines, *(f"  finding: {line}" for line in self.findings)])


def ringdown(
    source: Source,
    mode_Hz: float,
    *,
    sampling_Hz: float | None = None,
    quantity: str | None = None,
    unit: str | None = None,
    sensitivity: str | float | None = None,
    channel: str | int | None = None,
    other_modes_Hz: Sequence[float] = (),
    damping: str = "hysteretic",
    from_s: float | None = None,
    to_s: float | None = None,
    start_s: float | None = None,
    end_s: float | None = None,
    band_Hz: tuple[float, float] | None = None,
) -> Ringdown:
    """Frequency and damping over amplitude of one mode of a ring-down.

    Args:
        source: a file of any format that the workflow reads; an array of one channel, with
            `sampling_Hz`; a DataArray with a coordinate `time` (s, unless its `units` say
            otherwise) and `units` in its attrs; or a Series over time.
        mode_Hz: about where the mode lies; the strongest line within 17 % is measured.
        sampling_Hz: for arrays, and for files that do not say.
        quantity: velocity (of an array without a unit), displacement or acceleration.
        unit: of the samples, such as `mm/s`; by default what the file says, of an array SI.
        sensitivity: of the sensor, such as `500 mm/s/FS` or `100 mV/g`; or, of samples that have
            a unit, a factor.
        channel: of a file that has several, its name or number.
        other_modes_Hz: other modes that are known to be there.
        damping: law, `hysteretic` or `viscous`.
        from_s, to_s: part of the source that is looked at, s after its first sample.
        start_s, end_s: where the decay begins and ends, s after that part's first sample; by
            default where it is found to.
        band_Hz: nothing but this band of the decay is used.

    Raises:
        ValueError: what cannot be read, in one line. A record that is read and cannot be used
            comes back without points; `verdict` says why.

    >>> import numpy as np, bladeroot as br
    >>> t = np.arange(40_000) / 10_000
    >>> v = 0.01 * np.exp(-5.0 * t) * np.cos(2 * np.pi * 200.0 * t)
    >>> v += 1e-6 * np.random.default_rng(0).standard_normal(t.size)
    >>> decay = br.ringdown(v, mode_Hz=200.0, sampling_Hz=10_000.0)
    >>> round(decay.stick_frequency[0], 2)
    200.0
    """
    mode_Hz = _hertz("mode_Hz", mode_Hz)
    other_modes_Hz = [_hertz("other_modes_Hz", one) for one in np.atleast_1d(other_modes_Hz)]
    sampling_Hz = None if sampling_Hz is None else _hertz("sampling_Hz", sampling_Hz)
    if quantity is not None and quantity not in SI:
        raise ValueError(f"quantity must be one of {', '.join(SI)}, got {quantity!r}")
    if damping not in ("hysteretic", "viscous"):
        raise ValueError(f"damping must be hysteretic or viscous, got {damping!r}")
    from_s, to_s = _ends("from_s and to_s", (from_s, to_s))
    start_s, end_s = _ends("start_s and end_s", (start_s, end_s))
    band_Hz = None if band_Hz is None else _ends("band_Hz", band_Hz, both=True)
    # a number of a channel, a factor
    channel, sensitivity, unit = (
        None if one is None else str(one) for one in (channel, sensitivity, unit)
    )
    taken = _recording(source, sampling_Hz, quantity, unit, sensitivity, channel)
    name = Path(source).stem if isinstance(source, str | Path) else "array"
    taken = part(taken, from_s, to_s, name)
    overrides = {"start_s": start_s, "end_s": end_s, "band_Hz": band_Hz, "note": "by the caller"}
    return of_recording(taken, mode_Hz, name, other_modes_Hz, damping, overrides)


def of_recording(
    taken: Recording,
    mode_Hz: float,
    name: str,
    other_modes_Hz: Sequence[float] = (),
    damping: str = "hysteretic",
    overrides: Mapping[str, object] | None = None,
) -> Ringdown:
    """The same of a recording that is already read; overrides: start_s, end_s, band_Hz."""
    known = {
        "record": name,
        "mode": f"{mode_Hz:g} Hz",
        "expected_Hz": float(mode_Hz),
        "other_modes_Hz": tuple(other_modes_Hz),
        "force_N": float("nan"),
        "hold": name,
        "direction": "",
        "simulated": False,
        **(overrides or {}),
        "overruled": overruled(overrides or {}),
    }
    return Ringdown(*analysed(taken, known, {}, {"damping": damping}))


def _hertz(name: str, value: object) -> float:
    """A frequency that a caller gives."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = np.nan
    if not (np.isfinite(number) and number > 0.0):
        raise ValueError(f"{name} must be positive, in Hz, got {value!r}")
    return number


def _ends(name: str, given: object, both: bool = False) -> tuple[float | None, float | None]:
    """Where a part, decay or band that a caller gives begins and ends; None where it is open."""
    try:
        first, last = (None if one is None else float(one) for one in given)
    except (TypeError, ValueError):
        first = last = np.nan
    if not all(not both if one is None else np.isfinite(one) for one in (first, last)):
        raise ValueError(f"{name} must be two numbers, got {given!r}")
    if any(one is not None and one < 0.0 for one in (first, last)):
        raise ValueError(f"{name} must not be negative, got {given!r}")
    if None not in (first, last) and not first < last:
        raise ValueError(f"{name} must be in order, got {first:g} to {last:g}")
    return first, last


def starts(taken: Recording, mode_Hz: float) -> list[float]:
    """When each decay of a mode in a recording begins, s after its first sample."""
    motion = velocity(uncut(taken, mode_Hz), mode_Hz)
    return decay_starts(motion, taken.sampling_Hz, mode_Hz)


def faults_of_files(campaign: Campaign) -> list[str]:
    """Why raw files of a campaign cannot be read as its sheet says, or are too short for their mode
    or for what the sheet overrules: a line a record.
    """
    faults = []
    for known in campaign.records:
        mode = campaign.description["modes"][known["mode"]]
        expected_Hz = expected_at(mode, campaign.load, known["load"])
        path = campaign.folder / known["file"]
        try:
            found = recorded(path, known)
            fault = too_fast_or_short(found.samples.size, found.sampling_Hz, expected_Hz)
            fault = fault or _overruled(found, known["start_s"], known["band_Hz"])
            fault = fault and f"{fault} ({path})"
        except ValueError as error:
            fault = str(error)
        faults += [f"{known['record']}: {fault}"] if fault else []
    return faults


def _overruled(found: Recording, start_s: float | None, band_Hz: list[float] | None) -> str:
    """What a person's start or band asks of a recording that it does not have; empty if nothing."""
    length_s = found.samples.size / found.sampling_Hz
    if start_s is not None and start_s >= length_s:
        return f"start_s must lie within the record's {length_s:g} s, got {start_s:g}"
    return beyond_samples(band_Hz, found.sampling_Hz) if band_Hz else ""


def _recording(
    source: Source,
    sampling_Hz: float | None,
    quantity: str | None,
    unit: str | None,
    sensitivity: str | None,
    channel: str | None,
) -> Recording:
    if isinstance(source, str | Path):
        return read(source, quantity, unit, channel, sampling_Hz, sensitivity)
    if isinstance(source, pd.Series) and not isinstance(source.index, pd.RangeIndex):
        source = xr.DataArray(source.to_numpy(), {"time": source.index.to_numpy()}, "time")
    samples, time, where = source, None, "the given array"
    if isinstance(source, xr.DataArray):
        own = source.attrs.get("units")
        if own and unit and not same(own, unit):
            raise ValueError(f"unit contradicts: {unit!r} stated, {own!r} in the DataArray")
        unit = unit or own
        if "time" in source.coords:
            time = source["time"].values
            if time.dtype.kind in "mM":  # dates, or times since one
                time = (time - time[:1]) / np.timedelta64(1, "s")
            elif stated := str(source["time"].attrs.get("units", "")).split(" since ")[0]:
                if (factor := seconds(stated)) is None:
                    raise ValueError(f"the DataArray's time is in {stated!r}, expected s, ms or us")
                time = factor * time
        elif sampling_Hz is None:
            raise ValueError("expected a coordinate `time` in the DataArray, or sampling_Hz")
    elif sampling_Hz is None:
        raise ValueError("an array of samples needs sampling_Hz")
    if isinstance(samples, np.ma.MaskedArray):
        samples = samples.astype(float).filled(np.nan)
    samples = np.asarray(samples)
    if samples.ndim == 2 and 1 in samples.shape:
        samples = samples.ravel()
    if unit is None and sensitivity is not None and not _is_number(sensitivity):
        raise ValueError(f"a sensitivity of {sensitivity!r} needs the samples' unit, such as 'V'")
    if unit == "FS" and samples.dtype.kind in "iu":
        raise ValueError(
            "whole numbers have no full scale; expected parts of it (16-bit samples over 32768), "
            "or unit='count'"
        )
    unit = unit or SI[quantity or "velocity"]
    taken = recording(samples, unit, where, time, sampling_Hz, quantity, sensitivity)
    if time is not None and sampling_Hz is not None:
        apart = abs(taken.sampling_Hz / sampling_Hz - 1.0)
        if not apart <= RATE_TOLERANCE:
            raise ValueError(
                f"sampling_Hz contradicts: {sampling_Hz:.9g} stated, {taken.sampling_Hz:.9g} by "
                "the DataArray's time"
            )
    return taken


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
