"""A sensor's own response, undone."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.io import responses
from bladeroot.io.channel import FEWEST_SAMPLES
from bladeroot.io.recording import recording
from bladeroot.io.responses import undoing
from bladeroot.signal.recording import velocity
from scipy.signal import bilinear, lfilter

RATE, MODE, CORNER = 2000.0, 6.0, 4.5


def test_a_high_pass_leaves_no_trace_in_size_and_phase():
    t = np.arange(int(10 * RATE)) / RATE
    motion = np.exp(-0.3 * t) * np.sin(2 * np.pi * MODE * t)
    w = 2 * np.pi * CORNER
    seen = lfilter(*bilinear([1.0, 0.0], [1.0, w], RATE), motion) + 0.02  # and an offset behind it
    inner = slice(200, -200)
    found = undoing(f"high-pass {CORNER} Hz")(seen, RATE)
    error = found - motion
    error -= np.polyval(np.polyfit(t, error, 1), t)
    assert np.std(seen[inner] - motion[inner]) > 0.1
    assert np.std(error[inner]) < 1e-3
    record = recording(seen, "m/s", "a", sampling_Hz=RATE)
    assert velocity(record, MODE) == pytest.approx(seen)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "high-pass",
        "high-pass 0.5",
        "high-pass 0 Hz",
        "high-pass 0.5 Hz 2",
        "high-pass -1 Hz",
        "notch 50 Hz",
        "high-pass 1.2.3 Hz",
    ],
)
def test_what_is_no_response_is_told(text):
    with pytest.raises(ValueError, match=r"response must be like `high-pass 0.5 Hz`"):
        undoing(text)


def test_a_kind_with_two_numbers_is_one_file(tmp_path, monkeypatch):
    kind = 'EXAMPLE = "roll-off 900 Hz 0.5"\n\n\ndef undone(x, rate, corner_Hz, ratio):\n'
    (tmp_path / "roll_off.py").write_text(kind + "    return x * corner_Hz * ratio / rate\n")
    monkeypatch.setattr(responses, "__path__", [*responses.__path__, str(tmp_path)])
    assert undoing("roll-off 1500Hz  0.25")(np.ones(2), 500.0) == pytest.approx([0.75, 0.75])
    with pytest.raises(ValueError, match=r"like `high-pass 0.5 Hz` or `roll-off 900 Hz 0.5`"):
        undoing("roll-off 1500 Hz")


def test_a_recording_with_a_response_is_undone_before_it_becomes_velocity():
    samples = np.random.default_rng(0).standard_normal(FEWEST_SAMPLES + 100)

    record = recording(samples, "m/s", "a", sampling_Hz=RATE)
    undone = velocity(replace(record, undone=undoing("high-pass 4.5 Hz")), MODE)
    assert undone == pytest.approx(undoing("high-pass 4.5 Hz")(record.samples, RATE))
