"""Peak finding and fitting: closed forms, its errors, masks, and its agreement with FREEVIB."""

import numpy as np
import pytest
from bladeroot.decay.freevib import freevib, no_decay
from bladeroot.quality.agreement import _mean_around, compare
from bladeroot.quality.peak_fit import (
    FILTER_DELAY,
    bridged,
    correlation,
    extrema,
    no_peaks,
    peak_fit,
)
from decay_bench import hysteretic, ring_down, viscous

RATE = 12800.0


def test_extrema_of_a_cosine():
    step = 1.0 / 32.0
    wave = 2.0 * np.cos(2 * np.pi * (np.arange(3200) * step - 0.1234))
    time, size = extrema(wave, step)
    assert np.abs((time - 0.1234) * 2 - np.round((time - 0.1234) * 2)).max() < 1e-4
    assert np.abs(size / 2.0 - 1).max() < 1e-6


@pytest.mark.parametrize("sampling_Hz", [1500.0, 12800.0, 200000.0])
def test_constants_of_a_decay_at_any_sampling_rate(sampling_Hz):
    time = np.arange(int(2.0 * sampling_Hz)) / sampling_Hz
    rate = 1j * 2 * np.pi * 250.0 * np.sqrt(1 + 5e-3j)
    peaks = peak_fit((1e-4 * rate * np.exp(rate * time)).real, sampling_Hz, 230.0, 1e-7)
    keep = peaks["pff_amplitude"].values > 5e-7
    assert np.abs(peaks["pff_frequency"].values[keep] / 250.0 - 1).max() < 3e-5
    assert np.abs(peaks["pff_loss_factor"].values[keep] / 5e-3 - 1).max() < 5e-3
    truth = 1e-4 * np.exp(rate.real * peaks["pff_time"].values)
    assert np.abs(peaks["pff_amplitude"].values / truth - 1)[keep].max() < 1e-3
    assert peaks["pff_time"].values[0] < (FILTER_DELAY + 2) / 250.0  # the first cycles are there


def test_viscous_law():
    zeta = 0.01
    peaks = peak_fit(viscous(zeta), RATE, 250.0, 1e-9, damping="viscous")
    keep = peaks["pff_amplitude"].values > 1e-6
    assert np.median(peaks["pff_frequency"].values[keep]) == pytest.approx(250.0, rel=3e-6)
    assert np.median(peaks["pff_loss_factor"].values[keep]) == pytest.approx(2 * zeta, rel=1e-3)
    other = peak_fit(viscous(zeta), RATE, 250.0, 1e-9)
    difference = (peaks["pff_frequency"] / other["pff_frequency"] - 1).values[keep]
    assert np.median(difference) == pytest.approx(zeta**2, rel=0.05)


def test_standard_errors_hold_in_noise():
    scores = []
    for seed in range(3):
        velocity, noise, largest, truth = ring_down(seed, noise_db=45, softening=0.002)
        peaks = peak_fit(velocity, 25600.0, 247.0, noise)
        frequency, loss = truth(peaks["pff_amplitude"].values)
        keep = peaks["pff_amplitude"].values > 0.01 * largest
        for name, true in (("frequency", frequency), ("loss_factor", loss)):
            z = (peaks[f"pff_{name}"] - true) / peaks[f"pff_{name}_std"]
            scores.append(z.values[keep])
    for which in (0, 1):
        z = np.concatenate(scores[which::2])
        assert 0.6 < np.sqrt(np.mean(z**2)) < 1.5
        assert np.mean(np.abs(z) < 2) > 0.88


