"""Draws from the joint posterior where it is not a normal distribution.

emcee: an ensemble that needs no tuning to the sloppy direction of (ln kn, ln kt), pure Python,
maintained, and takes all its walkers' points in one call, which our surfaces are made for.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.stiffness.posterior import log_posterior
from bladeroot.stiffness.summit import Summit

WALKERS = 4  # for each parameter
STEPS, THIN = 6000, 20


def sample(
    summit: Summit, steps: int = STEPS, seed: int = 5041
) -> tuple[Float[ndarray, "draw parameter"], float]:
    """Draws of the parameters (in their own units), and the largest autocorrelation time in steps.

    Starts at draws of Laplace's approximation, a sixth of `steps` before the first that counts;
    differential evolution crosses bent valleys. Deterministic for a seed.
    """
    import emcee

    problem, size, burn = summit.problem, len(summit.u), steps // 6
    walkers = WALKERS * size
    rng = np.random.default_rng(seed)
    factor = np.linalg.cholesky(summit.covariance)
    start = np.tile(summit.u, (walkers, 1))
    found = np.zeros(walkers, bool)
    for shrink in 0.5 ** np.arange(12):  # into the box
        trial = summit.u + shrink * rng.standard_normal((walkers, size)) @ factor.T
        good = ~found & np.isfinite(log_posterior(problem, trial))
        start[good], found = trial[good], found | good
    moves = [(emcee.moves.DEMove(), 0.7), (emcee.moves.DESnookerMove(), 0.1),
             (emcee.moves.StretchMove(), 0.2)]  # fmt: skip
    ensemble = emcee.EnsembleSampler(
        walkers, size, lambda u: log_posterior(problem, u), moves=moves, vectorize=True
    )
    state = emcee.State(start, random_state=np.random.RandomState(seed).get_state())
    ensemble.run_mcmc(state, burn + steps, skip_initial_state_check=True)
    time = float(np.max(ensemble.get_autocorr_time(discard=burn, tol=0)))
    draws = ensemble.get_chain(discard=burn, thin=THIN, flat=True)
    return problem.mean + problem.std * draws, time
