"""The beat of two close modes is found by its one-sided line."""

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


def test_modes_too_close_to_be_told_apart_reject_the_record():
    assert findings(1.02, 0.15, 0.003)["mode-beating"] == "drop"
