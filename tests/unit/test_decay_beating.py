"""The beat of two close modes is found by its one-sided line."""

import numpy as np
from bladeroot.decay.cut import cut
from bladeroot.decay.free_decay import free_decay
from bladeroot.io.recording import recording
from bladeroot.quality.integrity import judge
from decay_bench import two_modes


def findings(ratio, size, other_loss):
    wave, rate = two_modes(ratio, size, other_loss)
    judged = judge(cut(0.1 * wave, rate, 1.0), 0.1 * wave, 1.0)
    rows = zip(judged["finding_id"].values, judged["finding_consequence"].values, strict=True)
    return dict(rows)


def test_a_mode_that_dies_soon_is_found_by_its_beat():
    wave, rate = two_modes(1.09, 0.1, 0.008)
    found = free_decay(recording(0.1 * wave, "m/s", "here", sampling_Hz=rate), 1.0)
    assert "close-mode" in found["finding_id"].values


def test_a_close_mode_that_is_let_go_with_this_one_is_no_touch():
    """Held at 455 Hz by a shaker, released with a mode at 507 Hz that lasts longer."""
    after = np.arange(12800) / 6400.0 - 0.2
    on, omega = after >= 0.0, 2.0 * np.pi * 455.0
    held = np.where(on, np.exp(-0.0012 * omega * np.maximum(after, 0.0)), 1.0)
    close = 0.11 * on * np.exp(-0.00045 * omega * np.maximum(after, 0.0))
    wave = close * np.cos(1.1135 * omega * after + 5.4) - held * np.sin(omega * after + 1.0)
    wave += 1e-4 * np.random.default_rng(0).normal(size=after.size)
    found = free_decay(recording(0.1 * wave, "m/s", "here", sampling_Hz=6400.0), 455.0)
    assert found["finding_id"].values.tolist() == ["close-mode", "leftover"]
    assert found.attrs["verdict"] == "usable"


def test_modes_too_close_to_be_told_apart_reject_the_record():
    assert findings(1.02, 0.15, 0.003)["mode-beating"] == "drop"
