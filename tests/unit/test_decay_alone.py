"""Modes that outlive the measured one are taken off; a mode's own course is not."""

import numpy as np
import pytest
from bladeroot.decay.alone import alone, loud_lines
from bladeroot.decay.estimate import estimate
from bladeroot.decay.plateau import plateau
from bladeroot.records.cut import cut
from bladeroot.records.integrity import judge
from decay_bench import ring_down, slider

RATE, NOISE, OWN_HZ, DECLINE = 5120.0, 6e-5, 243.4, 3.9
TIME = np.arange(15719) / RATE
TRUTH_HZ = np.sqrt(OWN_HZ**2 - (DECLINE / (2.0 * np.pi)) ** 2)


def own():
    return 1.3 * np.exp(-DECLINE * TIME) * np.cos(2.0 * np.pi * OWN_HZ * TIME)


def other(line_Hz, size, decline=0.55):
    return size * np.exp(-decline * TIME) * np.cos(2.0 * np.pi * line_Hz * TIME + 0.3)


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


def test_a_mode_by_itself_is_left_as_it_is():
    velocity = own() + noise()
    assert alone(velocity, RATE, OWN_HZ)[0] is velocity
    # one with another far above, and one whose own frequency rises by a third
    assert not loud_lines(ring_down(0)[0], 25600.0, 250.0)[1]
    assert not loud_lines(slider(), 51200.0, 544.73)[1]


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
