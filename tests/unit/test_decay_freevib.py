"""FREEVIB against known backbones, its errors against their scatter, the thesis's own check."""

import numpy as np
import pytest
from bladeroot.decay.freevib import freevib, no_decay
from bladeroot.decay.plateau import plateau
from decay_bench import START, ring_down, slider


def errors(noise_db, seed, **changes):
    velocity, noise, largest, truth = ring_down(seed, noise_db=noise_db, **changes)
    curve = freevib(velocity, 25600.0, 247.0, noise)
    amplitude = curve["amplitude"].values
    inside = (amplitude > 0.02 * largest) & (amplitude < 0.95 * largest)
    frequency, loss = truth(amplitude)
    return {
        "frequency": (curve["frequency"].values / frequency - 1.0)[inside],
        "loss": (curve["loss_factor"].values / loss - 1.0)[inside],
        "frequency_z": ((curve["frequency"] - frequency) / curve["frequency_std"]).values[inside],
        "loss_z": ((curve["loss_factor"] - loss) / curve["loss_factor_std"]).values[inside],
    }


def rms(values):
    return np.sqrt(np.mean(values**2))


@pytest.mark.parametrize(
    ("noise_db", "softening", "ppm", "per_cent"), [(60, 0.02, 20, 1.0), (40, 0.002, 60, 6.0)]
)
def test_curves_follow_the_backbone(noise_db, softening, ppm, per_cent):
    found = errors(noise_db, 3, softening=softening)
    assert found["frequency"].size > 100
    assert rms(found["frequency"]) < ppm * 1e-6
    assert rms(found["loss"]) < per_cent * 1e-2


def test_standard_errors_hold():
    runs = [errors(45, seed) for seed in range(4)]
    for name in ("frequency_z", "loss_z"):
        z = np.concatenate([run[name] for run in runs])
        assert 0.4 < rms(z) < 1.8
        assert np.mean(np.abs(z) < 2.0) > 0.85


def test_second_mode_does_not_leak():
    with_it, without = (errors(60, 5, second=second) for second in (0.5, 0.0))
    assert rms(with_it["frequency"]) < 1.5 * rms(without["frequency"]) + 2e-6


def test_amplitude_is_displacement():
    velocity, noise, largest, _ = ring_down(1)
    curve = freevib(velocity, 25600.0, 250.0, noise)
    assert curve["amplitude"].values[0] == pytest.approx(largest, rel=0.03)
    assert largest == pytest.approx(START / (2 * np.pi * 250.0))


def test_undamped_backbone_is_recovered_without_noise_level():
    velocity, _, largest, _ = ring_down(2, softening=0.0, eta=(0.004, 0.004), second=0.0)
    curve = freevib(velocity, 25600.0, 250.0, 0.0)
    keep = curve["amplitude"] > 0.05 * largest
    assert np.abs(curve["frequency"].values[keep] / 250.0 - 1).max() < 3e-4
    assert rms(curve["loss_factor"].values[keep] / 0.004 - 1) < 0.02


def test_thesis_slider_stick_part():
    """Section 3.4: 544.73 Hz, eta 5e-3, X_cr 100 um (the thesis: 0.03, 0.11, 6.3 %)."""
    velocity = slider()
    velocity += 1e-5 * velocity.max() * np.random.default_rng(0).standard_normal(velocity.size)
    curve = freevib(velocity, 51200.0, 500.0, 1e-5 * velocity.max(), tolerance=0.4)
    found = plateau(curve)
    assert found["verdict"] == "plateau"
    assert found["stick_frequency"] == pytest.approx(544.73, rel=1e-4)
    assert found["loss_factor"] == pytest.approx(5e-3, rel=1e-3)
    assert found["onset_amplitude"] == pytest.approx(100e-6, rel=0.03)


def test_slider_follows_harmonic_balance():
    """Equivalent stiffness and damping (3.19) of the undamped slider well above its X_cr.

    One harmonic, and damping of one cycle on a decay that loses 4 % and more a cycle: they agree
    to the first order of that loss.
    """
    velocity = slider(zeta=0.0, duration_s=0.2)
    curve = freevib(velocity, 51200.0, 500.0, 0.0, tolerance=0.4)
    ratio = curve["amplitude"].values / 100e-6
    inside = (ratio > 20.0) & (ratio < 95.0)
    assert inside.sum() > 15
    ratio = ratio[inside]
    theta = np.arccos(1.0 - 2.0 / ratio)
    stiffness = 4.2e6 + 4e6 / np.pi * (theta - 0.5 * np.sin(2.0 * theta))
    damping = 4e6 * 4.0 / np.pi / ratio * (1.0 - 1.0 / ratio)
    frequency = np.sqrt(stiffness / 0.7) / (2.0 * np.pi)
    assert np.abs(curve["frequency"].values[inside] / frequency - 1.0).max() < 1.5e-3
    loss = curve["loss_factor"].values[inside] * stiffness / damping
    assert np.abs(loss - 1.0).max() < 0.05


def test_frequency_outside_the_record_is_refused():
    with pytest.raises(ValueError, match="expected_Hz must lie between"):
        freevib(np.random.default_rng(0).standard_normal(2000), 1000.0, 600.0, 0.1)


def test_no_decay_has_the_same_variables(tmp_path):
    velocity, noise, _, _ = ring_down(0, count=12800, second=0.0)
    curve = freevib(velocity, 25600.0, 250.0, noise)
    assert set(no_decay().variables) == set(curve.variables)
    curve.to_netcdf(tmp_path / "curve.nc")
    no_decay().to_netcdf(tmp_path / "none.nc")
    assert plateau(no_decay())["verdict"].startswith("rejected")
