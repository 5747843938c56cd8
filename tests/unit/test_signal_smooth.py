"""B-splines against closed forms, the penalised fit against dense algebra and against scatter."""

import numpy as np
import pytest
from bladeroot.signal.banded import solution
from bladeroot.signal.penalty import (
    PRECISION_STD,
    alive_splines,
    at_rows,
    derivative_rows,
    full_solution,
    normal_sums,
    penalised,
    penalty_rows,
    posterior,
    root_of,
    whitened,
)
from bladeroot.signal.smooth import coarse, evidence, fine
from hypothesis import given, settings
from hypothesis import strategies as st


def padded(inner, degree):
    return np.concatenate([np.full(degree, inner[0]), inner, np.full(degree, inner[-1])])


def dense(shape, first, count):
    matrix = np.zeros((shape.shape[0], count))
    matrix[np.arange(shape.shape[0])[:, None], first[:, None] + np.arange(shape.shape[1])] = shape
    return matrix


@pytest.mark.parametrize("degree", [1, 3, 5])
def test_splines_reproduce_polynomials_and_their_derivatives(degree):
    rng = np.random.default_rng(degree)
    knots = padded(np.linspace(0, 2, 12) ** 1.5 + rng.uniform(0, 0.03, 12), degree)
    x = np.linspace(knots[0], knots[-1], 60)
    count = knots.size - degree - 1
    matrix = dense(*alive_splines(x, knots, degree), count)
    np.testing.assert_allclose(matrix.sum(axis=1), 1.0, atol=1e-13)
    power = rng.standard_normal(degree + 1)
    coefficient = np.linalg.lstsq(matrix, np.polyval(power, x), rcond=None)[0]
    np.testing.assert_allclose(matrix @ coefficient, np.polyval(power, x), atol=1e-9)
    rows = derivative_rows(knots, degree, 1)
    derived = rows[:, 0] * coefficient[:-1] + rows[:, 1] * coefficient[1:]
    lower = dense(*alive_splines(x, knots[1:-1], degree - 1), count - 1)
    np.testing.assert_allclose(lower @ derived, np.polyval(np.polyder(power), x), atol=1e-7)


def test_sums_and_penalty_match_dense_algebra():
    rng = np.random.default_rng(0)
    x, std = np.sort(rng.uniform(0, 1, 80)), rng.uniform(0.5, 2.0, 80)
    y = rng.standard_normal((2, 80))
    knots = padded(np.linspace(x[0], x[-1], 9), 5)
    shape, first = alive_splines(x, knots, 5)
    matrix = dense(shape, first, 13)
    gram, right, trend = normal_sums(x, y, std, shape, first, 13)
    about = y - trend[:, :1] * x - trend[:, 1:]
    np.testing.assert_allclose(right, about @ (matrix / std[:, None] ** 2), atol=1e-12)
    rows, centre = penalty_rows(knots)
    whole = np.zeros((centre.size, 13))
    for j, row in enumerate(rows):
        whole[j, j : j + row.size] = row
    precision = rng.uniform(0.1, 10.0, centre.size)
    expected = matrix.T @ (matrix / std[:, None] ** 2) + whole.T @ (precision[:, None] * whole)
    band = penalised(gram, rows, precision)
    np.testing.assert_allclose(band, in_band(expected, 6), rtol=1e-10)


def covariance(std, walk):
    """Of errors and of a Brownian motion's means over the steps about the values."""
    along = np.cumsum(walk)
    sixth = np.minimum(walk, np.append(walk[1:], walk[-1])) / 6.0
    return np.diag(std**2 - sixth) + np.minimum.outer(along, along)


