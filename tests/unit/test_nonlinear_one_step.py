"""Steps of one mode against solutions that are known, and the damper's work against energy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from one_step import exact, hysteretic, newmark
from scipy.integrate import solve_ivp

METHODS = pytest.mark.parametrize("method", [newmark, exact])


@given(st.floats(10.0, 1e5), st.floats(0.0, 0.9), st.floats(1e-6, 1e-3))
def test_exact_step_is_the_differential_equation(omega, zeta, dt):
    start, load = np.array([1.0, 0.3 * omega]), np.array([0.5, -0.7]) * omega**2
    step = exact(np.array([omega]), np.array([zeta]), dt).matrix[0]

    def rate(t, y):
        g = load[0] + (load[1] - load[0]) * t
        square = (omega * dt) ** 2
        return [y[1], dt**2 * g - 2 * zeta * omega * dt * y[1] - square * y[0]]

    end = solve_ivp(rate, (0, 1), [start[0], start[1] * dt], rtol=1e-9, atol=1e-9, method="DOP853")
    scale = max(1.0, omega * dt)
    np.testing.assert_allclose(
        step @ [*start, *load] * [1.0, dt], end.y[:, -1], atol=1e-6 * scale, rtol=1e-6
    )


@METHODS
@pytest.mark.parametrize("zeta", [0.0, 0.002, 0.4])
def test_energy_and_the_dampers_work_balance(method, zeta):
    omega = np.array([3000.0, 40e3])
    one = method(omega, np.full(2, zeta), 2e-5)
    z = np.array([1e-3, 2.0, 0.0, 0.0])
    r, v = (one.matrix @ z).T
    lost = 0.5 * (2.0**2 + (omega * 1e-3) ** 2) - 0.5 * (v**2 + (omega * r) ** 2)
    np.testing.assert_allclose(np.einsum("i,mij,j->m", z, one.loss, z), lost, atol=1e-9)


def test_newmark_converges_with_the_square_of_the_step():
    omega, zeta = np.array([3000.0]), np.array([0.01])
    z = np.array([1.0, 500.0, 0.0, 0.0])
    end = (exact(omega, zeta, 1e-4).matrix[0] @ z) * [1.0, 1 / 3000.0]
    errors = []
    for parts in (4, 8, 16):
        matrix, now = newmark(omega, zeta, 1e-4 / parts).matrix[0], z
        for _ in range(parts):
            now = np.array([*(matrix @ now), 0.0, 0.0])
        errors.append(np.abs(now[:2] * [1.0, 1 / 3000.0] - end).max())
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.05)


@METHODS
def test_a_constant_load_rests_where_the_spring_bears_it(method):
    matrix = method(np.array([900.0]), np.array([0.1]), 1e-4).matrix[0]
    np.testing.assert_allclose(
        matrix @ [5.0 / 900**2, 0.0, 5.0, 5.0], [5.0 / 900**2, 0.0], atol=1e-15
    )


def test_hysteretic_damper_has_the_complex_stiffness_pole():
    omega, zeta = hysteretic(np.array([3000.0]), np.array([0.3]))
    pole = -zeta * omega + 1j * omega * np.sqrt(1 - zeta**2)
    np.testing.assert_allclose(-(pole**2), 3000.0**2 * (1 + 0.3j) * np.array([1.0]), rtol=1e-12)


def test_an_overdamped_mode_is_refused():
    with pytest.raises(ValueError, match="underdamped"):
        exact(np.array([900.0]), np.array([1.2]), 1e-4)
