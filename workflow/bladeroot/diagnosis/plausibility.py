"""Whether a fitted cause can be one: within physical limits, and by its mean, not its error."""

from collections.abc import Sequence
from dataclasses import replace
from math import erf, log, sqrt

import numpy as np
from numpy import ndarray
from scipy.linalg import cho_factor, cho_solve

from bladeroot.diagnosis import guards
from bladeroot.diagnosis.causes import places
from bladeroot.diagnosis.channel import Channel
from bladeroot.diagnosis.shortfall import NAMES
from bladeroot.inference.gaussian import Fit
from bladeroot.mechanisms.mechanism import Mechanism


def sizes(mechanism: Mechanism, fitted: Fit, own: slice) -> list[tuple[float, float]]:
    """Value and standard deviation of each parameter; `own` is their place in the fit."""
    values, chain = mechanism.values(fitted.parameters[own])
    return list(zip(values.tolist(), (chain * fitted.std[own]).tolist(), strict=True))


def by_effect(mechanism: Mechanism, fitted: Fit, own: slice, cause: int) -> np.ndarray:
    """What each parameter of a cause, number `cause` of the fit, loses were its effect twice as
    large at the same parameters: all else is fitted again (the model made straight).
    """
    covariance, _ = fitted.problem.covariance(fitted.state, fitted.scales)
    pull = fitted.state.slope.T @ np.linalg.solve(covariance, fitted.state.facts["effects"][cause])
    _, chain = mechanism.values(fitted.parameters[own])
    return chain * (fitted.covariance @ pull)[own]


def plausible(mechanism: Mechanism, fitted: Fit, own: slice) -> bool:
    """Whether its parameters, at place `own` of the fit, are within physical limits."""
    return all(
        p.low - guards.IMPLAUSIBLE * std <= value <= p.high + guards.IMPLAUSIBLE * std
        for p, (value, std) in zip(mechanism.parameters, sizes(mechanism, fitted, own), strict=True)
    )


def possible(channel: Channel, chosen: Sequence[Mechanism], fitted: Fit) -> bool:
    """Whether all causes of a fit are plausible, the earlier ones too."""
    pairs = zip(chosen, places(chosen, channel.base), strict=True)
    return all(plausible(one, fitted, own) for one, own in pairs)


def changes(found, number: int, own: slice) -> list[dict]:
    """The largest change that a cause makes of each quantity of its data, with its error.

    In ln of the frequency or of the loss factor of the stuck joint, and over amplitude the rise of
    the loss factor itself; of `bladeroot.diagnosis.naming.Found` and the number of a cause of it.
    What all forms of a mechanism share: what it changes, not by which law.
    """
    fitted, quantities, rows = found.final, NAMES[found.channel.name], []
    effects = fitted.state.facts["effects"][number].reshape(len(quantities), -1)
    slopes = fitted.state.slope[:, own].reshape(*effects.shape, -1)
    for quantity, effect, slope in zip(quantities, effects, slopes, strict=True):
        k = int(np.argmax(np.abs(effect)))
        std = float(np.sqrt(slope[k] @ fitted.covariance[own, own] @ slope[k]))
        rows.append({"quantity": quantity, "value": float(effect[k]), "std": std, "unit": "1"})
    return rows


def surely_there(channel: Channel, chosen: Sequence[Mechanism], fitted: Fit) -> bool:
    """Whether each cause is `guards.SIGMAS` standard deviations or more from none.

    By what it changes, and by its first parameter where that may be zero: at the kn and kt of the
    fit, whose error scales the parameter and makes it no nearer to nothing; whatever the other
    causes may be.
    """
    base = channel.base
    causes = np.linalg.inv(np.linalg.inv(fitted.covariance)[base:, base:])
    for number, (one, own) in enumerate(zip(chosen, places(chosen), strict=True)):
        effect = fitted.state.facts["effects"][number]
        k = int(np.argmax(np.abs(effect)))
        slope = fitted.state.slope[k, base:][own]
        if abs(effect[k]) < guards.SIGMAS * np.sqrt(slope @ causes[own, own] @ slope):
            return False
        main, size = one.parameters[0], fitted.parameters[base + own.start]
        near = abs(size) < guards.SIGMAS * np.sqrt(causes[own.start, own.start])
        if near and not (main.log or main.bounded):
            return False
    return True


def law_misfit(channel: Channel, fitted: Fit) -> float:
    """Probability that the laws of a fit miss more than laws do: then they are none of these.

    By their own error, the last of a fit's scales (`stick_model.LAWS`); not over amplitude, where
    laws that are right miss as much as others.
    """
    if channel.name == "curve" or not len(fitted.state.facts["effects"]):
        return 0.0
    error, std = fitted.scales[-1], sqrt(fitted.scales_covariance[-1, -1])
    more = (error - log(guards.LAW_MISFIT)) / std
    return min(0.5 + 0.5 * erf(float(more) / sqrt(2.0)), 1.0 - 1e-9)


def explained_by_law(current: Fit, fitted: Fit) -> float:
    """Nats of misfit and prior that the last cause of a fit takes away by its mean alone.

    The error that its own law is allowed is left out: as a mere model of noise it explains nothing.
    The mean counts at the part of its size that explains most, as its error scales it, too. What
    else is free is fitted again beside it (the model made straight), for that error has had its
    part of what the rest can explain.
    """
    effects = fitted.state.facts["effects"].copy()
    own = effects[-1].copy()
    effects[-1] = 0.0
    strict = replace(fitted.state, facts={**fitted.state.facts, "effects": effects})
    covariance, _ = fitted.problem.covariance(strict, fitted.scales)
    rest = current.parameters.size

    def left(at: Fit) -> tuple[ndarray, tuple[ndarray, bool], ndarray]:
        prior = at.problem.prior
        off = at.parameters - prior.mean
        miss = at.problem.data - at.state.mean + at.state.slope[:, :rest] @ off[:rest]
        free = at.state.slope[:, :rest] * prior.std[:rest]
        return miss, cho_factor(covariance + free @ free.T), off[rest:] / prior.std[rest:]

    before, whole, _ = left(current)
    cost = before @ cho_solve(whole, before)
    miss, whole, off = left(fitted)
    known = cho_solve(whole, own)
    miss = miss + own * (1.0 - np.clip(known @ (miss + own) / max(known @ own, 1e-300), 0.0, 1.0))
    return 0.5 * float(cost - miss @ cho_solve(whole, miss) - off @ off)