def test_means_of_a_brownian_motion_have_the_covariance_that_is_whitened():
    rng = np.random.default_rng(1)
    motion = np.cumsum(rng.standard_normal((4000, 6 * 40)) / np.sqrt(40.0), axis=1)
    means = rng.standard_normal((4000, 1)) + motion.reshape(4000, 6, 40).mean(axis=2)
    walk = np.append(1.5, np.ones(5))  # half a step from the start to the middle of the first
    expected = covariance(np.zeros(6), walk)
    np.testing.assert_allclose(np.cov(means.T), expected, rtol=0.08)
    white, size = whitened(means.T, np.zeros(6), walk)
    np.testing.assert_allclose(white @ white.T / 4000, np.eye(6), atol=0.06)
    assert size == pytest.approx(0.5 * np.linalg.slogdet(expected)[1])


def walked(seed, size=1e-4, noise=1e-3, count=60):
    """A parabola with errors and a random walk, and the variances of both."""
    rng = np.random.default_rng(seed)
    time = np.linspace(0.0, 3.0, count)
    walk, std = np.full(count, size), np.full(count, noise)
    truth = np.stack([-time + 0.1 * time**2, 5.0 * time - 0.2 * time**2])
    root = np.linalg.cholesky(covariance(std, walk))
    return time, truth + (root @ rng.standard_normal((count, 2))).T, std, walk


