"""Decays judged as the ring-down stage judges them, and what is said of them."""

import xarray as xr
from bladeroot.decay.cut import cut
from bladeroot.quality.integrity import bridged, judge
from bladeroot.signal.lines import white_noise
from decay_bench import RATE, ring_down


def judged(velocity, expected_Hz=250.0, sampling_Hz=RATE, **more):
    decay = cut(bridged(velocity, sampling_Hz, expected_Hz), sampling_Hz, expected_Hz)
    return judge(decay, velocity, expected_Hz, **more)


def uncut(velocity, end_reason="end of the record", **more):
    """Judgement of a record that is a decay from end to end."""
    attrs = {
        "sampling_Hz": RATE, "start_s": 0.0, "end_s": velocity.size / RATE,
        "end_reason": end_reason, "noise_velocity": white_noise(velocity), "findings": "",
    }  # fmt: skip
    return judge(xr.Dataset({"velocity": ("time", velocity)}, attrs=attrs), velocity, 250.0, **more)


def ids(found):
    return set(found["finding_id"].values.tolist())


def text(found, name):
    return str(found["finding_text"].values[found["finding_id"].values == name][0])


def decay(**more):
    """A lively decay: softening, second mode, 50 dB noise."""
    return ring_down(**({"second": 0.1, "noise_db": 50, "bits": 16} | more))[0]
