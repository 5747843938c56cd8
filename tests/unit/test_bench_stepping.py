"""The bench's time stepping against closed forms of one slider and balances of many."""

import numpy as np
import pytest
from bladeroot.bench.stepping import Drive, linear_load_step, run
from hypothesis import given, settings
from hypothesis import strategies as st

# The single slider of section 3.4.
MASS, STIFFNESS, KT, LIMIT = 0.7, 4.2e6, 4.0e6, 400.0
X_CR = LIMIT / KT
OMEGA = np.sqrt((STIFFNESS + KT) / MASS)
DT = 1 / 51200


def no_drive(steps):
    return Drive(push=np.zeros(steps + 1), sine=np.zeros(steps + 1), mode=0)


def one_slider(start, steps, zeta=0.0, angle=0.0, dt=DT, limit=LIMIT):
    """Free motion of the 1-DOF model from x = start; the slider lies at an angle in its plane."""
    shape = np.array([[np.cos(angle)], [np.sin(angle)]]) / np.sqrt(MASS)
    return run(
        np.array([OMEGA]),
        np.array([zeta]),
        shape,
        np.array([KT, KT]),
        np.zeros((2, 2)),
        np.array([limit]),
        np.array([1 / np.sqrt(MASS)]),
        np.array([1 / np.sqrt(MASS)]),
        no_drive(steps),
        dt,
        state=np.array([start * np.sqrt(MASS)]),
    )


def position(motion, start, dt=DT):
    v = motion.velocity
    return start + np.concatenate([[0], np.cumsum((v[1:] + v[:-1]) / 2 * dt)])


def frequency_of_decay(velocity, dt):
    """Undamped frequency of one decaying sine, from its two-term recurrence."""
    a, b = np.linalg.lstsq(
        np.column_stack([velocity[1:-1], -velocity[:-2]]), velocity[2:], rcond=None
    )[0]
    root = np.log(complex(a / 2, np.sqrt(b - (a / 2) ** 2))) / dt
    return abs(root) / (2 * np.pi)


@pytest.mark.parametrize("zeta", [0.0, 0.0025, 0.3])
def test_step_follows_a_ramp_exactly(zeta):
    omega, dt, slope = 3000.0, 2e-4, 5.0
    step = linear_load_step(np.array([omega]), np.array([zeta]), dt)[0]
    r = v = 0.0
    for n in range(40):
        r, v = step @ [r, v, slope * n * dt, slope * (n + 1) * dt]
    t = 40 * dt
    root = np.sqrt(1 - zeta**2) * omega
    lag = 2 * zeta / omega
    decay = np.exp(-zeta * omega * t)
    swing = lag * np.cos(root * t) + (2 * zeta**2 - 1) / root * np.sin(root * t)
    expected = slope / omega**2 * (t - lag + decay * swing)
    assert r == pytest.approx(expected, rel=1e-9)


def test_stuck_motion_is_the_closed_form_without_period_error():
    start, zeta = 0.9 * X_CR, 2.5e-3
    motion = one_slider(start, 20000, zeta)
    t = np.arange(20001) * DT
    root = OMEGA * np.sqrt(1 - zeta**2)
    exact = -start * OMEGA**2 / root * np.exp(-zeta * OMEGA * t) * np.sin(root * t)
    np.testing.assert_allclose(motion.velocity, exact, atol=1e-9 * start * OMEGA)
    assert frequency_of_decay(motion.velocity, DT) == pytest.approx(544.73, abs=0.005)


def test_slip_begins_at_the_critical_amplitude():
    assert one_slider(0.999 * X_CR, 500).work_friction == 0
    assert one_slider(1.001 * X_CR, 500).work_friction > 0


def test_first_half_swing_with_slip():
    """Energy over the swing from x0 to -x1: K (x0^2 - x1^2) / 2 = mu N (x0 + x1 - 2 x_cr)."""
    x0 = 10 * X_CR
    dt = DT / 16
    x = position(one_slider(x0, 3000, dt=dt), x0, dt)
    a, b = STIFFNESS / 2, LIMIT
    x1 = np.roots([a, b, b * (x0 - 2 * X_CR) - a * x0**2]).max()
    assert x.min() == pytest.approx(-x1, rel=2e-5)


