"""Noise that shakes the mode itself: its size against the force's, errors against scatter."""

import bladeroot.decay.track as track
import numpy as np
import pytest
from bladeroot.decay import curve_errors
from bladeroot.decay.freevib import freevib
from bladeroot.decay.shaken import shaken, smooth
from bladeroot.signal.phasors import Phasors
from bladeroot.signal.smooth import coarse
from decay_bench import restless, ringing

FREQUENCY, DECLINE, RATE = 10.0, 0.3, 250.0


def blocks(rng, noise, walk, count=120, apart=0.1):
    """Blocks of a decay with constant rates, rms noise at its start and a walk of that force."""
    time = (np.arange(count) + 0.5) * apart
    growth = np.exp(DECLINE * time)
    steps = walk * np.sqrt(apart) * growth * rng.standard_normal((2, count))
    off = noise(time) * growth * rng.standard_normal((2, count)) + np.cumsum(steps, axis=1)
    y = np.stack([-DECLINE * time, 2.0 * np.pi * FREQUENCY * time]) + off
    near = np.sqrt((noise(time) * growth) ** 2 + (walk * growth) ** 2 * apart / 3.0)
    return Phasors(time, y[0] + 1j * y[1], near), coarse(time, y, near, count * apart)


@pytest.mark.parametrize("white", [1e-5, 1e-4, 4e-4])
def test_the_force_is_found_beside_white_noise(white):
    force = []
    for seed in range(8):
        decay, fit = blocks(np.random.default_rng(seed), lambda t: white + 0.0 * t, 3e-3)
        _, walk = shaken(decay, fit)
        force.append(walk[1] / (0.1 * np.exp(2.0 * DECLINE * decay.time[1])))
    assert np.exp(np.mean(np.log(force))) == pytest.approx(9e-6, rel=0.5)


def test_white_noise_and_what_dies_away_are_no_such_noise():
    for seed in range(20):
        rng = np.random.default_rng(seed)
        decay, fit = blocks(rng, lambda t: 1e-3 + 0.0 * t, 0.0)
        assert shaken(decay, fit) is None
        # a wave in the residual, alike in neighbours, that dies with the decay
        decay, _ = blocks(rng, lambda t: 1e-3 * np.exp(-DECLINE * t), 0.0)
        alike = np.convolve(rng.standard_normal(decay.time.size + 3), np.ones(4), "valid")
        y = np.stack([decay.log.real, decay.log.imag]) + 1e-3 * alike
        std = np.full(decay.time.size, 2e-3)
        fit = coarse(decay.time, y, std, 12.0)
        assert shaken(Phasors(decay.time, y[0] + 1j * y[1], std), fit) is None


@pytest.mark.parametrize(("walk", "looked_into"), [(0.0, (0, 4)), (3e-3, (18, 20))])
def test_most_ordinary_decays_are_smooth_and_shaken_ones_are_not(walk, looked_into):
    count = 0
    for seed in range(20):
        decay, fit = blocks(np.random.default_rng(seed), lambda t: 4e-4 + 0.0 * t, walk)
        off = np.stack([decay.log.real, decay.log.imag]) - fit.value(decay.time)[0]
        count += not smooth(decay, fit, off)
    assert looked_into[0] <= count <= looked_into[1]


def test_what_sways_in_proportion_to_the_mode_is_no_such_noise():
    for seed in range(10):
        rng = np.random.default_rng(seed)
        decay, fit = blocks(rng, lambda t: 1e-4 + 0.0 * t, 0.0)
        y = np.stack([decay.log.real, decay.log.imag])
        y += np.cumsum(1e-3 * rng.standard_normal(y.shape), axis=1)
        fit = coarse(decay.time, y, decay.std, 12.0)
        assert shaken(Phasors(decay.time, y[0] + 1j * y[1], decay.std), fit) is None


def test_the_decay_ends_where_the_noise_is_a_third_of_it():
    decay, fit = blocks(np.random.default_rng(1), lambda t: 1e-5 + 0.0 * t, 1e-2, count=125)
    std, walk = shaken(decay, fit)
    assert walk.sum() < 0.09
    # the force 1e-4 makes an rms of 1e-2 / sqrt(2 x 0.3) over exp(-0.3 t)
    last = decay.time[std.size - 1]
    assert last == pytest.approx(np.log(0.3 * np.sqrt(0.6) / 1e-2) / DECLINE, abs=2.0)


def errors(level, seeds):
    """Rms of frequency and loss factor, in stated errors, of decays beside their own noise."""
    z = []
    time = np.arange(round(14.0 * RATE)) / RATE
    for seed in seeds:
        rng = np.random.default_rng(seed)
        v = ringing(time, FREQUENCY, DECLINE, phase=rng.uniform(0.0, 6.0))
        v += restless(time, FREQUENCY, DECLINE, level, rng) + 1e-5 * rng.standard_normal(time.size)
        curves = freevib(v, RATE, FREQUENCY, 1e-5)
        eta = 2.0 * DECLINE / (2.0 * np.pi * FREQUENCY)
        for name, true in (("frequency", FREQUENCY), ("loss_factor", eta)):
            z.append(np.median(((curves[name] - true) / curves[f"{name}_std"]) ** 2))
    return np.sqrt(np.mean(z))


@pytest.mark.parametrize("level", [0.003, 0.02])
def test_errors_beside_noise_that_shakes_the_mode_hold(level, monkeypatch):
    assert 0.4 < errors(level, range(10)) < 1.5
    monkeypatch.setattr(track, "shaken", lambda *_: None)
    for name in ("beats", "bumps"):
        monkeypatch.setattr(curve_errors, name, lambda level, rates, std: 0.0)
    assert errors(level, range(10)) > 1.05