def test_correlation_is_that_of_filtered_noise():
    lags = correlation()
    assert lags[lags.size // 2] == pytest.approx(1.0)
    assert np.allclose(lags, lags[::-1])
    assert np.abs(lags[:20]).max() < 1e-3


def test_masked_samples_do_not_count():
    velocity = hysteretic()
    usable = np.ones(velocity.size, dtype=bool)
    usable[9000:9300] = usable[20000] = False
    spoiled = np.where(usable, velocity, 1.0)
    peaks = peak_fit(spoiled, RATE, 250.0, 1e-9, usable=usable)
    keep = peaks["pff_amplitude"].values > 1e-6
    assert np.abs(peaks["pff_frequency"].values[keep] / 250.0 - 1).max() < 1e-4
    assert np.median(peaks["pff_frequency"].values[keep]) == pytest.approx(250.0, rel=1e-6)
    filled, good = bridged(velocity, usable, 2.0)
    assert good[20000]
    assert not good[9100]
    assert np.isfinite(filled).all()


def test_nothing_to_fit_is_an_empty_result():
    noise = np.random.default_rng(0).standard_normal(4000)
    assert peak_fit(noise[:50], RATE, 250.0, 1.0).sizes["peak"] == 0
    assert peak_fit(noise, RATE, 250.0, 10.0).sizes["peak"] == 0
    masked = np.zeros(noise.size, dtype=bool)
    assert peak_fit(noise, RATE, 250.0, 1.0, usable=masked).sizes["peak"] == 0
    empty = compare(no_decay(), no_peaks())
    assert int(empty["pff_agrees"]) == -1
    assert np.isnan(empty["pff_frequency_difference"])


def test_the_mean_of_a_straight_line_between_points_is_exact():
    time, at = np.linspace(0.0, 1.0, 11), np.array([0.31, 0.47, 0.83])
    mean = _mean_around(time, 500.0 + 40.0 * time, at, np.full(3, 0.01))
    np.testing.assert_allclose(mean, 500.0 + 40.0 * at, rtol=1e-12)


def test_a_gain_that_changes_with_the_frequency_is_allowed_for():
    """Softening by a tenth carries the frequency over half of the filter's flat top."""
    velocity, noise, _, _ = ring_down(0, softening=0.1, eta=(0.02, 0.04), second=0.0)
    curves = freevib(velocity, 25600.0, 247.0, noise)
    found = compare(curves, peak_fit(velocity, 25600.0, 247.0, noise))
    assert int(found["pff_agrees"]) == 1, str(found["pff_finding"].values)


@pytest.mark.parametrize(("name", "size"), [("frequency", 1e-3), ("loss_factor", 0.3)])
def test_what_cancels_over_the_record_is_found_where_it_is(name, size):
    velocity, noise, _, _ = ring_down(1, noise_db=60, softening=0.01)
    curves = freevib(velocity, 25600.0, 247.0, noise)
    place = np.linspace(0.0, 1.0, curves.sizes["point"])
    curves[name] = curves[name] * (1.0 + size * ((place > 0.4) & (place < 0.6)))
    found = compare(curves, peak_fit(velocity, 25600.0, 247.0, noise))
    assert abs(float(found[f"pff_{name}_difference_z"])) < 3.0
    assert int(found["pff_agrees"]) == 0
    assert " around 0." in str(found["pff_finding"].values)


def test_two_sound_estimates_agree():
    for seed in range(3):
        velocity, noise, _, _ = ring_down(seed, noise_db=50, softening=0.01)
        curves = freevib(velocity, 25600.0, 247.0, noise)
        found = compare(curves, peak_fit(velocity, 25600.0, 247.0, noise))
        assert int(found["pff_agrees"]) == 1, str(found["pff_finding"].values)
        assert abs(float(found["pff_frequency_difference"])) < 5e-5


@pytest.mark.parametrize(("name", "factor"), [("frequency", 1 + 1e-4), ("loss_factor", 1.05)])
def test_a_false_curve_is_found_out(name, factor):
    velocity, noise, _, _ = ring_down(1, noise_db=60, softening=0.01)
    curves = freevib(velocity, 25600.0, 247.0, noise)
    curves[name] = curves[name] * factor
    found = compare(curves, peak_fit(velocity, 25600.0, 247.0, noise))
    assert int(found["pff_agrees"]) == 0
    assert name.replace("_", " ") in str(found["pff_finding"].values)
    difference = float(found[f"pff_{name}_difference"])
    assert difference == pytest.approx(1 / factor - 1, rel=0.3)
