"""Whether a fitted cause can be one: within physical limits, and by its mean, not its error."""

from collections.abc import Sequence
from dataclasses import replace

from scipy.linalg import cho_factor, cho_solve

from bladeroot.diagnosis import guards
from bladeroot.diagnosis.channel import Channel
from bladeroot.diagnosis.gaussian import Fit
from bladeroot.mechanisms.mechanism import Mechanism


def sizes(mechanism: Mechanism, fitted: Fit, first: int) -> list[tuple[float, float]]:
    """Value and standard deviation of each parameter; `first` is its place in the fit."""
    own = slice(first, first + len(mechanism.parameters))
    values, chain = mechanism.values(fitted.parameters[own])
    return list(zip(values.tolist(), (chain * fitted.std[own]).tolist(), strict=True))


def plausible(mechanism: Mechanism, fitted: Fit, first: int) -> bool:
    """Whether its parameters, from place `first` of the fit on, are within physical limits."""
    return all(
        p.low - guards.IMPLAUSIBLE * std <= value <= p.high + guards.IMPLAUSIBLE * std
        for p, (value, std) in zip(
            mechanism.parameters, sizes(mechanism, fitted, first), strict=True
        )
    )


def possible(channel: Channel, chosen: Sequence[Mechanism], fitted: Fit) -> bool:
    """Whether all causes of a fit are plausible, the earlier ones too."""
    first = channel.base
    for one in chosen:
        if not plausible(one, fitted, first):
            return False
        first += len(one.parameters)
    return True


def explained_by_law(current: Fit, fitted: Fit) -> float:
    """Nats of misfit and prior that the last cause of a fit takes away by its mean alone.

    The error that its own law is allowed is left out: as a mere model of noise it explains nothing.
    """
    effects = fitted.state.facts["effects"].copy()
    effects[-1] = 0.0
    strict = replace(fitted.state, facts={**fitted.state.facts, "effects": effects})
    covariance, _ = fitted.problem.covariance(strict, fitted.scales)
    factor = cho_factor(covariance)

    def cost(at: Fit) -> float:
        miss = at.problem.data - at.state.mean
        off = (at.parameters - at.problem.prior.mean) / at.problem.prior.std
        return 0.5 * float(miss @ cho_solve(factor, miss) + off @ off)

    return cost(current) - cost(fitted)
