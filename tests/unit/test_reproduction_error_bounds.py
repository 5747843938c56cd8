"""Appendix F as printed, made right, and the Cramer-Rao bound, against simulated errors."""

import numpy as np
import pytest
from bladeroot.reproduction.error_bounds import limit, published, two_points

F, ETA = 250.0, 5e-3


def test_published_is_appendix_f_with_numbers():
    found = published(500.0, 0.01, 1e-3, 100.0, clock=1e-6)
    phase = 1e-3 / (np.sqrt(2) * np.pi * 100)
    assert found.frequency == pytest.approx(500.0 * (1e-6 + phase))
    assert found.loss_factor == pytest.approx(0.01 * phase + np.sqrt(2) * 1e-3 / (np.pi * 100))


def test_made_right_is_the_same_over_a_short_stretch_of_little_damping():
    before, after = (rule(F, 1e-6, 1e-3, 10.0) for rule in (published, two_points))
    assert after.frequency == pytest.approx(before.frequency, rel=1e-4)
    assert after.loss_factor == pytest.approx(before.loss_factor, rel=1e-4)


@pytest.mark.parametrize("periods", [20.0, 200.0])
def test_two_points_is_what_happens(periods):
    rng = np.random.default_rng(1)
    ratio, count = 1e-3, 20000
    later = np.exp(-np.pi * ETA * periods)
    noise = ratio * (rng.standard_normal((2, count)) + 1j * rng.standard_normal((2, count)))
    first, last = 1.0 + noise[0], later + noise[1]
    turn = 2 * np.pi * periods + np.angle(last) - np.angle(first)
    frequency = F * turn / (2 * np.pi * periods)
    loss = 2 * np.log(np.abs(first / last)) / turn
    right = two_points(F, ETA, ratio, periods)
    assert frequency.std() == pytest.approx(right.frequency, rel=0.03)
    assert loss.std() == pytest.approx(right.loss_factor, rel=0.03)
    # the printed "bound" is exceeded in a third of cases at best
    bound = published(F, ETA, ratio, periods)
    assert np.mean(np.abs(frequency - F) > bound.frequency) > 0.3


def test_limit_is_that_of_a_constant_amplitude():
    # known: var(omega) = 24 r^2 / (V^2 N T^2)
    periods, samples, ratio = 100.0, 40.0, 1e-2
    expected = np.sqrt(24 * ratio**2 / (periods * samples)) / (periods / F) / (2 * np.pi)
    assert limit(F, 1e-12, ratio, periods, samples).frequency == pytest.approx(expected, rel=1e-6)


def test_limit_is_reached_by_least_squares():
    rng = np.random.default_rng(2)
    sampling_Hz, periods, ratio = 10000.0, 100.0, 1e-2
    time = np.arange(int(periods / F * sampling_Hz)) / sampling_Hz
    rate = -np.pi * F * ETA + 2j * np.pi * F
    wave = np.exp(rate * time)
    design = np.stack([wave.real, -wave.imag, (time * wave).real, -(time * wave).imag], axis=1)
    solve = np.linalg.pinv(design)
    found = np.array(
        [solve @ (wave.real + ratio * rng.standard_normal(time.size)) for _ in range(1500)]
    )
    right = limit(F, ETA, ratio, periods, sampling_Hz / F)
    assert (found[:, 3] / (2 * np.pi)).std() == pytest.approx(right.frequency, rel=0.06)
    assert (found[:, 2] / (np.pi * F)).std() == pytest.approx(right.loss_factor, rel=0.06)
