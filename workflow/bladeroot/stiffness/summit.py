"""The largest value of the joint posterior, its curvature there, and which law to take."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.stiffness.posterior import Local, Problem, local, log_posterior

_STEPS = 300
_ODDS = np.log(20.0)  # by which a law must be less probable to be dropped
_STARTS = (-0.7, 0.0, 0.7)  # of ln kn and ln kt, in standard deviations of their priors


@dataclass(frozen=True)
class Summit:
    """The mode u of a posterior in units of the prior's std; Laplace's covariance and evidence.

    log_evidence: of the data under the law, its parameters integrated out.
    """

    problem: Problem
    u: Float[ndarray, " parameter"]
    value: float
    covariance: Float[ndarray, "parameter parameter"]
    log_evidence: float

    @property
    def theta(self) -> Float[ndarray, " parameter"]:
        """The mode in the parameters' own units."""
        return self.problem.mean + self.problem.std * self.u

    @property
    def theta_covariance(self) -> Float[ndarray, "parameter parameter"]:
        """Covariance in the parameters' own units."""
        return self.covariance * np.outer(self.problem.std, self.problem.std)


def climb(
    problem: Problem,
    start: Float[ndarray, " parameter"],
    held: Bool[ndarray, " parameter"] | None = None,
) -> tuple[Float[ndarray, " parameter"], Local]:
    """Gauss-Newton, damped so that each step gains; parameters that are `held` stay."""
    free = np.ones(len(start), bool) if held is None else ~held
    u, here, damping = start.copy(), local(problem, start), 1e-2
    for _ in range(_STEPS):
        inner = here.information[np.ix_(free, free)]
        step = np.zeros_like(u)
        step[free] = np.linalg.solve(inner + damping * np.diag(np.diag(inner)), here.gradient[free])
        step *= min(1.0, 1.0 / max(np.abs(step).max(), 1e-300))
        value = log_posterior(problem, (u + step)[None])[0]
        if np.isfinite(value) and value >= here.value:
            gained = value - here.value
            u, here, damping = u + step, local(problem, u + step), max(damping / 5.0, 1e-9)
            if gained < 1e-8 and np.abs(step).max() < 1e-4:
                break
        else:
            damping *= 4.0
            if damping > 1e9:
                break
    return u, here


def find_summit(problem: Problem, starts: tuple[float, ...] = _STARTS) -> Summit:
    """The highest summit that is reached from several stiffnesses.

    starts: of ln kn and of ln kt, in standard deviations of their priors. Raises ValueError if no
    start lies in the model's box.
    """
    best = None
    for kn in starts:
        for kt in starts:
            u = np.zeros(len(problem.names))
            u[:2] = kn, kt
            if not np.isfinite(log_posterior(problem, u[None])[0]):
                continue
            u, here = climb(problem, u)
            if best is None or here.value > best[1].value:
                best = u, here
    if best is None:
        raise ValueError(
            "the measured forces and the prior of kn, kt lie outside the parametric model: "
            "widen parametric.stiffness_GN_per_m or parametric.force_kN"
        )
    u, here = best
    covariance = np.linalg.inv(_curvature(problem, u, here))
    evidence = here.value + 0.5 * (len(u) * np.log(2.0 * np.pi) + np.linalg.slogdet(covariance)[1])
    return Summit(problem, u, here.value, covariance, float(evidence))


def freest(summits: Mapping[str, Summit]) -> str:
    """The law with most parameters among those that the evidence does not drop.

    kn and kt that are tied together by too poor a law look better known than they are, and such a
    law often has most evidence; one twenty times less probable than the best is dropped.
    """
    best = max(summit.log_evidence for summit in summits.values())
    kept = {name: s for name, s in summits.items() if s.log_evidence > best - _ODDS}
    return max(
        kept, key=lambda name: (len(kept[name].problem.law.parameters), kept[name].log_evidence)
    )


def _curvature(problem: Problem, u: ndarray, here: Local) -> Float[ndarray, "parameter parameter"]:
    """Minus the Hessian, by differences of the gradient; Fisher's where it is no summit."""
    h = 1e-4
    rows = [
        (local(problem, u - h * e).gradient - local(problem, u + h * e).gradient) / (2.0 * h)
        for e in np.eye(len(u))
    ]
    exact = 0.5 * (np.array(rows) + np.array(rows).T)
    return exact if np.linalg.eigvalsh(exact)[0] > 1e-2 else here.information
