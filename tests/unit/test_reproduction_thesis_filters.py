"""The thesis's filters and FREEVIB by them: closed-form decays, both laws of damping."""

import numpy as np
import pytest
from bladeroot.plateau.plateau import plateau
from bladeroot.reproduction.thesis_filters import design, thesis_freevib
from decay_bench import hysteretic, ring_down, slider, viscous

RATE = 12800.0


def strong(curve, part=0.05):
    return curve["amplitude"].values > part * curve["amplitude"].values[0]


@pytest.mark.parametrize("sampling_Hz", [2000.0, 5120.0, 25600.0])
def test_filters_are_zero_phase_and_exact_in_the_pass_band(sampling_Hz):
    filters = design(sampling_Hz, 250.0, 37.5, 112.5)
    frequency = np.linspace(215.0, 285.0, 11)

    def gain(taps, at=frequency):
        place = np.arange(taps.size) - taps.size // 2
        return np.exp(-2j * np.pi * np.outer(at / sampling_Hz, place)) @ taps

    assert np.abs(gain(filters.band) - 1).max() < 1e-3
    assert np.abs(gain(filters.band, np.array([0.0, 130.0, 380.0]))).max() < 1e-3
    assert np.abs(gain(filters.hilbert) + 1j).max() < 1e-4
    assert np.abs(gain(filters.derivative) / (2j * np.pi * frequency) - 1).max() < 1e-4


def test_hysteretic_decay_gives_back_its_constants():
    curve = thesis_freevib(hysteretic(), RATE, 245.0, 1e-9)
    keep = strong(curve)
    assert np.abs(curve["frequency"].values[keep] / 250.0 - 1).max() < 2e-6
    assert np.abs(curve["loss_factor"].values[keep] / 5e-3 - 1).max() < 2e-3
    # the trapezoid rule alone would be off by 1e-3 in amplitude here
    time = curve["time"].values
    log = np.log(1e-4) + (1j * 2 * np.pi * 250.0 * np.sqrt(1 + 5e-3j)).real * time
    assert np.abs(curve["amplitude"].values / np.exp(log) - 1)[keep].max() < 3e-4


def test_viscous_decay_gives_back_its_constants():
    curve = thesis_freevib(viscous(), RATE, 245.0, 1e-9, damping="viscous")
    keep = strong(curve)
    assert np.abs(curve["frequency"].values[keep] / 250.0 - 1).max() < 2e-6
    assert np.abs(curve["loss_factor"].values[keep] / 5e-3 - 1).max() < 2e-3


def test_the_two_laws_differ_by_a_quarter_of_the_squared_loss_factor():
    zeta = 0.02
    found = {
        law: thesis_freevib(viscous(zeta), RATE, 245.0, 1e-9, damping=law)
        for law in ("viscous", "hysteretic")
    }
    ratio = found["viscous"]["frequency"] / found["hysteretic"]["frequency"]
    keep = strong(found["viscous"], 0.2)
    assert np.median(ratio.values[keep] - 1) == pytest.approx((2 * zeta) ** 2 / 4, rel=0.02)


def test_errors_hold_and_the_plateau_is_found_among_other_modes():
    velocity, noise, largest, truth = ring_down(3, noise_db=55, onset=0.2)
    curve = thesis_freevib(velocity, 25600.0, 247.0, noise)
    keep = curve["amplitude"].values > 0.01 * largest
    frequency, loss = truth(curve["amplitude"].values)
    for name, true in (("frequency", frequency), ("loss_factor", loss)):
        z = ((curve[name] - true) / curve[f"{name}_std"]).values[keep]
        assert 0.5 < np.sqrt(np.mean(z**2)) < 1.6
    found = plateau(curve)
    assert found["verdict"] == "plateau"
    assert abs(found["stick_frequency"] - 250.0) < 4 * found["stick_frequency_std"]
    assert found["stick_frequency_std"] < 250.0 * 5e-6


def test_slider_of_section_34():
    velocity = slider()
    velocity += 1e-5 * velocity.max() * np.random.default_rng(0).standard_normal(velocity.size)
    # slipping runs at 390 Hz: the filters must be set on the stuck mode
    curve = thesis_freevib(
        velocity, 51200.0, 540.0, 1e-5 * velocity.max(), tolerance=0.1, damping="viscous"
    )
    stuck = curve["amplitude"].values < 0.6e-4
    stuck &= curve["amplitude"].values > 1e-5
    assert np.median(curve["frequency"].values[stuck]) == pytest.approx(544.73, rel=3e-4)
    assert np.median(curve["loss_factor"].values[stuck]) == pytest.approx(5e-3, rel=2e-2)


def test_masked_samples_leave_a_gap_and_no_mark():
    velocity = hysteretic()
    usable = np.ones(velocity.size, dtype=bool)
    usable[12000:12400] = False
    spoiled = np.where(usable, velocity, 1.0)
    curve = thesis_freevib(spoiled, RATE, 245.0, 1e-9, usable=usable)
    keep = strong(curve)
    # the step that the gap leaves in the integral passes the stop band in part
    assert np.abs(curve["frequency"].values[keep] / 250.0 - 1).max() < 5e-5
    time = curve["time"].values
    assert not np.any((time > 12000 / RATE) & (time < 12400 / RATE))
    assert time.min() < 12000 / RATE < time.max()


@pytest.mark.parametrize(
    ("change", "message"),
    [({"expected_Hz": 4000.0}, "quarter"), ({"damping": "dry"}, "damping must be")],
)
def test_bad_input_is_one_line(change, message):
    with pytest.raises(ValueError, match=message):
        thesis_freevib(hysteretic(), RATE, noise=1e-9, **({"expected_Hz": 250.0} | change))


def test_a_decay_shorter_than_the_filters_is_refused():
    with pytest.raises(ValueError, match="longer than the filters"):
        thesis_freevib(hysteretic()[:900], RATE, 250.0, 1e-9)
