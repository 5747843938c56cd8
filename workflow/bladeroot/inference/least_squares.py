"""Contact stiffness from the frequencies of one load: weighted least squares with priors.

With as many modes as stiffnesses the fit is exact where a root exists; with more, chi-square says
whether the model fits at all, and each mode's misfit by how much; with fewer, the priors decide
along what the data leave open.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.special import chdtrc
from scipy.stats import qmc

from bladeroot.inference.gaussian import Fit, best_fit, cost, fit, maxima_of
from bladeroot.inference.problem import Prior, State, with_known_errors

FE_BIAS = 0.005  # relative error of a model's frequency, one standard deviation, unless known
LEAST_PROBABILITY = 0.05  # of a larger chi-square; below it the model is said not to fit
_START_OFFSETS = (-0.6, 0.0, 0.6)  # of all ln k from their prior's mean, in standard deviations
# Where the posterior may have several maxima, as modes that change places make it, or where the fit
# from these misses the data: more starts, the farthest so many standard deviations off.
_MORE_STARTS, _FARTHEST = 16, 1.2
_LEAST_GAIN = 1e-8  # nats: the fit ends with a step that gains less

# ln f of the modes at ln k, their slopes, and whether the model holds there.
Frequencies = Callable[[Float[ndarray, " parameter"]], tuple[ndarray, ndarray, bool]]


@dataclass(frozen=True)
class StiffnessFit:
    """MAP estimate of ln k at one load.

    misfit: ln of measured over fitted, in standard deviations of measurement and model together.
    gain: slope of the estimate by each mode's ln f. probability: of a larger chi-square; 1 without
    a degree of freedom. others: further maxima of the posterior that are not far less probable.
    """

    fit: Fit
    misfit: Float[ndarray, " mode"]
    gain: Float[ndarray, "parameter mode"]
    chi_square: float
    freedom: int
    probability: float
    others: tuple[Fit, ...] = ()


def ln_range(low: float, high: float, count: int) -> Prior:
    """Priors of ln k, two standard deviations of which reach from low to high (N/m)."""
    ends = np.log([low, high])
    return Prior(np.full(count, ends.mean()), np.full(count, 0.25 * (ends[1] - ends[0])))


def fit_stiffness(
    frequencies: Frequencies,
    ln_measured: Float[ndarray, " mode"],
    std: Float[ndarray, " mode"],
    prior: Prior,
    several: bool = False,
) -> StiffnessFit:
    """The stiffnesses that measured ln f ask for.

    std: of measurement and model together. several: whether the posterior may have several maxima.
    """

    def predict(ln_k: ndarray) -> State:
        value, slope, inside = frequencies(ln_k)
        return State(value, slope, {}, inside)

    problem = with_known_errors(ln_measured, predict, np.diag(std**2), prior)
    starts = [prior.mean + step * prior.std for step in _START_OFFSETS]
    found = best_fit(problem, starts, least=_LEAST_GAIN)
    freedom, others = ln_measured.size - prior.mean.size, []
    missed = chdtrc(max(freedom, 1), _square(found, ln_measured, std)) < LEAST_PROBABILITY
    if several or missed:
        even = qmc.Sobol(prior.mean.size, scramble=False).random(_MORE_STARTS)
        starts = prior.mean + _FARTHEST * (2.0 * even - 1.0) * prior.std
        more = [
            fit(problem, start, least=_LEAST_GAIN)
            for start in starts
            if np.isfinite(cost(problem, start))
        ]
        found, *others = maxima_of([found, *more], prior.mean.size)
    square = _square(found, ln_measured, std)
    misfit = (ln_measured - found.state.mean) / std
    chance = float(chdtrc(freedom, square)) if freedom > 0 else 1.0
    gain = found.covariance @ (found.state.slope / std[:, None] ** 2).T
    return StiffnessFit(found, misfit, gain, square, freedom, chance, tuple(others))


def _square(found: Fit, ln_measured: ndarray, std: ndarray) -> float:
    """Chi-square of a fit."""
    return float(np.sum(((ln_measured - found.state.mean) / std) ** 2))
