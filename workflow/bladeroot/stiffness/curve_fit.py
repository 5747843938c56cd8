"""The friction that the curves ask for, and what they then tell of the stiffness.

In each round the curves are made linear at the present stiffness and friction, friction is
integrated out of them, and the joint MAP estimate of the stiffness with what is left is found. In
the first rounds friction is fitted to the curves before that; from then on it is kept at its
posterior's mean, since a fit may stop anywhere on a ridge of friction coefficients. Where on the
flanks the pressure happens to be high is not known: what that does to the curves is an error that
all levels, falls and rises share.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.inference.gaussian import Fit, cost, fit
from bladeroot.inference.marginal import moments
from bladeroot.inference.problem import LazyState, Prior, Problem, State, with_known_errors
from bladeroot.rom.joint import Joint
from bladeroot.stiffness.model import CurveTerm, LevelModel, curve_term, predict, refit
from bladeroot.stiffness.priors import FRICTION
from bladeroot.stiffness.simulated_curves import (
    along,
    by_friction,
    by_level,
    by_unevenness,
    levels_at,
)
from bladeroot.stiffness.softening import Softening, covariance

# The rounds, in each of which the curves are linearised at the stiffness so far.
_MOST_ROUNDS = 8
_CONVERGED_MOVE = 0.01  # of any level's ln kn, ln kt or ln F in the last round
_LONGEST_MOVE = 0.4  # of the same in one round
_MOST_MISFIT = 3.0  # standard deviations, rms of measured less simulated: more is not converged
# The fit of the friction in the first rounds.
_FRICTION_ROUNDS = 2  # with a fit; after the last one the posterior's mean is used instead
_FRICTION_STARTS = np.arange(-3.0, 4.0)  # of ln of the coefficient, prior's std from its mean
_FARTHEST_FRICTION = 8.0  # prior's std beyond which none is tried: powers overflow there
_LEAST_GAIN = 1e-2  # nats: the fit ends with a step that gains less
FRICTION_PRIOR = Prior(*np.array([entry[:2] for entry in FRICTION.values()]).T)


@dataclass(frozen=True)
class CurveFit:
    """Where the rounds ended.

    friction: mean of the parameters' posterior in the order of `FRICTION`, with their covariance,
    at the stiffness found.
    value: simulated falls and rises; std: standard deviation of measured less simulated, the
    model's error included. converged: whether the last round changed nothing that matters and the
    simulated curves meet the measured ones.
    """

    term: CurveTerm
    friction: Float[ndarray, " parameter"]
    friction_covariance: Float[ndarray, "parameter parameter"]
    value: Float[ndarray, " number"]
    std: Float[ndarray, " number"]
    rounds: int
    converged: bool


def fit_curves(
    joint: Joint,
    model: LevelModel,
    alone: Fit,
    softening: Softening,
    levels: list[tuple[str, float]],
    lasers: Mapping[str, float],
    discrepancy: float,
) -> CurveFit:
    """Start from the fit of the frequencies alone.

    RuntimeError if the curves cannot be simulated at a stiffness that the rounds come to.
    """
    prior = FRICTION_PRIOR
    measured = np.concatenate([softening.fall, softening.rise])
    smooth = errors = covariance(softening, levels, discrepancy)
    row = np.arange(len(measured))
    friction, at_k = prior.mean, alone
    largest, rounds = np.inf, 0
    while (largest > _CONVERGED_MOVE or rounds <= _FRICTION_ROUNDS) and rounds < _MOST_ROUNDS:
        rounds += 1
        z = predict(model, at_k.parameters[None]).logarithms[0]
        at = levels_at(joint, softening, levels, lasers, z)
        if rounds == 1:
            friction = _start(friction_problem(joint, at, measured, smooth))
        if rounds <= _FRICTION_ROUNDS:
            uneven = by_unevenness(joint, at, friction)
            errors = smooth + uneven @ uneven.T
            problem = friction_problem(joint, at, measured, errors)
            fitted = fit(problem, friction, least=_LEAST_GAIN)
            friction = fitted.parameters
        if rounds == _FRICTION_ROUNDS:
            friction, friction_covariance = moments(fitted, 0)
        value, along_curve = along(joint, at, friction)
        by_law = by_friction(joint, at, friction, value, along_curve)
        slopes = np.zeros((len(measured), len(levels), 3))
        slopes[row, np.tile(softening.level, 2)] = by_level(joint, at, friction, value, along_curve)
        rest = measured - value - by_law @ (prior.mean - friction)
        whole = errors + (by_law * prior.std**2) @ by_law.T
        term = curve_term(z, rest, slopes.reshape(len(measured), -1), whole)
        found = refit(replace(model, curves=term), at_k)
        away = predict(model, found.parameters[None]).logarithms[0] - z
        largest = float(np.abs(away).max())
        share = min(1.0, _LONGEST_MOVE / max(largest, _LONGEST_MOVE))
        at_k = replace(
            at_k,
            parameters=at_k.parameters + share * (found.parameters - at_k.parameters),
            scales=at_k.scales + share * (found.scales - at_k.scales),
        )
    std = np.sqrt(np.diag(errors))
    miss = (measured - value) / std
    return CurveFit(
        term,
        friction,
        friction_covariance,
        value,
        std,
        rounds,
        bool(largest <= _CONVERGED_MOVE and np.sqrt(np.mean(miss**2)) <= _MOST_MISFIT),
    )


def friction_problem(
    joint: Joint,
    at: list,
    measured: Float[ndarray, " number"],
    errors: Float[ndarray, "number number"],
) -> Problem:
    """Falls and rises at given stiffness, fitted by ln of the friction's parameters."""
    prior, none = FRICTION_PRIOR, np.full(measured.size, np.nan)

    def predict_curves(friction: ndarray) -> State:
        if np.abs((friction - prior.mean) / prior.std).max() > _FARTHEST_FRICTION:
            return LazyState(none, lambda: none, {})
        try:
            value, slope = along(joint, at, friction)
        except RuntimeError:
            return LazyState(none, lambda: none, {})
        return LazyState(
            value, lambda: by_friction(joint, at, friction, value, slope), {"along": slope}
        )

    return with_known_errors(measured, predict_curves, errors, prior)


def _start(problem: Problem) -> Float[ndarray, " parameter"]:
    """Friction to start from, by a scan of its coefficient: without slip there is no slope."""
    trials = problem.prior.mean + np.outer(
        _FRICTION_STARTS, problem.prior.std * [1.0, 0.0, 0.0, 0.0]
    )
    return trials[int(np.argmin([cost(problem, one) for one in trials]))]