def test_a_solution_beside_a_walk_matches_dense_algebra():
    time, y, std, walk = walked(0)
    knots = padded(np.linspace(time[0], time[-1], 9), 5)
    matrix = dense(*alive_splines(time, knots, 5), 13)
    rows, centre = penalty_rows(knots)
    precision = np.random.default_rng(0).uniform(0.1, 10.0, centre.size)
    white, _ = whitened(np.column_stack([matrix, y[0]]), std, walk)
    found, band, times = full_solution(root_of(white, rows, precision), 6)
    bends = dense(rows, np.arange(len(rows)), 13)
    known = np.linalg.solve(covariance(std, walk), np.column_stack([matrix, y[0]]))
    inverse = np.linalg.inv(matrix.T @ known[:, :13] + bends.T @ (precision[:, None] * bends))
    np.testing.assert_allclose(found, inverse @ (matrix.T @ known[:, 13]), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(band, in_band(inverse, 6), rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(times(np.eye(13)), inverse, rtol=1e-6, atol=1e-12)


def test_the_covariance_has_what_the_precisions_leave_unknown():
    """By finite differences of dense solutions, the precisions as known as their freedom tells."""
    rng = np.random.default_rng(2)
    x, std = np.linspace(0.0, 1.0, 120), np.full(120, 0.02)
    y = np.stack([np.maximum(x - 0.4, 0.0) + std * rng.standard_normal(120)])
    knots = padded(np.linspace(0.0, 1.0, 20), 5)
    shape, first = alive_splines(x, knots, 5)
    gram, (right,), _ = normal_sums(x, y, std, shape, first, 24)
    rows, centre = penalty_rows(knots)
    place, known = np.interp(centre, [0.0, 0.5, 1.0], np.arange(3.0)), np.full(3, -4.0)
    matrix, bends = dense(shape, first, 24), dense(rows, np.arange(len(rows)), 24)

    def solved(log_precision):
        precision = at_rows(place, log_precision)
        whole = matrix.T @ matrix / std[0] ** 2 + bends.T @ (precision[:, None] * bends)
        return np.linalg.solve(whole, right), np.linalg.inv(whole)

    _, value, band = posterior(
        lambda precision: solution(penalised(gram, rows, precision), right),
        rows, place, known, np.full(3, -40.0), 0,
    )  # fmt: skip
    expected, inverse = solved(known)
    assert (band[:, 0] > 1.02 * np.diag(inverse)).any()
    np.testing.assert_allclose(value, expected, rtol=1e-6, atol=1e-9)
    free = 1.0 - np.exp(-4.0) * np.einsum("ja,ab,jb->j", bends, inverse, bends)
    for unit in np.eye(3):
        moved = (solved(known + 1e-4 * unit)[0] - solved(known - 1e-4 * unit)[0]) / 2e-4
        freedom = np.interp(place, np.arange(3.0), unit) @ free
        inverse += np.outer(moved, moved) / (0.5 * freedom + PRECISION_STD**-2)
    np.testing.assert_allclose(band, in_band(inverse, 6), rtol=1e-5, atol=1e-12)


def test_a_walk_of_no_size_changes_nothing():
    time, y, std, _ = walked(1)
    plain, same = coarse(time, y, std, 3.0), coarse(time, y, std, 3.0, walk=np.zeros(60))
    np.testing.assert_allclose(same.coefficient, plain.coefficient, atol=1e-9)


def test_evidence_is_the_restricted_likelihood_of_the_values():
    """Against the values' own normal distribution, what no parabola tells left out."""
    time, y, std, walk = walked(2)
    fit = coarse(time, y, std, 3.0, walk=walk)
    shape, first = alive_splines(time / 3.0, fit.knots, 5)
    matrix = dense(shape, first, fit.knots.size - 6)
    rows, centre = penalty_rows(fit.knots)
    bends = np.stack(
        [np.pad(row, (j, matrix.shape[1] - row.size - j)) for j, row in enumerate(rows)]
    )
    place = np.interp(centre, fit.prior.node, np.arange(float(fit.prior.node.size)))
    free = np.linalg.svd(np.vander(time, 3))[0][:, 3:]  # what no parabola is

    def likelihood(walk):
        found, square, size = 0.0, 0.0, 2 * (time.size - 3)
        for part, log_precision in enumerate(fit.prior.log_precision):
            root = matrix @ np.linalg.pinv(bends) / np.sqrt(at_rows(place, log_precision))
            whole = free.T @ (covariance(std, walk) + root @ root.T) @ free
            own = free.T @ y[part]
            square += own @ np.linalg.solve(whole, own)
            found -= 0.5 * np.linalg.slogdet(whole)[1]
        return found - 0.5 * size * np.log(square / size), square / size

    ours = [evidence(time, y, std, size, fit) for size in (walk, 0.1 * walk)]
    known = [likelihood(size) for size in (walk, 0.1 * walk)]
    assert ours[0][0] - ours[1][0] == pytest.approx(known[0][0] - known[1][0], rel=1e-4)
    assert ours[0][1] == pytest.approx(known[0][1], rel=1e-4)
    assert ours[0][0] > ours[1][0]


def test_errors_beside_a_walk_are_those_of_simulation():
    """A slope in a walk of variance q T is known to the root of q / T at best."""
    z = []
    for seed in range(60):
        time, y, std, walk = walked(seed, noise=1e-6)
        fit = coarse(time, y, std, 3.0, iterations=6, walk=walk)
        slope = np.stack([-1.0 + 0.2 * time, 5.0 - 0.4 * time])
        error = fit.std(time)[1]
        assert (error > 0.9 * np.sqrt(walk[1:].sum()) / 3.0).all()
        z.append((fit.value(time)[1] - slope) / error)
    assert 0.6 < np.sqrt(np.mean(np.square(z))) < 1.3


def in_band(matrix, width):
    """The lower band of a dense matrix, as the banded kernels store it."""
    padded = np.pad(np.tril(matrix), ((0, width), (0, 0)))
    return np.stack([padded[j : j + width, j] for j in range(matrix.shape[0])])


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 30), st.integers(1, 7), st.integers(0, 2**32 - 1))
def test_banded_algebra_matches_dense(count, width, seed):
    rng = np.random.default_rng(seed)
    root = np.tril(np.triu(rng.standard_normal((count, count)), 1 - width))
    matrix = root @ root.T + 0.1 * np.eye(count)
    units = 10.0 ** rng.uniform(-4, 4, count)
    matrix *= np.outer(units, units)
    right = units * rng.standard_normal(count)
    x, found, times = solution(in_band(matrix, width), right)
    inverse = np.linalg.inv(matrix / np.outer(units, units)) / np.outer(units, units)
    beside = in_band(np.outer(units, units), width)
    known = in_band(inverse, width)
    np.testing.assert_allclose(found * beside, known * beside, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(x * units, inverse @ right * units, rtol=1e-8, atol=1e-10)
    again = times(np.stack([right, -2.0 * right], axis=1))
    np.testing.assert_allclose(
        again * units[:, None], np.stack([x, -2.0 * x], axis=1) * units[:, None]
    )


@pytest.mark.parametrize(
    "band", [[[1.0, 2.0], [1.0, 0.0]], [[-1.0, 0.0], [1.0, 0.0]], [[1.0, np.nan], [1.0, 0.0]]]
)
def test_a_matrix_that_is_not_positive_is_refused(band):
    with pytest.raises(np.linalg.LinAlgError):
        solution(np.array(band), np.ones(2))


def test_rows_of_the_penalty_have_unit_variance_where_the_third_derivative_is_white():
    """A cubic t^3/6 has third derivative one: its rows square and add up to the length."""
    knots = padded(np.linspace(0.0, 2.0, 21), 5)
    x = np.linspace(0.0, 2.0, 400)
    matrix = dense(*alive_splines(x, knots, 5), knots.size - 6)
    coefficient = np.linalg.lstsq(matrix, x**3 / 6.0, rcond=None)[0]
    rows, centre = penalty_rows(knots)
    bend = sum(row * coefficient[a : a + centre.size] for a, row in enumerate(rows.T))
    assert (bend**2).sum() == pytest.approx(2.0, rel=1e-6)


def kinked(seed, count=400, noise=1e-3):
    rng = np.random.default_rng(seed)
    time = np.linspace(0.0, 4.0, count)
    kink = rng.uniform(1.0, 2.5)
    bend = np.minimum(time - kink, 0.0)
    truth = np.stack([-time - 0.05 * bend**2, 3.0 * time + 0.1 * bend**2 - 0.02 * bend**3])
    slope = np.stack([-1.0 - 0.1 * bend, 3.0 + 0.2 * bend - 0.06 * bend**2])
    std = noise * np.exp(0.5 * time)
    y = truth + std * rng.standard_normal((2, count))
    return time, y, std, truth, slope


def test_derivatives_are_those_of_the_value():
    time, y, std, *_ = kinked(0)
    fit = fine(time, y, std, coarse(time, y, std, 4.0))
    at = np.linspace(0.1, 3.9, 57)
    step = 1e-4
    ahead, behind, here = fit.value(at + step), fit.value(at - step), fit.value(at)
    np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * step), here[1], rtol=1e-5)
    np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), here[2], atol=1e-4)


