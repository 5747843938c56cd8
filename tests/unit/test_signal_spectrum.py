"""The digitiser's steps: samples that were cut towards zero, and those that only look so."""

import numpy as np
import pytest
from bladeroot.signal.lines import not_cut


def decay(frequency, start, seed=1, noise=0.3, phase=0.7):
    """Samples in steps of the digitiser, not yet whole."""
    at = np.arange(40_000)
    wave = start * np.exp(-at / 12_000) * np.cos(2 * np.pi * frequency * at + phase)
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


def test_too_little_to_tell_stays():
    assert not_cut(np.zeros(100), 10).size == 100
    short = np.array([1.0, -1.0, 2.0])
    assert not_cut(short, 40) is short
