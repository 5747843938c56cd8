"""The friction that the curves want, and what they then say of the stiffness.

In each round friction is fitted to the curves at the present stiffness (Levenberg and Marquardt's
method); there the curves are made linear, friction is integrated out of them, and the joint
posterior with what is left is climbed. Where on the flanks the pressure happens to be high is not
known: what that does to the curves is an error that all levels, falls and rises share.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.joint import Joint
from bladeroot.stiffness.curve_errors import covariance
from bladeroot.stiffness.curve_term import CurveTerm, curve_term
from bladeroot.stiffness.posterior import coordinates, predict
from bladeroot.stiffness.simulated_curves import (
    FRICTION,
    along,
    by_friction,
    by_level,
    by_unevenness,
    levels_at,
)
from bladeroot.stiffness.softening import Softening
from bladeroot.stiffness.summit import Summit, climb

_ROUNDS, _CLOSE = 8, 0.01  # of ln k, in the last round
_UNEVEN = 4  # rounds after which the error by unevenness stays: with friction it swings a little
_LONGEST = 0.4  # change of ln k in one round
_MET = 3.0  # standard deviations by which simulated curves may miss the measured ones, rms
_SCAN = np.arange(-3.0, 4.0)  # of ln friction where the first fit may start, in prior's std
_FAR = 8.0  # prior's std beyond which no friction is tried: its powers overflow
_FITS, _GAIN = 25, 1e-2  # steps of the friction, and the least gain in log posterior to go on


@dataclass(frozen=True)
class CurveFit:
    """Where the rounds ended.

    friction: parameters in the order of `FRICTION`, with their covariance at the stiffness found.
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
    summit: Summit,
    softening: Softening,
    levels: list[tuple[str, float]],
    lasers: Mapping[str, float],
    discrepancy: float,
) -> CurveFit:
    """Start from the summit of the frequencies alone.

    RuntimeError if the curves cannot be simulated at a stiffness that the rounds come to.
    """
    prior = np.array([entry[:2] for entry in FRICTION.values()])
    spread = np.diag(prior[:, 1] ** 2)
    measured = np.concatenate([softening.fall, softening.rise])
    smooth = errors = covariance(softening, levels, discrepancy)
    row = np.arange(len(measured))
    friction, u, problem = prior[:, 0], summit.u, summit.problem
    largest, rounds = np.inf, 0
    while largest > _CLOSE and rounds < _ROUNDS:
        rounds += 1
        z = coordinates(predict(problem, u[None]))[0]
        at = levels_at(joint, softening, levels, lasers, z)
        if rounds == 1:
            friction = _start(joint, at, measured, np.linalg.inv(smooth), prior)
        if rounds <= _UNEVEN:
            uneven = by_unevenness(joint, at, friction)
            errors = smooth + uneven @ uneven.T
            precision = np.linalg.inv(errors)
        fitted = _fit_friction(joint, at, measured, precision, prior, friction)
        friction, value = fitted.friction, fitted.value
        slopes = np.zeros((len(measured), len(levels), 3))
        slopes[row, np.tile(softening.level, 2)] = by_level(
            joint, at, friction, value, fitted.along
        )
        rest = measured - value - fitted.slope @ (prior[:, 0] - friction)
        whole = errors + fitted.slope @ spread @ fitted.slope.T
        term = curve_term(z, rest, slopes.reshape(len(measured), -1), whole)
        climbed, _ = climb(replace(problem, curves=term), u)
        away = coordinates(predict(problem, climbed[None]))[0] - z
        largest = float(np.abs(away).max())
        u = u + min(1.0, _LONGEST / max(largest, _LONGEST)) * (climbed - u)
    information = fitted.slope.T @ precision @ fitted.slope + np.linalg.inv(spread)
    std = np.sqrt(np.diag(errors))
    miss = (measured - value) / std
    return CurveFit(
        term,
        friction,
        np.linalg.inv(information),
        value,
        std,
        rounds,
        bool(largest <= _CLOSE and np.sqrt(np.mean(miss**2)) <= _MET),
    )


def _start(joint, at, measured, precision, prior) -> Float[ndarray, " parameter"]:
    """The friction coefficient to start from: where nothing slips no slope leads away."""
    trials = prior[:, 0] + _SCAN[:, None] * np.array([prior[0, 1], 0.0, 0.0, 0.0])
    misses = [_trial(joint, at, one, (measured, precision, prior))[0] for one in trials]
    return trials[int(np.argmin(misses))]


def _trial(joint, at, friction, known) -> tuple[float, tuple[ndarray, ndarray] | None]:
    """The misfit of a friction and its curves; infinite far off or where there are none."""
    prior = known[2]
    if np.abs((friction - prior[:, 0]) / prior[:, 1]).max() > _FAR:
        return np.inf, None
    try:
        curves = along(joint, at, friction)
    except RuntimeError:
        return np.inf, None
    return _misfit(friction, curves[0], *known), curves


def _misfit(trial, value, measured, precision, prior) -> float:
    """Minus the log posterior of the friction at given stiffness, but for a constant."""
    away = (trial - prior[:, 0]) / prior[:, 1]
    return 0.5 * float((measured - value) @ precision @ (measured - value) + away @ away)


@dataclass(frozen=True)
class _Fitted:
    """A friction, falls and rises with it, and their slopes by ln amplitude and by friction."""

    friction: Float[ndarray, " parameter"]
    value: Float[ndarray, " number"]
    along: Float[ndarray, " number"]
    slope: Float[ndarray, "number parameter"]


def _fit_friction(joint, at, measured, precision, prior, friction) -> _Fitted:
    """The most probable friction at given stiffness, and the curves there."""
    known = (measured, precision, prior)
    curves = along(joint, at, friction)
    slope = by_friction(joint, at, friction, *curves)
    now, damping = _misfit(friction, curves[0], *known), 1.0
    for _ in range(_FITS):
        pull = slope.T @ precision @ (measured - curves[0])
        pull -= (friction - prior[:, 0]) / prior[:, 1] ** 2
        bend = slope.T @ precision @ slope + np.diag(prior[:, 1] ** -2)
        step = np.linalg.solve(bend + damping * np.diag(np.diag(bend)), pull)
        step *= min(1.0, 1.0 / np.abs(step).max())
        trial, tried = _trial(joint, at, friction + step, known)
        if tried is not None and trial < now:
            gained, now, friction = now - trial, trial, friction + step
            curves, damping = tried, 0.2 * damping
            slope = by_friction(joint, at, friction, *curves)
            if gained < _GAIN:
                break
        else:
            damping *= 5.0
            if damping > 1e6:
                break
    return _Fitted(friction, *curves, slope)
