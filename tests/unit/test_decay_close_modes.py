"""Two close modes through cutting, judging and estimation: a right curve, or none."""

import numpy as np
import pytest
from bladeroot.decay.close_modes import BEATS, widened
from bladeroot.decay.cut import cut
from bladeroot.decay.estimate import estimate
from bladeroot.decay.freevib import freevib
from bladeroot.decay.rough import parts
from bladeroot.quality.integrity import judge
from bladeroot.signal.phasors import Phasors
from bladeroot.signal.smooth import coarse
from decay_bench import two_modes


def curve(ratio, size, other_loss):
    wave, rate = two_modes(ratio, size, other_loss)
    judged = judge(cut(0.1 * wave, rate, 1.0), 0.1 * wave, 1.0)
    return estimate(judged.assign_attrs(expected_Hz=1.0))


@pytest.mark.parametrize(
    ("ratio", "size", "other_loss"),
    [(1.07, 0.3, 0.0035), (0.93, 0.2, 0.003), (1.1, 0.14, 0.0065), (1.13, 0.45, 0.004)],
)
def test_close_modes_are_separated(ratio, size, other_loss):
    found = curve(ratio, size, other_loss)
    wanted = found["amplitude"].values > 0.02 * 0.1 / (2 * np.pi)
    error = np.abs(found["frequency"].values[wanted] - 1.0)
    assert wanted.sum() > 100
    assert np.median(error) < 5e-5
    assert error.max() < 2e-3
    assert np.median(np.abs(found["loss_factor"].values[wanted] / 0.003 - 1.0)) < 0.01
    assert "beats with this one" in found.attrs["findings"]


def test_few_beats_widen_the_errors():
    """What is told apart by few beats is less sure than the noise says; by many it is as sure."""
    assert wider(0.1) > wider(0.2) > 1.0
    assert wider(100.0) == pytest.approx(1.0, abs=0.01)
    # at BEATS beats while ln A falls by one both errors are equal
    assert wider(BEATS * 0.01) == pytest.approx(np.sqrt(2.0), rel=0.01)


def wider(gap_Hz):
    """Factor by which blocks and curve are widened where ln A falls by 0.01 a second."""
    time = np.arange(0.0, 400.0, 2.0)
    log = -0.01 * time + 2j * np.pi * time
    blocks = Phasors(time, log, np.full(time.size, 1e-3))
    fit = coarse(time, parts(log), blocks.std, 400.0)
    more, looser = widened(blocks, fit, 1.0 / gap_Hz)
    factor = float(more.std[0] / blocks.std[0])
    np.testing.assert_allclose(looser.std(time), factor * fit.std(time), rtol=1e-9)
    return factor


def test_the_curve_ends_before_the_other_mode_is_as_loud():
    wave, rate = two_modes(1.12, 0.12, 0.0015)
    found = freevib(0.1 * wave, rate, 1.0, 1e-4)
    crossing = np.log(1.0 / 0.12) / (np.pi * (0.003 - 1.12 * 0.0015))
    assert 0.5 * crossing < found["time"].values[-1] < crossing
    assert np.abs(found["frequency"].values - 1.0).max() < 2e-3


def test_what_cannot_be_told_apart_has_no_curve():
    found = curve(1.02, 0.15, 0.003)
    assert found.attrs["verdict"] == "rejected"
    assert "too close to be told apart" in found.attrs["findings"]
    assert found.sizes["point"] == 0


def test_a_mode_far_below_that_lasts_longer_does_not_end_the_curve():
    wave, rate = two_modes(0.36, 0.1, 0.001, rate=40.0)
    found = freevib(0.1 * wave, rate, 1.0, 1e-4)
    assert found["amplitude"].values[-1] < 0.01 * found["amplitude"].values[0]
    assert np.abs(found["frequency"].values - 1.0).max() < 2e-3
