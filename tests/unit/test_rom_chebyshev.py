import numpy as np
import pytest
from bladeroot.rom.chebyshev import Surface, at_force, evaluate
from bladeroot.rom.chebyshev_fit import fit

LOW, HIGH = np.array([1.0, -2.0, 0.0]), np.array([3.0, 1.0, 5e3])


def smooth(points):
    """Two functions with known derivatives, one that couples all coordinates."""
    x, y, force = points.T
    return np.stack([np.sin(x) * np.exp(0.3 * y) + 1e-4 * force * x, 1.0 / (x + 0.1 * y**2)])


@pytest.fixture(scope="module")
def surface():
    return fit(smooth, LOW, HIGH, 1e-11)


@pytest.fixture(scope="module")
def points():
    return np.random.default_rng(2).uniform(LOW, HIGH, (300, 3))


def test_values_meet_the_tolerance(surface, points):
    np.testing.assert_allclose(evaluate(surface, points)[0], smooth(points).T, atol=1e-10)


def test_gradient_is_the_functions_own(surface, points):
    x, y, force = points.T
    _, gradient = evaluate(surface, points, order=1)
    wave = np.sin(x) * np.exp(0.3 * y)
    slope = np.stack([np.cos(x) * np.exp(0.3 * y) + 1e-4 * force, 0.3 * wave, 1e-4 * x], axis=1)
    np.testing.assert_allclose(gradient[:, 0], slope, atol=1e-8)
    lower = x + 0.1 * y**2
    np.testing.assert_allclose(gradient[:, 1, 1], -0.2 * y / lower**2, atol=1e-7)


def test_second_derivatives_are_the_functions_own(surface, points):
    x, y, _ = points.T
    *_, bend = evaluate(surface, points, order=2)
    wave, turn = np.sin(x) * np.exp(0.3 * y), np.cos(x) * np.exp(0.3 * y)
    zero, load = 0.0 * x, np.full(x.size, 1e-4)
    wanted = [[-wave, 0.3 * turn, load], [0.3 * turn, 0.09 * wave, zero], [load, zero, zero]]
    np.testing.assert_allclose(bend[:, 0], np.transpose(wanted, (2, 0, 1)), atol=2e-6)
    one = evaluate(surface, points, 2, np.ones(x.size, dtype=int))[-1]
    np.testing.assert_allclose(one, bend[:, 1], atol=1e-12)
    assert evaluate(surface, points[:0], order=2)[-1].shape == (0, 2, 3, 3)


def test_polynomials_need_no_more_than_their_degree():
    cubic = fit(lambda p: (p[:, 0] ** 3 * p[:, 1])[None], LOW, HIGH, 1e-9)
    assert cubic.coefficients.shape == (1, 4, 2, 2)


def test_a_cut_at_one_force_is_the_same_surface(surface, points):
    cut = at_force(surface, 1.2e3)
    here = np.column_stack([points[:, :2], np.full(len(points), 1.2e3)])
    whole = evaluate(surface, here, order=1)
    for part, other in zip(evaluate(cut, here, order=1), whole, strict=True):
        inner = (slice(None), slice(None), *[slice(0, 2)] * (part.ndim - 2))
        np.testing.assert_allclose(part[inner], other[inner], atol=1e-10)
    assert np.all(evaluate(cut, here, order=1)[1][:, :, 2] == 0.0)


def test_many_points_and_none(surface):
    many = np.tile(0.5 * (LOW + HIGH), (10_000, 1))
    values = evaluate(surface, many)[0]
    assert values.shape == (10_000, 2)
    assert np.ptp(values, axis=0).max() < 1e-12
    assert evaluate(surface, many[:0], order=1)[1].shape == (0, 2, 3)


def test_points_outside_are_refused(surface):
    with pytest.raises(ValueError, match=r"ln kt must lie between -2 and 1, got 1\.5"):
        evaluate(surface, np.array([[2.0, 1.5, 0.0]]))
    with pytest.raises(ValueError, match="axial force must lie between 0 and 5000, got 6000"):
        at_force(surface, 6e3)


def test_what_is_not_smooth_is_refused():
    with pytest.raises(ValueError, match=r"not smooth over the box.*along ln kn"):
        fit(lambda p: np.abs(p[:, 0] - 1.7)[None], LOW, HIGH, 1e-9)


def test_a_surface_is_plain_arrays():
    flat = Surface(np.full((1, 1, 1, 1), 7.0), LOW, HIGH)
    assert evaluate(flat, np.array([LOW, HIGH]))[0].tolist() == [[7.0], [7.0]]
