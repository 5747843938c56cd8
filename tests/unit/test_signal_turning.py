"""Falls of an envelope and kinks of a log-phasor, and the envelope they are found in."""

import numpy as np
import pytest
from bladeroot.signal.envelope import envelope
from bladeroot.signal.turning import clean_falls, expected_gain, kinks


def test_envelope_of_a_decaying_sine():
    time = np.arange(20000) / 5000.0
    velocity = 0.3 * np.exp(-0.5 * time) * np.cos(2 * np.pi * 101.0 * time + 0.4) + 0.02
    seen = envelope(velocity, 5000.0, 100.0)
    expected = np.log(0.3) - 0.5 * seen.time + 1j * (2 * np.pi * seen.time + 0.4)
    turns = np.round((seen.log - expected).imag[0] / (2 * np.pi))
    np.testing.assert_allclose(seen.log - 2j * np.pi * turns, expected, atol=2e-3)
    np.testing.assert_allclose(seen.mean, 0.02, atol=1e-3)
    assert seen.rest.max() < 1e-3


def test_envelope_of_noise():
    noise = np.random.default_rng(0).standard_normal(200000)
    seen = envelope(noise, 4000.0, 100.0)
    assert np.sqrt(np.mean(np.exp(2 * seen.level))) == pytest.approx(
        seen.noise(1.0, 4000.0), rel=0.05
    )
    assert np.median(seen.rest) == pytest.approx(1.0, rel=0.05)


def test_a_new_blow_begins_another_decay_but_the_tip_does_not():
    fall = -np.arange(100) / 25.0
    none = np.zeros(200, bool)
    assert clean_falls(np.concatenate([fall, 1.2 * fall]), 0.4, none)[0] == (100, 199)
    back = none.copy()
    back[100] = True
    faster = fall[-1] - np.arange(100) / 10.0
    assert clean_falls(np.concatenate([fall, faster]), 0.4, back) == [(0, 99)]


def test_chatter_does_not_end_a_decay():
    broken = np.zeros(200, bool)
    broken[[5, 9]] = True
    assert clean_falls(-np.arange(200) / 25.0, 0.4, broken) == [(9, 199)]


def test_long_records_cost_no_more_pieces():
    level = np.concatenate([np.zeros(50_000), -np.arange(50_000) / 1e4])
    ((peak, trough), *_) = clean_falls(level, 0.4, np.zeros(level.size, bool))
    assert (peak, trough) == (0, 99_999)


@pytest.mark.parametrize("side", [-1, 1])
def test_kinks_of_noise_alone(side):
    rng = np.random.default_rng(1)
    noise = 0.1 * (rng.standard_normal(20000) + 1j * rng.standard_normal(20000))
    x = np.arange(20000) / 20000
    tested = kinks(noise + x**2 + 3j * x**3, np.full(20000, 0.1), 12, side)
    assert 0.7 < tested.gain.mean() < 1.0  # over the larger of noise and scatter
    assert tested.gain.max() < 15.0


def test_a_bend_is_found_where_it_is_and_shows_the_gain_expected():
    x = np.arange(200.0)
    bend = np.where(x < 100.5, 0.0, -0.02 * (x - 100.5)) * (1 + 1j) / np.sqrt(2)
    tested = kinks(bend, np.full(200, 1e-2), 12, +1)
    best = int(np.argmax(tested.gain))
    assert abs(tested.place[best] - 101) <= 1
    assert abs(tested.bend[best]) == pytest.approx(0.02, rel=0.1)
    assert tested.gain[best] == pytest.approx(expected_gain(0.02, 1e-2, 12), rel=0.3)


def test_a_backbone_that_leaves_its_plateau_is_no_kink():
    """Slope stays, curvature jumps: the joint begins to stick."""
    x = np.arange(200.0)
    phase = 1e-3 * np.maximum(x - 100.0, 0.0) ** 2
    tested = kinks(1j * phase - 0.01 * x, np.full(200, 1e-4), 12, -1)
    assert (np.abs(tested.bend) * 12).max() < 0.06
    assert np.abs(tested.step).max() < 0.02


def test_too_few_points_hold_no_place():
    assert kinks(np.zeros(10, complex), np.ones(10), 7, 1).place.size == 0
