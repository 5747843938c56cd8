"""What is fitted: data, a model of them with a covariance, and priors.

A model gives its mean and slope at given parameters, and the covariance of the data about the mean
at given logarithms of scales. Parameters and logarithms of scales have Gaussian priors.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float
from numpy import ndarray


@dataclass(frozen=True)
class Prior:
    """Independent normal priors."""

    mean: Float[ndarray, " parameter"]
    std: Float[ndarray, " parameter"]


@dataclass(frozen=True)
class State:
    """What a model says at one point: mean, slope, and what its covariance needs to know.

    inside: whether the model holds at the point; outside it is continued linearly. turns: given
    scales, a vector and a symmetric matrix, the covariance's derivatives by the parameters times
    the vector, and the traces of their products with the matrix. None where the steps of a fit can
    do without them.
    """

    mean: Float[ndarray, " datum"]
    slope: Float[ndarray, "datum parameter"]
    facts: dict[str, ndarray]
    inside: bool = True
    turns: Callable[[ndarray, ndarray, ndarray], tuple[ndarray, ndarray]] | None = None


class LazyState(State):
    """A state whose slope, given as a function, is worked out when it is asked for."""

    def __init__(self, mean: ndarray, make_slope: Callable[[], ndarray], facts: dict) -> None:
        """make_slope: what `slope` will be."""
        self.__dict__.update(mean=mean, make_slope=make_slope, facts=facts, inside=True, turns=None)

    @cached_property
    def slope(self) -> Float[ndarray, "datum parameter"]:  # type: ignore[override]
        """Derivatives of the mean."""
        return self.make_slope()


Predict = Callable[[Float[ndarray, " parameter"]], State]
# Covariance of the data about the mean, and a function that makes its derivatives by the scales; a
# diagonal derivative is given as a vector.
Slopes = Callable[[], list[ndarray]]
Covariance = Callable[[State, Float[ndarray, " scale"]], tuple[ndarray, Slopes]]


@dataclass(frozen=True)
class Repeats:
    """Variances that repeated measurements show, beside the data.

    freedom: degrees of freedom of each. expected: function that gives the model's variances and
    the slopes of their logarithms by the scales.
    """

    freedom: Float[ndarray, " variance"]
    observed: Float[ndarray, " variance"]
    expected: Callable[[State, ndarray], tuple[ndarray, ndarray]]

    def cost(self, state: State, scales: Float[ndarray, " scale"]) -> float:
        """Minus their log-likelihood (chi-square), but for a constant."""
        expected, _ = self.expected(state, scales)
        return float(0.5 * self.freedom @ (np.log(expected) + self.observed / expected))

    def pull(self, state: State, scales: Float[ndarray, " scale"]) -> tuple[ndarray, ndarray]:
        """Gradient of the log-likelihood by the scales, and its expected curvature."""
        expected, slope = self.expected(state, scales)
        half = 0.5 * self.freedom
        return (half * (self.observed / expected - 1.0)) @ slope, slope.T @ (half[:, None] * slope)


@dataclass(frozen=True)
class Problem:
    """Data, a model of them, and priors of its parameters and scales.

    many: `predict` of several points at once, where that is cheaper. blocks: data of different
    blocks share no errors.
    """

    data: Float[ndarray, " datum"]
    predict: Predict
    covariance: Covariance
    prior: Prior
    scales: Prior
    repeats: Repeats | None = None
    many: Callable[[Float[ndarray, "point parameter"]], Sequence[State]] | None = None
    blocks: tuple[slice, ...] = (slice(None),)

    def states(self, parameters: Float[ndarray, "point parameter"]) -> Sequence[State]:
        """What the model says at several points."""
        return self.many(parameters) if self.many else [self.predict(one) for one in parameters]


def with_known_errors(
    data: Float[ndarray, " datum"],
    predict: Predict,
    errors: Float[ndarray, "datum datum"],
    prior: Prior,
) -> Problem:
    """Least squares with priors: a covariance that nothing changes, and no scales."""
    nothing = Prior(np.zeros(0), np.zeros(0))
    return Problem(data, predict, lambda *_: (errors, list), prior, nothing)