def test_standard_errors_are_those_of_simulation():
    """Pooled over kinked curves: 68 and 95 % within one and two standard errors."""
    z = [[], []]
    at = np.linspace(0.05, 3.95, 60)
    for seed in range(60):
        time, y, std, truth, slope = kinked(seed)
        fit = fine(time, y, std, coarse(time, y, std, 4.0))
        value, error = fit.value(at), fit.std(at)
        for order, known in enumerate((truth, slope)):
            for part in range(2):
                true = np.interp(at, time, known[part])
                z[order].append((value[order, part] - true) / error[order, part])
    for found in map(np.concatenate, z):
        assert 0.62 < np.mean(np.abs(found) < 1.0) < 0.80
        assert 0.92 < np.mean(np.abs(found) < 2.0) < 0.99


def test_scale_and_origin_of_time_do_not_matter():
    time, y, std, *_ = kinked(3)
    fit = fine(time, y, std, coarse(time, y, std, 4.0))
    moved = fine(1e3 * time + 7.0, y, std, coarse(1e3 * time + 7.0, y, std, 4e3))
    at = np.linspace(0.0, 4.0, 33)
    np.testing.assert_allclose(moved.value(1e3 * at + 7.0)[0], fit.value(at)[0], atol=1e-6)
    np.testing.assert_allclose(moved.std(1e3 * at + 7.0)[1] * 1e3, fit.std(at)[1], rtol=1e-3)
