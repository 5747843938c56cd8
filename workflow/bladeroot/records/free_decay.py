"""From a recording to the judged free decay of one mode."""

import xarray as xr

from bladeroot.records.components import onset, separated
from bladeroot.records.cut import cut
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
    decay = cut(clear, rate, expected_Hz, end)
    struck = onset(clear)
    if expected_Hz >= 0.45 * rate or (not struck and decay.attrs["verdict"] != "usable"):
        return judge(decay, motion, expected_Hz, modes_Hz, recording.notes, recording)
    let_go = decay.attrs["excitation"] == "shaker"
    first = round(decay.attrs["start_s"] * rate) if let_go else struck
    parts = separated(clear, rate, expected_Hz, first)
    if not parts.lines_Hz and parts.velocity is clear:
        return judge(decay, motion, expected_Hz, modes_Hz, recording.notes, recording)
    how = decay.attrs["excitation"] or "hammer"
    if first and how == "begins in the decay":
        how = "hammer"
    release = Release(parts.first / rate, 0.0, how)
    decay = cut(parts.velocity, rate, expected_Hz, end, release=release)
    return judge(decay, motion, expected_Hz, modes_Hz, recording.notes, recording, parts.velocity)
