"""Newton's Jacobian and the branch's tangent against finite differences; the branch's end."""

from functools import partial

import numpy as np
import pytest
from bladeroot.nonlinear.aft import contact_forces, cycle
from bladeroot.nonlinear.balance import linearised, solve
from bladeroot.nonlinear.continuation import follow
from bladeroot.nonlinear.curves import first_slip
from bladeroot.nonlinear.flanks import FlankContact, flank_sliders
from bladeroot.nonlinear.harmonic_balance import nonlinear_mode
from bladeroot.nonlinear.response import QUASI_STATIC, harmonic, respond, respond_change
from bladeroot.nonlinear.system import system_of
from nonlinear_systems import coarse_joint

POINT = np.array([np.log(2e9), np.log(2e9), 6e3])
HARMONICS = (0, 1, 2, 3)


@pytest.fixture(scope="module")
def system():
    return system_of(coarse_joint(), POINT, "2B", -0.07, 1e-3, odd_force=False)


@pytest.mark.parametrize("balance", [QUASI_STATIC, harmonic(HARMONICS)])
def test_change_of_the_response_is_the_finite_difference(system, balance):
    rng = np.random.default_rng(1)
    missing, change = rng.normal(size=(2, len(system.count), 3, balance.size))
    here = respond(system, balance, 1e-5, missing)
    along = respond_change(system, balance, 1e-5, here, change, 1e-3)
    h = 1e-4
    up, down = (
        respond(system, balance, 1e-5 + s * 1e-3 * 1e-6 * h, missing + s * 1e-6 * h * change)
        for s in (1, -1)
    )
    for name in ("motion", "modal", "value", "decay"):
        difference = (getattr(up, name) - getattr(down, name)) / (2e-6 * h)
        expected = getattr(along, name)
        assert np.allclose(difference, expected, atol=1e-4 * np.abs(expected).max() + 1e-12)


def test_newtons_matrix_is_the_derivative_of_the_rest(system):
    sliders = flank_sliders(coarse_joint(), system, POINT, FlankContact("coulomb", 0.05))
    balance, samples = harmonic(HARMONICS), cycle(HARMONICS)
    amplitude = 2e-5
    rng = np.random.default_rng(2)
    stiffness = system.stiffness[:, [0, 1, 1]]
    motion = np.zeros((len(system.count), 3, 7))
    motion[:, :, 1] = amplitude * system.shape[:, :, 0]
    motion += 0.05 * np.abs(motion).max() * rng.normal(size=motion.shape)

    def rest(at):
        force, tangent, _ = contact_forces(sliders, at, samples)
        missing = stiffness[:, :, None] * at - force
        return at - respond(system, balance, amplitude, missing).motion, tangent, missing

    _, tangent, missing = rest(motion)
    assert np.abs(missing[:, 1:]).max() > 0.0
    lost = -tangent
    for a in range(3):
        for g in range(7):
            lost[:, a, g, a, g] += stiffness[:, a]
    line = linearised(
        system, balance, amplitude, respond(system, balance, amplitude, missing), lost
    )
    step = rng.normal(size=motion.shape) * np.abs(motion).max()
    h = 1e-6
    right = (rest(motion + h * step)[0] - rest(motion - h * step)[0]) / (2 * h)
    assert np.allclose(line(right), step, atol=1e-4 * np.abs(step).max())


def test_rate_is_the_derivative_along_the_branch(system):
    sliders = flank_sliders(coarse_joint(), system, POINT, FlankContact("coulomb", 0.1))
    balance, samples = harmonic((0, 1)), cycle((0, 1))

    def at(amplitude, guess):
        return solve(
            system, balance, lambda u: contact_forces(sliders, u, samples), amplitude, guess
        )

    slips = first_slip(system, sliders) * np.array([0.9, 1.3])
    branch = nonlinear_mode(system, sliders, slips, (0, 1), decaying=False)
    middle = branch.solutions[-1]
    assert middle.slip.any()
    step = 1e-5 * middle.amplitude
    up, down = (at(middle.amplitude + s * step, middle.motion) for s in (1, -1))
    for name in ("motion", "modal", "value", "laser"):
        difference = (getattr(up, name) - getattr(down, name)) / (2 * step)
        expected = getattr(middle.rate, name)
        assert np.allclose(difference, expected, atol=2e-3 * np.abs(expected).max())


def test_a_branch_that_cannot_be_followed_says_how_far_it_came(system):
    sliders = flank_sliders(coarse_joint(), system, POINT, FlankContact("jenkins", 0.05))
    whole = nonlinear_mode(system, sliders, np.array([1e-6]), (1,))
    first, samples = whole.solutions[0], cycle((1,))

    def at(amplitude, guess):
        evaluate = partial(contact_forces, sliders, samples=samples)
        return solve(system, harmonic((1,)), evaluate, amplitude, guess)

    def broken(amplitude, guess, across=None):
        return None if amplitude > 3.0 * first.amplitude else at(amplitude, guess)

    branch = follow(broken, np.array([1e-6, 1e-5]), first, lambda one: np.hypot(*one.laser[:2]))
    assert len(branch.solutions) == 1
    assert branch.reason == "no further solution could be followed"
    assert follow(broken, np.array([1e-6]), None, lambda one: 0.0).reason
