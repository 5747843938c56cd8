"""Moments of posteriors along one parameter, beside sums over fine grids."""

import numpy as np
import pytest
from bladeroot.inference.gaussian import fit
from bladeroot.inference.marginal import moments
from bladeroot.inference.problem import Prior, State, with_known_errors

ERRORS = np.diag([0.01, 0.3]) ** 2
PRIOR = Prior(np.array([-1.2, 0.5]), np.array([0.5, 1.5]))


def problem_of(bend, prior=PRIOR):
    """The product of two parameters, and the first with a bend: data leave a ridge of both."""

    def predict(theta):
        if theta[0] > 2.0:
            return State(np.full(2, np.nan), np.full((2, 2), np.nan), {})
        tail = bend * np.exp(-theta[0] - 1.0)
        return State(
            np.array([theta.sum(), 0.1 * theta[0] + tail]),
            np.array([[1.0, 1.0], [0.1 - tail, 0.0]]),
            {},
        )

    return with_known_errors(np.array([-0.5, 0.0]), predict, ERRORS, prior)


def by_grid(problem):
    """Mean and standard deviation of the first; the second is integrated out by hand."""
    first = np.linspace(-5.0, 2.0, 4001)
    said = np.array([problem.predict(np.array([x, 0.0])).mean for x in first])
    off = problem.data - said - np.array([problem.prior.mean[1], 0.0])
    size = np.array([0.01**2 + problem.prior.std[1] ** 2, 0.09])
    log = -0.5 * (off**2 / size).sum(axis=1)
    log -= 0.5 * ((first - problem.prior.mean[0]) / problem.prior.std[0]) ** 2
    weight = np.exp(log - log.max())
    weight /= weight.sum()
    mean = weight @ first
    return mean, np.sqrt(weight @ (first - mean) ** 2)


@pytest.mark.parametrize("start", [-2.0, -1.0, 0.5])
@pytest.mark.parametrize("bend", [0.0, 0.1, 0.4])
def test_a_ridges_moments_are_those_of_a_fine_grid_wherever_the_fit_ends(bend, start):
    problem = problem_of(bend)
    found = fit(problem, np.array([start, -0.5 - start]), least=10.0)
    mean, covariance = moments(found, 0)
    wanted, width = by_grid(problem)
    assert mean[0] == pytest.approx(wanted, abs=0.05 * width)
    assert np.sqrt(covariance[0, 0]) == pytest.approx(width, rel=0.06)
    # the sum is known well, so that the second mirrors the first
    assert np.sqrt(covariance[1, 1]) == pytest.approx(width, rel=0.06)
    assert covariance[0, 1] == pytest.approx(-(width**2), rel=0.12)


def test_a_place_without_a_likelihood_ends_the_lattice():
    problem = problem_of(0.0, Prior(np.array([1.9, 0.0]), np.array([0.5, 3.0])))
    mean, covariance = moments(fit(problem, np.array([1.9, -2.4])), 0)
    assert mean[0] < 1.9
    assert np.isfinite(covariance).all()
