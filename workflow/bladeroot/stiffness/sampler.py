"""Draws from the joint posterior where it is not a normal distribution.

emcee: an ensemble that needs no tuning to the sloppy direction of (ln kn, ln kt), pure Python,
maintained, and takes all its walkers' points in one call, which our surfaces are made for: a call
costs little more with a hundred points than with ten, so there are many walkers and few steps.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.stiffness.marginal import marginal, with_biases
from bladeroot.stiffness.posterior import Problem, biases
from bladeroot.stiffness.summit import Summit

WALKERS = 16  # for each parameter that is walked over
# Autocorrelation times are 50 to 80 steps: some 2,000 independent draws. From seed to seed the 16
# and 84 % quantiles of ln k move by 0.05 of its standard deviation, the 97.5 % one of a long tail
# by 0.2.
STEPS, THIN = 1000, 20


def walkers(problem: Problem) -> int:
    """How many walk."""
    return WALKERS * (len(problem.names) - 2 * len(problem.levels.modes))


def sample(
    summit: Summit, steps: int = STEPS, seed: int = 5041
) -> tuple[Float[ndarray, "draw parameter"], float]:
    """Draws of the parameters (in their own units), and the largest autocorrelation time in steps.

    Starts at draws of Laplace's approximation, a third of `steps` before the first that counts;
    differential evolution crosses bent valleys. Deterministic for a seed.
    """
    import emcee

    problem, burn = summit.problem, steps // 3
    others = np.delete(np.arange(len(summit.u)), biases(problem))
    top, count = summit.u[others], walkers(problem)
    rng = np.random.default_rng(seed)
    factor = np.linalg.cholesky(summit.covariance[np.ix_(others, others)])
    start = np.tile(top, (count, 1))
    found = np.zeros(count, bool)
    for shrink in 0.5 ** np.arange(12):  # into the box
        trial = top + shrink * rng.standard_normal(start.shape) @ factor.T
        good = ~found & np.isfinite(marginal(problem, trial).log)
        start[good], found = trial[good], found | good
    moves = [(emcee.moves.DEMove(), 0.7), (emcee.moves.DESnookerMove(), 0.1),
             (emcee.moves.StretchMove(), 0.2)]  # fmt: skip
    ensemble = emcee.EnsembleSampler(
        count, len(top), lambda rest: marginal(problem, rest).log, moves=moves, vectorize=True
    )
    state = emcee.State(start, random_state=np.random.RandomState(seed).get_state())
    ensemble.run_mcmc(state, burn + steps, skip_initial_state_check=True)
    time = float(np.max(ensemble.get_autocorr_time(discard=burn, tol=0)))
    draws = with_biases(problem, ensemble.get_chain(discard=burn, thin=THIN, flat=True), rng)
    return problem.mean + problem.std * draws, time
