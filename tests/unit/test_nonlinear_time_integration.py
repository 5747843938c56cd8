"""Free decays against the exact one-slider motion, energy and symmetry."""

import numpy as np
import pytest
from bladeroot.contact.laws.coulomb import coulomb
from bladeroot.contact.laws.sliders import Sliders
from bladeroot.reproduction.one_dof import free_decay as between_events
from bladeroot.reproduction.slider import Slider
from nonlinear_systems import LIMIT, MASS, SPRING, TANGENTIAL, X_CR, sliding_mass
from one_step import exact, hysteretic, newmark
from time_integration import free_decay

OMEGA = np.sqrt((SPRING + TANGENTIAL) / MASS)
SAMPLING = 51200.0
METHODS = pytest.mark.parametrize("method", [newmark, exact])


def released(system, law, method, start, substeps, zeta=2.5e-3, samples=2000, **options):
    omega = np.sqrt(system.values)
    step = method(omega, np.full(omega.size, zeta), 1.0 / SAMPLING / substeps)
    at_rest = np.zeros(omega.size)
    at_rest[0] = start * np.sqrt(MASS)
    return free_decay(system, law, step, at_rest, samples * substeps, substeps, **options)


@METHODS
def test_one_slider_moves_as_between_events_at_second_order(method):
    true, _ = between_events(Slider(), 10 * X_CR, SAMPLING, 2001 / SAMPLING)
    errors = [
        np.abs(
            released(*sliding_mass(), method, 10 * X_CR, substeps, tolerance=1.0).velocity - true
        ).max()
        for substeps in (2, 8, 32)
    ]
    assert errors[-1] < 1e-4 * np.abs(true).max()
    assert errors[0] > 8 * errors[1] > 64 * errors[2]


@METHODS
def test_energy_is_kept_and_its_error_falls_with_the_step(method):
    errors = [
        released(*sliding_mass(), method, 10 * X_CR, substeps, tolerance=1.0).energy_error
        for substeps in (1, 4)
    ]
    assert errors[0] < 1e-3
    assert errors[1] < max(errors[0] / 8, 1e-11)


def test_friction_takes_the_area_of_the_watched_loops():
    decay = released(*sliding_mass(), exact, 10 * X_CR, 32)
    x, f = decay.motion[:, 0], decay.force[:, 0]
    assert np.isclose(x[0], 10 * X_CR)
    assert np.isclose(f[0], LIMIT)
    area = -np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x))
    spring = 0.5 * (f[-1] ** 2 - f[0] ** 2) / TANGENTIAL
    np.testing.assert_allclose(-area - spring, decay.rubbed, rtol=2e-3)
    assert np.abs(f).max() <= LIMIT * (1 + 1e-9)


def test_stuck_decay_keeps_frequency_and_loss_factor():
    system, law = sliding_mass()
    omega, zeta = hysteretic(np.sqrt(system.values), np.array([0.004]))
    step = exact(omega, zeta, 1.0 / SAMPLING)
    decay = free_decay(system, law, step, np.array([0.5 * X_CR * np.sqrt(MASS)]), 4000)
    v = decay.velocity
    a, b = np.linalg.lstsq(np.column_stack([v[1:-1], -v[:-2]]), v[2:], rcond=None)[0]
    square = -((np.log(complex(a / 2, np.sqrt(b - (a / 2) ** 2))) * SAMPLING) ** 2)
    np.testing.assert_allclose(
        [square.real, square.imag / square.real], [OMEGA**2, 0.004], rtol=1e-7
    )
    assert decay.rubbed == 0.0
    assert decay.sweeps == 0
    assert decay.energy_error < 1e-9


def test_direction_and_images_of_a_slider_do_not_matter():
    plain = released(*sliding_mass(), exact, 5 * X_CR, 4)
    for options in ({"angle": 0.7}, {"images": 4.0}):
        same = released(*sliding_mass(**options), exact, 5 * X_CR, 4)
        np.testing.assert_allclose(same.velocity, plain.velocity, atol=1e-7)
        np.testing.assert_allclose(same.rubbed, plain.rubbed, rtol=1e-7)


def test_a_varying_normal_load_that_does_not_vary_is_a_constant_one():
    system, law = sliding_mass()
    same = coulomb(law.normal[:, 0], law.tangential[:, 0], law.preload[:, 0], 0.08)
    one, other = (released(system, each, exact, 5 * X_CR, 4) for each in (law, same))
    np.testing.assert_allclose(other.velocity, one.velocity, atol=1e-9)


def test_a_contact_that_lifts_off_keeps_the_energy():
    """A normal spring alone that opens every half period: energy is kept, frequency falls."""
    system, _ = sliding_mass()
    shape = np.array([[[1.0], [0.0], [0.0]]]) / np.sqrt(MASS)
    stiff = np.array([[TANGENTIAL, 1.0]])
    system = type(system)(**{**vars(system), "shape": shape, "stiffness": stiff})
    one = np.ones((1, 1))
    law = Sliders(TANGENTIAL * one, one, 40.0 * one, 0.3 * one, True)
    far = released(system, law, exact, 100e-6, 16, zeta=0.0)
    turns = np.flatnonzero(np.diff(np.sign(far.velocity)) != 0).size
    closed, opened = OMEGA, np.sqrt(SPRING / MASS)
    assert closed * 0.98 > np.pi * turns / (2000 / SAMPLING) > opened
    assert far.energy_error < 1e-5


def test_what_is_wrong_is_said():
    system, law = sliding_mass()
    with pytest.raises(ValueError, match="stiffness while stuck"):
        released(system, sliding_mass(contact=2e6)[1], exact, X_CR, 1)
    with pytest.raises(ValueError, match="not zero"):
        released(system, law, exact, 0.0, 1)
    with pytest.raises(RuntimeError, match="energy balance"):
        released(system, law, exact, 3 * X_CR, 1, samples=500, tolerance=1e-9)
