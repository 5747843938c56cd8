"""One raw record to its free decay, its curves over amplitude and its stick plateau."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from bladeroot.decay.cut import rejected
from bladeroot.decay.estimate import estimate
from bladeroot.decay.free_decay import free_decay
from bladeroot.decay.overrides import kept, with_override
from bladeroot.io.overrides import overruled
from bladeroot.io.read import read
from bladeroot.io.recording import Recording, part
from bladeroot.plateau.record import record_plateau
from bladeroot.quality.integrity import judge

# What the sheet says of a raw file; the file may contradict it.
SAID = ("quantity", "unit", "channel", "sampling_Hz", "sensitivity", "response", "mode", "force_N")
# What the sheet says of a record, for all who read its artifacts; what it does not is left out.
FACTS = ("record", "mode", "expected_Hz", "load", "load_name", "load_unit", "force_N", "hold",
         "direction", "event", "group", "sensor", "band_Hz")  # fmt: skip


def ringdown(
    raw: str | Path, known: Mapping, cutting: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Free decay, curves over amplitude and plateau of a record in a file.

    Args:
        raw: its file.
        known: what the sheet says of it (SAID and FACTS), with `other_modes_Hz`, the expected
            frequencies of the campaign's other modes, `simulated`, and what a person overrules
            (`bladeroot.io.overrides`).
        cutting: section `record` of the configuration, as of `bladeroot.decay.cut.cut`.
        estimation: section `decay`, as of `bladeroot.decay.estimate.estimate`.

    A record that cannot be read or used comes back without points, rejected with a reason.
    """
    try:
        recording = read(raw, **{name: known.get(name) for name in SAID})
        recording = part(recording, known.get("from_s"), known.get("to_s"), str(raw))
    except ValueError as error:
        return not_analysed(known, str(error), estimation)
    return analyse(recording, known, cutting, estimation)


def analyse(
    recording: Recording, known: Mapping, cutting: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """The same of a recording in SI units, for which `known` need not hold SAID."""
    others = tuple(known["other_modes_Hz"])
    window = known.get("start_s"), known.get("end_s")
    decay = free_decay(recording, float(known["expected_Hz"]), others, **cutting, window=window)
    decay = kept(decay) if known.get("keep") else decay
    return _with_curves(decay.assign_attrs(quantity=recording.quantity), known, estimation)


def not_analysed(
    known: Mapping, reason: str, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """The same for a record that has no recording: rejected for that reason."""
    decay = judge(rejected(reason), np.zeros(0), known["expected_Hz"])
    return _with_curves(decay, known, estimation)


def _with_curves(
    decay: xr.Dataset, known: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    decay = with_override(decay, overruled(known))
    decay.attrs |= {name: known[name] for name in FACTS if known.get(name) is not None}
    decay.attrs["expected_Hz"] = float(known["expected_Hz"])  # a sheet may say 540
    decay.attrs["simulated"] = int(known["simulated"])
    curves = estimate(decay, **estimation, band_Hz=known.get("band_Hz"))
    return decay, curves, record_plateau(curves)
