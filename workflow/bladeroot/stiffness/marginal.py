"""The joint posterior with the model's bias integrated out.

kn and kt answer a change of the bias so exactly that the two together lie in a thin bent sheet, in
which a sampler creeps. ln f is linear in the bias, whose prior is normal: given all else it has a
normal posterior in closed form, and the sampler needs to walk over the rest alone.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.stiffness.posterior import (
    Problem,
    bias_rows,
    biases,
    inner_products,
    of_curves,
    of_repeats,
    predict,
)


@dataclass(frozen=True)
class Marginal:
    """At several points: log density without the biases; mean and information of the biases there.

    All in standard deviations of their priors.
    """

    log: Float[ndarray, " point"]
    mean: Float[ndarray, "point bias"]
    information: Float[ndarray, "point bias bias"]


def marginal(problem: Problem, rest: Float[ndarray, "point other"]) -> Marginal:
    """The posterior at points of all parameters but the biases."""
    place, levels = biases(problem), problem.levels
    count = place.stop - place.start
    u = np.insert(rest, [place.start] * count, 0.0, axis=1)
    said = predict(problem, u)
    per_bias = problem.std[place, None] * bias_rows(levels)
    misfit = (levels.ln_frequency - said.ln_frequency)[:, None]
    columns = np.concatenate([misfit, np.broadcast_to(per_bias, (len(u), *per_bias.shape))], axis=1)
    product, determinant = inner_products(problem, said.slope, u[:, -1], columns)
    information = product[:, 1:, 1:] + np.eye(count)
    pull = -product[:, 1:, 0]
    mean = np.linalg.solve(information, pull[..., None])[..., 0]
    log = -0.5 * (
        product[:, 0, 0] - (pull * mean).sum(axis=1) + determinant
        + np.linalg.slogdet(information)[1] + (rest**2).sum(axis=1)
        + (len(levels.mode) + rest.shape[1]) * np.log(2.0 * np.pi)
    )  # fmt: skip
    log = log + of_repeats(problem, said.slope, u[:, -1]) + of_curves(problem, said)
    return Marginal(np.where(said.allowed, log, -np.inf), mean, information)


def with_biases(
    problem: Problem, rest: Float[ndarray, "point other"], rng: np.random.Generator
) -> Float[ndarray, "point parameter"]:
    """Each point with biases drawn from their posterior there."""
    here = marginal(problem, rest)
    # information = L L^T, so that L^-T z has its inverse for covariance
    back = np.linalg.cholesky(here.information).transpose(0, 2, 1)
    noise = np.linalg.solve(back, rng.standard_normal(here.mean.shape)[..., None])[..., 0]
    start = biases(problem).start
    return np.concatenate([rest[:, :start], here.mean + noise, rest[:, start:]], axis=1)
