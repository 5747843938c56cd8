"""A raw file to all that is kept of one record: read, analysed, with a second opinion."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from bladeroot.decay.cut import rejected
from bladeroot.decay.overrides import banded
from bladeroot.decay.record import analyse, estimated, override_remark
from bladeroot.io.read import read
from bladeroot.io.recording import part
from bladeroot.quality.integrity import judge
from bladeroot.quality.second_opinion import with_second_opinion
from bladeroot.signal.recording import Recording

# What the sheet says of a raw file; the file may contradict it.
SAID = ("quantity", "unit", "channel", "sampling_Hz", "sensitivity", "response", "mode", "force_N")


def from_file(
    raw: str | Path, known: Mapping, cutting: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Free decay, curves over amplitude and plateau of a record in a file.

    Args:
        raw: its file.
        known: what the sheet says of it: SAID, and as of `bladeroot.decay.record.analyse`.
        cutting, estimation: as of `analyse`.

    A record that cannot be read or used comes back without points, rejected with a reason.
    """
    try:
        recording = recorded(raw, known)
    except ValueError as error:
        return not_analysed(known, str(error), estimation)
    return of_recording(recording, known, cutting, estimation)


def recorded(raw: str | Path, known: Mapping) -> Recording:
    """The recording of a record in a file, in SI units. ValueError, one line: it has none."""
    whole = read(raw, **{name: known.get(name) for name in SAID})
    return part(whole, known.get("from_s"), known.get("to_s"), str(raw))


def of_recording(
    recording: Recording, known: Mapping, cutting: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Free decay, curves and plateau of a recording in SI units; `known` need not hold SAID."""
    return _with_opinion(*analyse(recording, known, cutting, estimation), known)


def not_analysed(
    known: Mapping, reason: str, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Free decay, curves and plateau of a record without a recording: rejected, without points."""
    nothing = rejected(reason)
    decay = judge(nothing, np.zeros(0), known["expected_Hz"], remarks=override_remark(known))
    return _with_opinion(*estimated(decay, known, estimation), known)


def _with_opinion(
    decay: xr.Dataset, curves: xr.Dataset, plateau: xr.Dataset, known: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    band_Hz = known.get("band_Hz")
    looked_at = decay if band_Hz is None else banded(decay, band_Hz)
    return decay, with_second_opinion(curves, looked_at), plateau
