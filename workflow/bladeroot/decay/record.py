"""One raw record to all its artifacts: read, as a person overrules it, with a second opinion."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from bladeroot.decay.cut import rejected
from bladeroot.decay.estimate import estimate
from bladeroot.decay.overrides import kept, windowed, with_override
from bladeroot.decay.ringdown import ringdown, with_curves
from bladeroot.io.overrides import overruled
from bladeroot.io.read import read
from bladeroot.io.recording import part
from bladeroot.quality.integrity import judge
from bladeroot.signal.recording import Recording

# What the sheet says of a raw file; the file may contradict it.
SAID = ("quantity", "unit", "channel", "sampling_Hz", "sensitivity", "response", "mode", "force_N")


def from_file(
    raw: str | Path, known: Mapping, cutting: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Free decay, curves over amplitude and plateau of a record in a file.

    Args:
        raw: its file.
        known: what the sheet says of it: SAID, what `decay.ringdown.ringdown` takes, and what a
            person overrules (`start_s`, `end_s`, `keep`, `band_Hz`).
        cutting: section `record` of the configuration, as of `bladeroot.decay.cut.cut`.
        estimation: section `decay`, as of `bladeroot.decay.estimate.estimate`.

    A record that cannot be read or used comes back without points, rejected with a reason.
    """
    try:
        recording = recorded(raw, known)
    except ValueError as error:
        return not_analysed(known, str(error), estimation)
    return analyse(recording, known, cutting, estimation)


def recorded(raw: str | Path, known: Mapping) -> Recording:
    """The recording of a record in a file, in SI units. ValueError, one line: it has none."""
    whole = read(raw, **{name: known.get(name) for name in SAID})
    return part(whole, known.get("from_s"), known.get("to_s"), str(raw))


def analyse(
    recording: Recording, known: Mapping, cutting: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """The same of a recording in SI units, for which `known` need not hold SAID."""
    window = partial(windowed, start_s=known.get("start_s"), end_s=known.get("end_s"))
    overrule = partial(_overruled, known=known)
    estimating = _estimating(known, estimation)
    return ringdown(recording, known, {**cutting, "window": window}, estimating, overrule)


def not_analysed(
    known: Mapping, reason: str, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """The same for a record that has no recording: rejected for that reason."""
    decay = judge(rejected(reason), np.zeros(0), known["expected_Hz"])
    return with_curves(_overruled(decay, known), known, _estimating(known, estimation))


def _overruled(decay: xr.Dataset, known: Mapping) -> xr.Dataset:
    """A judged decay as a person leaves it, with that among its findings."""
    return with_override(kept(decay) if known.get("keep") else decay, overruled(known))


def _estimating(known: Mapping, estimation: Mapping) -> partial:
    return partial(estimate, **estimation, band_Hz=known.get("band_Hz"))
