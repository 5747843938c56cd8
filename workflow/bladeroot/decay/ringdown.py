"""A recording to its free decay, its curves over amplitude and its stick plateau."""

from collections.abc import Callable, Mapping

import xarray as xr

from bladeroot.decay.curves import curves
from bladeroot.decay.free_decay import free_decay
from bladeroot.plateau.plateau import record_plateau
from bladeroot.signal.recording import Recording

# What the sheet says of a record, for all who read its artifacts; what it does not is left out.
FACTS = ("record", "mode", "expected_Hz", "load", "load_name", "load_unit", "force_N", "hold",
         "direction", "event", "group", "sensor", "band_Hz")  # fmt: skip


def ringdown(
    recording: Recording,
    known: Mapping,
    cutting: Mapping,
    estimate: Callable[[xr.Dataset], xr.Dataset] = curves,
    overrule: Callable[[xr.Dataset], xr.Dataset] = lambda judged: judged,
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Free decay, curves over amplitude and plateau of one mode.

    Args:
        recording: of one sensor, in SI units.
        known: FACTS; `other_modes_Hz`, the expected frequencies of the campaign's other modes;
            `simulated`.
        cutting: `end` and `window`, as of `bladeroot.decay.free_decay.free_decay`.
        estimate: makes curves of a judged free decay.
        overrule: what a person changes of a judged free decay.
    """
    others = tuple(known["other_modes_Hz"])
    decay = free_decay(recording, float(known["expected_Hz"]), others, **cutting)
    decay = overrule(decay.assign_attrs(quantity=recording.quantity))
    return with_curves(decay, known, estimate)


def with_curves(
    decay: xr.Dataset, known: Mapping, estimate: Callable[[xr.Dataset], xr.Dataset] = curves
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """A judged free decay with what is known of it, its curves and its plateau."""
    decay.attrs |= {name: known[name] for name in FACTS if known.get(name) is not None}
    decay.attrs["expected_Hz"] = float(known["expected_Hz"])  # a sheet may say 540
    decay.attrs["simulated"] = int(known["simulated"])
    made = estimate(decay)
    return decay, made, record_plateau(made)
