"""Modes that outlive the measured one are taken off; a mode's own course is not."""

import numpy as np
import pytest
from bladeroot.decay.alone import alone, loud_lines
from bladeroot.decay.cut import cut
from bladeroot.decay.estimate import estimate
from bladeroot.plateau.plateau import plateau
from bladeroot.quality.integrity import judge
from decay_bench import course, levels, ring_down, ringing, slider

RATE, NOISE, OWN_HZ, DECLINE = 5120.0, 6e-5, 243.4, 3.9
TIME = np.arange(15719) / RATE
TRUTH_HZ = np.sqrt(OWN_HZ**2 - (DECLINE / (2.0 * np.pi)) ** 2)


def own():
    return ringing(TIME, OWN_HZ, DECLINE, 1.3)


def other(line_Hz, size, decline=0.55):
    return ringing(TIME, line_Hz, decline, size, 0.3)


def noise():
    return NOISE * np.random.default_rng(1).standard_normal(TIME.size)


def chain(velocity):
    """The curve of a record, as the workflow makes it."""
    decay = judge(cut(velocity, RATE, OWN_HZ), velocity, OWN_HZ, (122.4,))
    return estimate(decay.assign_attrs(expected_Hz=OWN_HZ))


@pytest.mark.parametrize("line_Hz", [60.0, 110.0, 122.4, 150.0, 180.0, 365.1, 486.8])
@pytest.mark.parametrize("size", [0.05, 0.55, 5.0])
def test_what_is_left_is_the_mode_and_its_noise(line_Hz, size):
    mode = own() + noise()
    left, found = alone(mode + other(line_Hz, size), RATE, OWN_HZ)
    assert found == pytest.approx([line_Hz], abs=0.5)
    assert np.abs(left - mode).max() < 2.0 * NOISE


def test_samples_without_weight_do_not_count():
    mode = own() + noise()
    velocity = mode + other(122.4, 0.55)
    usable = np.ones(TIME.size, bool)
    usable[5000:5020] = usable[9000:9003] = False
    left, _ = alone(np.where(usable, velocity, 0.0), RATE, OWN_HZ, usable)
    assert np.abs(left - mode)[usable].max() < 5.0 * NOISE


@pytest.mark.parametrize(("line_Hz", "size"), [(160.0, 6.0), (200.0, 2.5), (330.0, 6.0)])
def test_a_louder_mode_that_dies_sooner_is_taken_off(line_Hz, size):
    """Of two in the band the mode is the one near the expected frequency, if it is clear there."""
    mode = own() + noise()
    velocity = mode + other(line_Hz, size, decline=15.0)
    left, found = alone(velocity, RATE, OWN_HZ)
    assert found == pytest.approx([line_Hz], abs=3.0)
    assert np.abs(left - mode).max() < 0.02 * size
    curve = chain(velocity)
    off = (curve["frequency"].values - TRUTH_HZ) / curve["frequency_std"].values
    assert np.sqrt((off**2).mean()) < 2.0


@pytest.mark.parametrize(("sway_Hz", "size"), [(3.0, 0.05), (5.0, 0.05), (11.0, 0.01)])
def test_sway_is_taken_off(sway_Hz, size):
    mode = own() + noise()
    velocity = mode + other(sway_Hz, size, decline=0.1) + other(19.0, size)
    left, found = alone(velocity, RATE, OWN_HZ)
    assert sorted(found) == pytest.approx([sway_Hz, 19.0], abs=0.5)
    assert np.std(left - mode) < 0.03 * size
    curve = chain(velocity)
    off = (curve["frequency"].values - TRUTH_HZ) / curve["frequency_std"].values
    assert np.sqrt((off**2).mean()) < 2.0


def test_a_mode_by_itself_is_left_as_it_is():
    velocity = own() + noise()
    assert alone(velocity, RATE, OWN_HZ)[0] is velocity
    # one with another far above, and one whose own frequency rises by a third
    assert not loud_lines(ring_down(0)[0], 25600.0, 250.0)[1]
    for expected_Hz in (500.0, 544.73):
        assert not loud_lines(slider(), 51200.0, expected_Hz)[1]


@pytest.mark.parametrize(
    ("line_Hz", "size"),
    [(100.0, 0.55), (122.4, 0.2), (122.4, 0.55), (150.0, 0.55)],
)
def test_curve_beside_a_mode_that_outlives_it(line_Hz, size):
    curve = chain(own() + other(line_Hz, size) + noise())
    assert curve.attrs["other_modes_Hz"][0] == pytest.approx(line_Hz, rel=0.02)
    time, error = curve["time"].values, curve["frequency"].values - TRUTH_HZ
    loud = 1.3 * np.exp(-DECLINE * time) > 0.25 * size * np.exp(-0.55 * time)
    assert loud.sum() > 100
    assert np.abs(error[loud]).max() < 5e-5 * TRUTH_HZ
    assert (np.abs(error) < np.maximum(5.0 * curve["frequency_std"].values, 1e-6 * TRUTH_HZ)).all()
    found = plateau(curve)
    assert abs(found["stick_frequency"] - TRUTH_HZ) < 5.0 * found["stick_frequency_std"]


def test_a_mode_that_softens_and_outlives_the_measured_one_is_taken_off():
    """While it is loud it rings 2 % lower than in the later half."""
    amplitude = 0.3 * np.exp(-0.55 * TIME)
    line_Hz = 2.02 * OWN_HZ * (1.0 - 0.02 * np.maximum(0.0, 1.0 - 0.06 / amplitude))
    beside = amplitude * np.cos(2.0 * np.pi * np.cumsum(line_Hz) / RATE)
    mode = own() + noise()
    left, found = alone(mode + beside, RATE, OWN_HZ)
    assert found == pytest.approx([2.02 * OWN_HZ], rel=0.01)
    assert np.abs(left - mode)[TIME.size // 4 :].max() < 10.0 * NOISE
    curve = chain(mode + beside)
    error = curve["frequency"].values / TRUTH_HZ - 1.0
    assert np.sqrt((error**2).mean()) < 1e-4


def test_a_short_record_with_a_small_lower_mode_does_not_pretend_a_plateau():
    """Frames are long enough to tell the two apart, however few there are."""
    rate, softening = 4500.0, 0.01
    time = np.arange(int(0.4 * rate)) / rate

    def slip(a):
        return np.maximum(0.0, 1.0 - 0.03 / a)

    def omega(a):
        return 2.0 * np.pi * 300.0 * (1.0 - softening * slip(a))

    log, phase = course(
        lambda a: -0.5 * omega(a) * 0.003 * (1.0 + slip(a)), omega, time, levels(4.0, 0.03)
    )
    own_wave = np.exp(log) * np.cos(phase)
    lower = ringing(time, 141.0, np.pi * 141.0 * 0.009, 0.08, 1.0)
    noise = 1e-3 * np.random.default_rng(0).standard_normal(time.size)
    velocity = np.concatenate([np.zeros(225), own_wave + lower + noise])
    decay = judge(cut(velocity, rate, 300.0), velocity, 300.0)
    found = plateau(estimate(decay.assign_attrs(expected_Hz=300.0)))
    assert found["verdict"] == "plateau not reached"
    assert found["frequency_bound"] == pytest.approx(297.7, abs=0.3)