@pytest.mark.parametrize("ratio", [10, 30, 100])
def test_cycle_agrees_with_harmonic_balance(ratio):
    """Equivalent stiffness and energy lost a cycle of eq. 3.19."""
    x0 = ratio * X_CR
    x = position(one_slider(x0, 400), x0)
    peaks = np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:])) + 1
    first, second = peaks[:2]
    mean = (x[first] + x[second]) / 2
    theta = np.arccos(1 - 2 * X_CR / mean)
    k_eq = KT / np.pi * (theta - np.sin(2 * theta) / 2)
    frequency = np.sqrt((STIFFNESS + k_eq) / MASS) / (2 * np.pi)
    top = np.array([np.polyfit([-1, 0, 1], x[p - 1 : p + 2], 2) for p in peaks[:2]])
    instant = peaks[:2] - top[:, 1] / (2 * top[:, 0])
    assert 1 / (np.diff(instant)[0] * DT) == pytest.approx(frequency, rel=5e-3)
    lost = STIFFNESS / 2 * (x[first] ** 2 - x[second] ** 2)
    assert lost == pytest.approx(4 * LIMIT * (mean - X_CR), rel=0.01)


def test_decay_ends_on_the_stuck_frequency():
    """After all the slip the motion is linear again, to less than a millionth."""
    motion = one_slider(20 * X_CR, 30000, zeta=2.5e-3)
    tail = motion.velocity[-8000:]
    assert motion.work_friction > 0
    assert frequency_of_decay(tail, DT) == pytest.approx(OMEGA / (2 * np.pi), rel=1e-6)


@settings(max_examples=10, deadline=None)
@given(angle=st.floats(0, 2 * np.pi), ratio=st.floats(1.1, 50))
def test_friction_knows_no_direction_on_the_flank(angle, ratio):
    straight = one_slider(ratio * X_CR, 1500)
    turned = one_slider(ratio * X_CR, 1500, angle=angle)
    scale = np.abs(straight.velocity).max()
    np.testing.assert_allclose(turned.velocity, straight.velocity, atol=1e-6 * scale)
    assert turned.overshoot < 1e-6


def many_sliders(seed, limit_scale, steps=4000, dt=DT, sine=50.0):
    """A random chain with eight pairs whose stuck modes are only partly kept."""
    chance = np.random.default_rng(seed)
    dofs, pairs, kept = 24, 8, 5
    base = chance.standard_normal((dofs, dofs))
    stiffness = 1e6 * (base @ base.T / dofs + np.eye(dofs))
    tangential = chance.standard_normal((2 * pairs, dofs)) / np.sqrt(dofs)
    kt = np.repeat(chance.uniform(0.5, 2, pairs), 2) * 1e6
    stiffness += tangential.T @ (kt[:, None] * tangential)
    squares, shapes = np.linalg.eigh(stiffness)
    at = tangential @ shapes
    residual = (at[:, kept:] / squares[kept:]) @ at[:, kept:].T
    limit = limit_scale * chance.uniform(0.2, 2, pairs)
    n = np.arange(steps + 1)
    push = np.where(n < steps // 2, 20.0, 0.0) * np.minimum(n * dt / 2e-3, 1)
    drive = Drive(push=push, sine=np.where(n < steps // 2, sine, 0.0), mode=0)
    tip = shapes[0, :kept]
    return run(
        np.sqrt(squares[:kept]),
        np.full(kept, 2e-3),
        at[:, :kept],
        kt,
        (residual + residual.T) / 2,
        limit,
        tip,
        shapes[3, :kept],
        drive,
        dt,
    )


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10**6), limit_scale=st.floats(1, 100))
def test_sliders_keep_their_limit(seed, limit_scale):
    motion = many_sliders(seed, limit_scale)
    assert motion.overshoot < 1e-6


@pytest.mark.parametrize("seed", [1, 2])
def test_energy_balance_closes_with_the_step(seed):
    errors = []
    for finer in (1, 2, 4):
        motion = many_sliders(seed, 5.0, 4000 * finer, DT / finer)
        assert motion.work_friction > 0.05 * motion.work_in
        errors.append(motion.energy_error)
    assert errors[0] < 2e-3
    assert errors[2] < errors[0] / 4


def test_without_slip_the_motion_is_linear():
    """A limit that is never reached: no friction work, and twice the force moves twice as far."""
    once = many_sliders(3, 1e9, sine=50.0)
    assert once.work_friction == 0
    assert once.overshoot == 0
    with_slip = many_sliders(3, 1.0, sine=50.0)
    assert not np.allclose(once.velocity, with_slip.velocity, rtol=1e-2)
