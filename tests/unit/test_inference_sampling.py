"""Draws of a posterior that bends, beside its integral over a grid."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.inference.gaussian import about, fit, maxima_of
from bladeroot.inference.problem import Prior, Problem, State
from bladeroot.inference.sampling import _Mixture, sample

NOISE = np.array([0.1, 0.1, 0.3])


def predict(theta):
    """A product and a difference of the first two, which bend, and a line with the third."""
    a, b, c = theta
    mean = np.array([np.exp(a + b), b + 0.3 * a**2, c + a])
    slope = np.array([[mean[0], mean[0], 0.0], [0.6 * a, 1.0, 0.0], [1.0, 0.0, 1.0]])
    return State(mean, slope, {}, bool(a > -1.0))


def covariance(state, scales):
    size = np.exp(2.0 * scales[0])
    return size * np.diag(NOISE**2), lambda: [2.0 * size * NOISE**2]


@pytest.fixture(scope="module")
def found():
    prior, scales = (
        Prior(np.zeros(3), np.array([1.0, 1.0, 2.0])),
        Prior(np.zeros(1), np.full(1, 0.2)),
    )
    problem = Problem(np.array([0.7, -0.2, 1.0]), predict, covariance, prior, scales)
    return fit(problem, np.array([0.1, -0.1, 0.5]))


def by_grid(problem):
    """Mean and standard deviation of a and b; c is integrated out by hand."""
    a, b, s = np.meshgrid(
        np.linspace(-1.0, 3.0, 160), np.linspace(-4.0, 3.0, 160), np.linspace(-0.8, 0.8, 25),
        indexing="ij",
    )  # fmt: skip
    y, size = problem.data, np.exp(s)
    parts = [(y[0] - np.exp(a + b), size * 0.1), (y[1] - b - 0.3 * a**2, size * 0.1),
             (y[2] - a, np.hypot(size * 0.3, 2.0)), (a, 1.0), (b, 1.0), (s, 0.2)]  # fmt: skip
    log = sum(-0.5 * (off / std) ** 2 - np.log(std) for off, std in parts)
    weight = np.exp(log - log.max())
    weight /= weight.sum()
    mean = [float((weight * x).sum()) for x in (a, b)]
    return mean, [
        np.sqrt(float((weight * (x - m) ** 2).sum())) for x, m in zip((a, b), mean, strict=True)
    ]


def test_draws_have_the_posteriors_mean_and_spread(found):
    draws = sample(found, (0, 1))
    mean, std = by_grid(found.problem)
    own = draws.parameters[:, :2]
    assert draws.effective > 1000.0
    error = 4.0 / np.sqrt(draws.effective)
    np.testing.assert_allclose((own.mean(axis=0) - mean) / std, 0.0, atol=error)
    np.testing.assert_allclose(own.std(axis=0), std, rtol=error)
    assert own[:, 0].min() > -1.0  # beyond which the model does not hold


def test_a_seed_gives_the_same_draws_and_another_others(found):
    one, again, other = (sample(found, (0, 1), 500, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.parameters, again.parameters)
    assert not np.array_equal(one.parameters, other.parameters)


def test_a_posterior_that_is_nowhere_is_told(found):
    def never(theta):
        said = predict(theta)
        return State(said.mean, said.slope, {}, False)

    nowhere = replace(found, problem=replace(found.problem, predict=never))
    with pytest.raises(ValueError, match="no draw has a finite posterior"):
        sample(nowhere, (0, 1), 100)


def test_both_peaks_are_drawn_where_the_fit_stands_on_one():
    def square(theta):
        return State(theta**2, np.diag(2.0 * theta), {})

    wide, none = Prior(np.zeros(1), np.ones(1)), Prior(np.zeros(0), np.zeros(0))
    problem = Problem(np.ones(1), square, lambda *_: (np.eye(1) * 0.01, list), wide, none)
    draws = sample(fit(problem, np.array([1.1])), (0,), 2000).parameters[:, 0]
    assert (draws > 0.0).mean() == pytest.approx(0.5, abs=0.06)
    assert abs(draws).std() == pytest.approx(0.05, rel=0.1)


def test_narrow_maxima_are_found_from_starts_about_the_prior_and_drawn_by_their_weight():
    """Of two, at which the first parameter is 1 and -1, known to 1e-3 as all others are."""

    def square(theta):
        return State(np.append(theta[0] ** 2, theta[1:]), np.diag([2.0 * theta[0], 1.0, 1.0]), {})

    wide, none = Prior(np.array([0.4, 0.0, 0.0]), np.ones(3)), Prior(np.zeros(0), np.zeros(0))
    data = np.array([1.0, 0.2, -0.3])
    problem = Problem(data, square, lambda *_: (np.eye(3) * 1e-6, list), wide, none)
    ends = [fit(problem, start) for start in (wide.mean, *about(wide, 1))]
    best, other = maxima_of(ends, 1)
    assert np.allclose([best.parameters[0], other.parameters[0]], [1.0, -1.0], atol=1e-3)
    assert maxima_of(ends, 0) == [best]
    draws = sample(best, (0, 1, 2), 2000, others=[other])
    assert draws.effective > 1000
    odds = np.exp(0.5 * ((-1.0 - 0.4) ** 2 - (1.0 - 0.4) ** 2))  # by the prior
    share = odds / (1.0 + odds)
    assert (draws.parameters[:, 0] > 0.0).mean() == pytest.approx(share, abs=0.05)


def test_a_part_of_the_proposal_that_no_draw_belongs_to_stays_where_it_is():
    """As where one draw has all the weight: the next proposal must be one."""
    places = np.array([[0.0], [1e9], [2e9]])
    mixture = _Mixture(np.full(3, 1.0 / 3.0), places, np.full((3, 1, 1), 1e-12))
    learnt = mixture.learnt(np.array([[0.0], [1e-7]]), np.array([1.0, 0.0]))
    assert np.isfinite(learnt.mean).all()
    assert np.isfinite(learnt.scale).all()
    assert learnt.mean[:, 0] == pytest.approx(places[:, 0], abs=1e-6)
