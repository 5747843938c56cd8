"""The beat of two close modes: found by its one-sided line, taken off by its mean."""

import numpy as np
import pytest
from bladeroot.decay.beating import beat, without_beat
from bladeroot.decay.cut import cut
from bladeroot.quality.integrity import judge
from bladeroot.signal.envelope import Envelope
from decay_bench import two_modes

COUNT = 600


def seen(log):
    blank = np.zeros(log.size)
    return Envelope(np.arange(log.size) * 0.5, log, blank, blank, 1.0, 0.5, 3.0)


def course(slope=-0.005, turn=0.02):
    x = np.arange(COUNT)
    return (slope + 1j * turn) * x - 1e-6 * x**2


@pytest.mark.parametrize("period", [13.0, -28.5, 90.0])
@pytest.mark.parametrize("ratio", [0.05, 0.4])
def test_the_mean_over_a_beat_is_the_stronger_mode(period, ratio):
    own = course()
    log = own + np.log(1.0 + ratio * np.exp(2j * np.pi * np.arange(COUNT) / period))
    found = beat(seen(log), 1e-9, 0)
    assert found == pytest.approx(abs(period), rel=0.05)
    left = without_beat(seen(log), 0, abs(period)).log - own
    inner = slice(int(abs(period)), COUNT - int(abs(period)))
    assert np.abs(left[inner]).max() < 0.03 * ratio
    assert np.abs(left).max() < ratio


def test_frames_before_the_decay_stay():
    log = course() + np.log(1.0 + 0.2 * np.exp(2j * np.pi * np.arange(COUNT) / 20.0))
    np.testing.assert_array_equal(without_beat(seen(log), 100, 20.0).log[:100], log[:100])


@pytest.mark.parametrize("seed", range(5))
def test_noise_bends_and_steps_are_no_beat(seed):
    rng = np.random.default_rng(seed)
    noise = 0.01 * (rng.standard_normal(COUNT) + 1j * rng.standard_normal(COUNT))
    x = np.arange(COUNT)
    assert beat(seen(course() + noise), 1e-9, 0) is None
    assert beat(seen(course() + 0.01 * np.maximum(x - 200, 0) + 0.3 * noise), 1e-9, 0) is None
    assert beat(seen(course() + 0.4j * (x > 300) + 0.3 * noise), 1e-9, 0) is None
    # amplitude alone swings: two-sided
    assert beat(seen(course() + 0.1 * np.cos(0.3 * x)), 1e-9, 0) is None


@pytest.mark.parametrize(("ratio", "size"), [(1.07, 0.3), (0.94, 0.2), (1.12, 0.45), (0.9, 0.4)])
def test_a_beat_does_not_end_a_decay(ratio, size):
    wave, rate = two_modes(ratio, size, 0.0035)
    found = cut(0.1 * wave, rate, 1.0).attrs
    assert found["start_s"] < 16.0
    assert found["end_reason"] != "disturbed"
    assert found["end_s"] > 0.8 * wave.size / rate


def test_a_blow_under_a_beat_does():
    wave, rate = two_modes(1.07, 0.3, 0.0035)
    at = wave.size // 2
    wave[at:] += 0.3 * np.cos(2 * np.pi * np.arange(wave.size - at) / rate + 2.0)
    found = cut(0.1 * wave, rate, 1.0).attrs
    assert found["end_reason"] == "disturbed"
    assert abs(found["end_s"] - at / rate) < 16.0


def findings(ratio, size, other_loss):
    wave, rate = two_modes(ratio, size, other_loss)
    judged = judge(cut(0.1 * wave, rate, 1.0), 0.1 * wave, 1.0)
    rows = zip(judged["finding_id"].values, judged["finding_consequence"].values, strict=True)
    return dict(rows)


def test_a_mode_that_dies_soon_is_seen_in_the_first_frames():
    assert findings(1.09, 0.1, 0.008)["mode-beating"] == "warn"


def test_modes_too_close_to_be_told_apart_reject_the_record():
    assert findings(1.02, 0.15, 0.003)["mode-beating"] == "drop"
