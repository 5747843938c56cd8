"""From a recording to the judged free decay of one mode."""

import numpy as np
import xarray as xr

from bladeroot.records.components import Separated, onset, separated
from bladeroot.records.cut import coarse, cut
from bladeroot.records.integrity import bridged, judge
from bladeroot.records.recording import Recording, velocity
from bladeroot.records.release import Release


def free_decay(
    recording: Recording,
    expected_Hz: float,
    modes_Hz: tuple[float, ...] = (),
    end: float | str = "noise",
) -> xr.Dataset:
    """The free decay of one mode, cut, without what else rings, with its findings and its mask.

    Arguments as of `records.cut.cut` and `records.integrity.judge`.
    """
    motion = velocity(recording, expected_Hz)
    rate = recording.sampling_Hz
    clear = bridged(motion, rate, expected_Hz)
    steps = _steps(recording, expected_Hz)
    decay = cut(clear, rate, expected_Hz, end, least=steps)
    struck = onset(clear, rate / expected_Hz)
    if expected_Hz >= 0.45 * rate or clear.size * expected_Hz < 16 * rate:
        return judge(decay, motion, expected_Hz, modes_Hz, recording.notes, recording)
    let_go = decay.attrs["excitation"] == "shaker"
    first = round(decay.attrs["start_s"] * rate) if let_go else struck
    parts = separated(clear, rate, expected_Hz, modes_Hz, first)
    if not parts.lines_Hz and parts.velocity is clear:
        return judge(decay, motion, expected_Hz, modes_Hz, recording.notes, recording)
    how = decay.attrs["excitation"] or "hammer"
    if first and how == "begins in the decay":
        how = "hammer"
    release = Release(parts.first / rate, 0.0, how)
    decay = cut(parts.velocity, rate, expected_Hz, end, release=release, least=steps)
    judged = judge(decay, motion, expected_Hz, modes_Hz, recording.notes, recording, parts.velocity)
    return _with_widening(judged, parts)


def _steps(recording: Recording, expected_Hz: float) -> float:
    """Velocity (m/s) of the mode that is but some steps of the sensor's digitiser high."""
    least = coarse(recording.samples)
    if recording.quantity == "acceleration":
        return least / (2.0 * np.pi * expected_Hz)
    return least * (2.0 * np.pi * expected_Hz if recording.quantity == "displacement" else 1.0)


def _with_widening(decay: xr.Dataset, parts: Separated) -> xr.Dataset:
    """The decay, with what its mode is less sure by for the components taken off."""
    if not np.isfinite(decay.attrs["start_s"]):
        return decay
    about = {"units": "1", "long_name": "standard error beside other components over that without"}
    when = {"units": "s", "long_name": "time since the start of the cut"}
    return decay.assign(
        widening=("knot", parts.widening, about),
        doubt=("knot", parts.doubt, about | {"long_name": "relative error by the others' course"}),
        widening_time=("knot", parts.time - decay.attrs["start_s"], when),
    ).assign_attrs(components_Hz=parts.lines_Hz)
