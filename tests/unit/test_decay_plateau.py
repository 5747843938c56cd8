"""The stick plateau: its errors hold, false onsets are rare, a bend to the end is called one."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.decay.freevib import freevib
from bladeroot.decay.plateau import fit_hinge, plateau
from decay_bench import ring_down


def blocks(seed, law, count=500):
    """Time, noisy phase, its std and amplitude of a decay whose rate is law(amplitude)."""
    rng = np.random.default_rng(seed)
    time = np.linspace(0.0, 1.6, 16 * count)
    amplitude = np.exp(-3.9 * time)
    phase = np.concatenate([[0.0], np.cumsum(law(amplitude))[:-1]]) * (time[1] - time[0])
    time, amplitude, phase = time[8::16], amplitude[8::16], phase[8::16]
    std = np.minimum(2e-3 / amplitude, 0.3)
    return time, phase + std * rng.standard_normal(time.size), std, amplitude


@pytest.mark.parametrize(("power", "sign"), [(1.0, -1.0), (1.5, -1.0), (2.0, 1.0)])
def test_rate_and_onset_with_honest_errors(power, sign):
    found = [
        fit_hinge(
            *blocks(seed, lambda a: 1570.0 + sign * 2.0 * np.maximum(0, a / 0.2 - 1) ** power)
        )
        for seed in range(4)
    ]
    assert all(hinge.left and hinge.reached for hinge in found)
    rate = np.array([(hinge.rate - 1570.0) / hinge.rate_std for hinge in found])
    onset = np.array([(hinge.onset - 0.2) / hinge.onset_std for hinge in found])
    assert 0.3 < np.sqrt(np.mean(rate**2)) < 1.8
    assert np.sqrt(np.mean(onset**2)) < 2.5
    assert np.median([hinge.onset for hinge in found]) == pytest.approx(0.2, rel=0.15)


def test_few_false_onsets():
    found = [fit_hinge(*blocks(seed, lambda a: 1570.0 + 0.0 * a)) for seed in range(40)]
    assert sum(hinge.left for hinge in found) <= 1
    z = np.array([(hinge.rate - 1570.0) / hinge.rate_std for hinge in found])
    assert 0.75 < np.sqrt(np.mean(z**2)) < 1.3


def test_bend_to_the_smallest_amplitude_is_not_a_plateau():
    hinge = fit_hinge(*blocks(0, lambda a: 1570.0 - 60.0 * np.sqrt(a)))
    assert hinge.left
    assert not hinge.reached


def test_record_that_never_leaves_the_plateau():
    velocity, noise, largest, _ = ring_down(4, softening=0.0, eta=(0.004, 0.004))
    found = plateau(freevib(velocity, 25600.0, 250.0, noise))
    assert found["verdict"] == "plateau"
    assert np.isnan(found["onset_amplitude"])
    assert found["onset_bound"] == pytest.approx(largest, rel=0.03)
    assert abs(found["stick_frequency"] / 250.0 - 1.0) < 3e-6
    assert found["loss_factor"] == pytest.approx(0.004, rel=0.002)


@pytest.mark.parametrize(("noise_db", "ppm"), [(60, 3), (40, 25)])
def test_stick_frequency_of_a_slipping_record(noise_db, ppm):
    z = []
    for seed in range(2):
        velocity, noise, largest, truth = ring_down(seed, noise_db=noise_db)
        found = plateau(freevib(velocity, 25600.0, 250.0, noise))
        frequency, loss = truth(0.1 * largest)
        assert found["stick_frequency"] == pytest.approx(frequency, rel=ppm * 1e-6)
        assert found["loss_factor"] == pytest.approx(loss, rel=0.02)
        assert found["onset_amplitude"] == pytest.approx(0.2 * largest, rel=0.2)
        z.append((found["stick_frequency"] - frequency) / found["stick_frequency_std"])
    assert np.sqrt(np.mean(np.square(z))) < 2.5


def test_rejected_record_says_why():
    empty = xr.Dataset(
        {"time": ("point", np.empty(0))}, attrs={"verdict": "rejected", "findings": "clipped"}
    )
    assert plateau(empty)["verdict"] == "rejected: clipped"
    assert plateau(empty)["plateau_reached"] == 0
