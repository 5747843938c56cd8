"""The digitiser's steps: samples that were cut towards zero, and those that only look so."""

import numpy as np
import pytest
from bladeroot.signal.lines import not_cut


def decay(frequency, start, seed=1, noise=0.3, phase=0.7, lasts=12_000):
    """Samples in steps of the digitiser, not yet whole."""
    at = np.arange(40_000)
    wave = start * np.exp(-at / lasts) * np.cos(2 * np.pi * frequency * at + phase)
    return wave + noise * np.random.default_rng(seed).normal(size=at.size)


@pytest.mark.parametrize("step", [1.0, 3.7e-5])
@pytest.mark.parametrize("start", [60.0, 900.0])
def test_half_a_step_is_put_back(start, step):
    clean = decay(0.0213, start)
    found = not_cut(step * np.trunc(clean), 47) / step
    loud = np.abs(clean) > 3.0
    assert abs(np.mean((np.abs(np.trunc(clean)) - np.abs(clean))[loud]) + 0.5) < 0.02
    assert abs(np.mean((np.abs(found) - np.abs(clean))[loud])) < 0.02
    assert not found[np.trunc(clean) == 0.0].any()


@pytest.mark.parametrize("converted", [np.round, np.floor, np.array])
def test_what_is_rounded_or_shifted_stays(converted):
    for seed in range(5):
        samples = converted(decay(0.0213, 200.0, seed))
        assert not_cut(samples, 47) is samples


def test_a_zero_met_in_every_cycle_is_no_cut():
    samples = np.round(decay(1 / 120, 300.0, noise=0.02, phase=0.5 * np.pi))
    assert not_cut(samples, 120) is samples


@pytest.mark.parametrize("noise", [0.2, 0.5])
def test_a_decay_that_meets_a_zero_in_every_cycle_is_told_by_its_conversion(noise):
    """Where in a step of a hundred in a cycle its zero lies does not matter."""
    for part in np.linspace(-0.5, 0.5, 24):
        phase = 0.5 * np.pi + 0.02 * np.pi * part
        clean = decay(0.01, 2000.0, noise=noise, phase=phase, lasts=3200)
        rounded, cut = np.round(clean), np.trunc(clean)
        assert not_cut(rounded, 100) is rounded
        assert not_cut(cut, 100) is not cut


def test_too_little_to_tell_stays():
    assert not_cut(np.zeros(100), 10).size == 100
    short = np.array([1.0, -1.0, 2.0])
    assert not_cut(short, 40) is short
