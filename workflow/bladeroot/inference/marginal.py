"""Mean and covariance of a posterior that is far from normal along one parameter.

Where data leave a ridge, its top says little: a fit may stop anywhere on it, and the curvature
there is not the ridge's width. So the one parameter is set to the places of a lattice in turn; the
other parameters are fitted there and integrated out by Laplace's formula. The places are whole
steps from the prior's mean; a step is the prior's standard deviation, halved until it is short
enough.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.inference.gaussian import Fit, cost, fit
from bladeroot.inference.problem import LazyState, Prior, Problem, State

# The lattice of the one parameter.
_LATTICE_STEP = 2.0  # standard deviations at most: so a normal density's moments are met to 1 %
_LATTICE_DEPTH = 3.0  # nats below the best place, where the lattice ends
_MOST_PLACES = 12  # to each side of the first
_LEAST_GAIN = 0.1  # nats: a fit of the other parameters ends with a step that gains less


def moments(
    found: Fit, number: int
) -> tuple[Float[ndarray, " parameter"], Float[ndarray, "parameter parameter"]]:
    """Mean and covariance of all parameters by a lattice of one of them.

    found: a fit of a problem with known errors; the lattice starts at it and follows the ridge.
    """
    problem, prior = found.problem, found.problem.prior
    rest = np.delete(np.arange(found.parameters.size), number)
    apart = prior.std[number]
    while apart > _LATTICE_STEP * found.std[number]:
        apart *= 0.5
    ridge = found.covariance[rest, number] / found.covariance[number, number]

    def place(step: int) -> float:
        return float(prior.mean[number] + step * apart)

    def fitted(step: int, start: ndarray) -> tuple[Fit, float]:
        one = fit(_given(problem, number, place(step)), start, least=_LEAST_GAIN)
        return one, one.log_evidence - 0.5 * (step * apart / prior.std[number]) ** 2

    first = round((found.parameters[number] - prior.mean[number]) / apart)
    there = found.parameters[rest] + ridge * (place(first) - found.parameters[number])
    fits = {first: fitted(first, there)}
    for side in (1, -1):
        step, change = first, side * apart * ridge
        while (
            fits[step][1] > max(log for _, log in fits.values()) - _LATTICE_DEPTH
            and abs(step - first) < _MOST_PLACES
        ):
            before = fits[step][0].parameters
            step += side
            if not np.isfinite(cost(_given(problem, number, place(step)), before + change)):
                break
            fits[step] = fitted(step, before + change)
            change = fits[step][0].parameters - before
    logs = np.array([log for _, log in fits.values()])
    weight = np.exp(logs - logs.max())
    weight /= weight.sum()
    points = np.array(
        [np.insert(one.parameters, number, place(step)) for step, (one, _) in fits.items()]
    )
    mean = weight @ points
    covariance = (weight[:, None] * (points - mean)).T @ (points - mean)
    covariance[np.ix_(rest, rest)] += np.einsum(
        "p,pij->ij", weight, [one.covariance for one, _ in fits.values()]
    )
    return mean, covariance


def _given(problem: Problem, number: int, value: float) -> Problem:
    """The problem of the other parameters."""
    rest = np.delete(np.arange(problem.prior.mean.size), number)

    def predict(parameters: ndarray) -> State:
        state = problem.predict(np.insert(parameters, number, value))
        return LazyState(state.mean, lambda: state.slope[:, rest], state.facts)

    prior = Prior(problem.prior.mean[rest], problem.prior.std[rest])
    return replace(problem, predict=predict, prior=prior, many=None)
