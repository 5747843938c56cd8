"""Draws from a Gaussian model's posterior, weighted by what the posterior is not normal.

Along a few parameters (and the scales) the posterior bends; given them, the rest is nearly normal
about a point that two Gauss-Newton steps reach. So a mixture that learns from its own draws
proposes the few, the normal distribution about that point the rest, and weights correct for both.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import block_diag
from scipy.special import gammaln, logsumexp

from bladeroot.inference.gaussian import Fit
from bladeroot.inference.problem import Problem, State

# How many draws are made.
DRAWS = 4000  # that are handed out, unless the caller says otherwise
# Drawing ends at the first of these. Of 2,000 effective draws the quantiles of 68 % move by 0.03 of
# a standard deviation from seed to seed.
_WANTED_PART = 0.5  # ratio of effective draws to those that are handed out
_MOST_DRAWN = 6  # ratio of weighted draws to those that are handed out
_ROUND_DRAWS = 500  # that are made at once, between two updates of the proposal; for memory, too
# The proposal, a mixture of multivariate t distributions, which learns from the weighted draws.
_WIDENING = 1.3  # of the standard deviations by Laplace's approximation, in the first proposal
_PRIOR_SHARE = 0.25  # of the first proposal: Laplace's approximation knows one peak alone
_MIXTURE_PARTS = 3  # once it has learnt
_TAIL_FREEDOM = 5.0  # degrees of freedom: tails heavier than the posterior's
_FEWEST_EFFECTIVE = 60  # draws to learn from; with fewer, weights are evened out for that
_PLACE_WEIGHT = 1e-9  # of a part's former mean among the draws: without draws it stays there
# The other parameters, given those along which the posterior bends.
_NEWTON_STEPS = 2  # of Gauss-Newton, to their most probable values


@dataclass(frozen=True)
class Draws:
    """Equally weighted draws of parameters and scales.

    effective: how many independent draws the weighted ones are worth, (sum w)^2 / sum w^2.
    """

    parameters: Float[ndarray, "draw parameter"]
    scales: Float[ndarray, "draw scale"]
    effective: float


def sample(
    fit: Fit,
    bent: Sequence[int],
    draws: int = DRAWS,
    seed: int = 5041,
    others: Sequence[Fit] = (),
) -> Draws:
    """Draws by adaptive importance sampling from Laplace's approximation; the same for a seed.

    bent: indices of the parameters along which the posterior bends. others: fits at further maxima
    of it. ValueError where no draw has a finite posterior.
    """
    rng, bent = np.random.default_rng(seed), np.asarray(bent)
    proposals = [_first([fit, *others], bent)]
    found, log, densities = [], np.zeros(0), []
    while len(log) < _MOST_DRAWN * draws:
        found.append(_proposed(fit, bent, proposals[-1], rng))
        points, parameters, target = (np.concatenate(part) for part in zip(*found, strict=True))
        densities = [  # earlier proposals lack only the new points'
            np.append(known, one.log_density(points[len(log) :]))
            for known, one in zip(densities, proposals[:-1], strict=True)
        ]
        densities.append(proposals[-1].log_density(points))
        log = target - logsumexp(densities, axis=0)
        if _effective(log) >= _WANTED_PART * draws:
            break
        proposals.append(proposals[-1].learnt(points, _weights(_evened(log))))
    weight = _weights(log)
    steps = (np.arange(draws) + rng.uniform()) / draws
    chosen = np.minimum(np.searchsorted(np.cumsum(weight), steps), len(weight) - 1)
    chosen = rng.permutation(chosen)
    return Draws(parameters[chosen], points[chosen, len(bent) :], _effective(log))


def _first(fits: Sequence[Fit], bent: ndarray) -> "_Mixture":
    """The first mixture: Laplace's approximations of the fits, widened, and the prior."""
    prior, scales = fits[0].problem.prior, fits[0].problem.scales
    means = [[*one.parameters[bent], *one.scales] for one in fits]
    spreads = [
        _WIDENING**2 * block_diag(one.covariance[np.ix_(bent, bent)], one.scales_covariance)
        for one in fits
    ]
    before = np.diag(np.concatenate([prior.std[bent], scales.std]) ** 2)
    share = [*[(1.0 - _PRIOR_SHARE) / len(fits)] * len(fits), _PRIOR_SHARE]
    means += [[*prior.mean[bent], *scales.mean]]
    return _Mixture(np.array(share), np.array(means), np.stack([*spreads, before]))


def _weights(log: Float[ndarray, " draw"]) -> Float[ndarray, " draw"]:
    """Weights of sum one. ValueError where all are nothing."""
    if not np.isfinite(log).any():
        raise ValueError("no draw has a finite posterior")
    return np.exp(log - logsumexp(log[np.isfinite(log)]))


def _effective(log: Float[ndarray, " draw"]) -> float:
    return float(1.0 / np.sum(_weights(log) ** 2))


def _evened(log: Float[ndarray, " draw"]) -> Float[ndarray, " draw"]:
    """ln of weights, flattened until enough draws are effective."""
    heat = 1.0
    while (
        _effective(log / heat) < _FEWEST_EFFECTIVE
        and np.isfinite(log).sum() > 2 * _FEWEST_EFFECTIVE
    ):
        heat *= 1.5
    return log / heat


def _proposed(
    fit: Fit, bent: ndarray, mixture: "_Mixture", rng: np.random.Generator
) -> tuple[ndarray, ndarray, ndarray]:
    """Points of the mixture, all parameters there, and ln of posterior over the rest's density."""
    points = mixture.draw(_ROUND_DRAWS, rng)
    noise = rng.standard_normal((_ROUND_DRAWS, fit.parameters.size - len(bent)))
    return points, *_completed(fit, bent, points, noise)


def _completed(fit: Fit, bent: ndarray, points: ndarray, noise: ndarray) -> tuple[ndarray, ndarray]:
    """All parameters, the rest drawn given the bent ones; ln of posterior over its density."""
    problem, prior = fit.problem, fit.problem.prior
    count = len(bent)
    rest = np.setdiff1d(np.arange(fit.parameters.size), bent)
    along = np.linalg.solve(fit.covariance[np.ix_(bent, bent)], fit.covariance[np.ix_(bent, rest)])
    theta, scales = np.tile(fit.parameters, (len(points), 1)), points[:, count:]
    theta[:, bent] = points[:, :count]
    theta[:, rest] += (points[:, :count] - fit.parameters[bent]) @ along
    weight = np.diag(prior.std[rest] ** -2.0)
    curve = np.zeros((len(points), 0, 0))
    for _ in range(_NEWTON_STEPS if rest.size else 0):
        here = _seen(problem, theta, scales)
        white = np.linalg.solve(
            here.root, np.concatenate([here.slope[..., rest], here.miss], axis=2)
        )
        slope, miss = white[..., :-1], white[..., -1:]
        turned = slope.transpose(0, 2, 1)
        curve = turned @ slope + weight
        off = (theta[:, rest] - prior.mean[rest]) / prior.std[rest] ** 2
        theta[:, rest] += np.linalg.solve(curve, turned @ miss - off[..., None])[..., 0]
    root = np.linalg.cholesky(curve)
    theta[:, rest] += np.linalg.solve(root.transpose(0, 2, 1), noise[..., None])[..., 0]
    here = _seen(problem, theta, scales)
    repeats = 0.0
    if problem.repeats is not None:
        pairs = zip(here.states, scales, strict=True)
        repeats = np.array([problem.repeats.cost(*one) for one in pairs])
    miss = np.linalg.solve(here.root, here.miss)[..., 0]
    log = -0.5 * ((miss**2).sum(axis=1) - (noise**2).sum(axis=1)) - _log_det(here.root)
    log -= 0.5 * (((theta - prior.mean) / prior.std) ** 2).sum(axis=1) + _log_det(root)
    log -= 0.5 * (((scales - problem.scales.mean) / problem.scales.std) ** 2).sum(axis=1)
    return theta, np.where(here.inside, log - repeats, -np.inf)


@dataclass(frozen=True)
class _Seen:
    """A model at several points. miss: data less mean. root: Cholesky factor of the covariance."""

    states: Sequence[State]
    miss: Float[ndarray, "point datum 1"]
    slope: Float[ndarray, "point datum parameter"]
    root: Float[ndarray, "point datum datum"]
    inside: ndarray


def _seen(problem: Problem, theta: ndarray, scales: ndarray) -> _Seen:
    states = problem.states(theta)
    pairs = zip(states, scales, strict=True)
    whole = np.array([problem.covariance(*one)[0] for one in pairs])
    miss = np.array([problem.data - state.mean for state in states])
    slope = np.array([state.slope for state in states])
    root, good = _roots(whole)
    good &= np.isfinite(miss).all(axis=1) & np.isfinite(slope).all(axis=(1, 2))
    miss[~good], slope[~good] = 0.0, 0.0
    inside = good & np.array([state.inside for state in states])
    return _Seen(states, miss[..., None], slope, root, inside)


def _roots(whole: Float[ndarray, "point datum datum"]) -> tuple[ndarray, ndarray]:
    """Cholesky factors, the identity where there is none, and where there is one."""
    good = np.isfinite(whole).all(axis=(1, 2))
    whole[~good] = np.eye(whole.shape[1])
    try:
        return np.linalg.cholesky(whole), good
    except np.linalg.LinAlgError:
        good &= np.linalg.eigvalsh(whole)[:, 0] > 1e-13 * np.trace(whole, axis1=1, axis2=2)
        whole[~good] = np.eye(whole.shape[1])
        return np.linalg.cholesky(whole), good


def _log_det(root: Float[ndarray, "point datum datum"]) -> Float[ndarray, " point"]:
    return np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1)


@dataclass(frozen=True)
class _Mixture:
    """A mixture of multivariate t distributions."""

    share: Float[ndarray, " part"]
    mean: Float[ndarray, "part coordinate"]
    scale: Float[ndarray, "part coordinate coordinate"]

    def draw(self, count: int, rng: np.random.Generator) -> Float[ndarray, "draw coordinate"]:
        """Draws, of each part its share."""
        part = rng.choice(len(self.share), count, p=self.share)
        root = np.linalg.cholesky(self.scale)[part]
        noise = rng.standard_normal((count, self.mean.shape[1], 1))
        tail_factor = np.sqrt(_TAIL_FREEDOM / rng.chisquare(_TAIL_FREEDOM, count))
        return self.mean[part] + tail_factor[:, None] * (root @ noise)[..., 0]

    def log_parts(self, points: Float[ndarray, "point coordinate"]) -> tuple[ndarray, ndarray]:
        """Log density by each part with its share, and the squared distance from it."""
        n = self.mean.shape[1]
        root = np.linalg.cholesky(self.scale)
        away = points[None] - self.mean[:, None]
        square = (np.linalg.solve(root, away.transpose(0, 2, 1)) ** 2).sum(axis=1)
        constant = gammaln(0.5 * (_TAIL_FREEDOM + n)) - gammaln(0.5 * _TAIL_FREEDOM)
        constant -= 0.5 * n * np.log(_TAIL_FREEDOM * np.pi)
        log = constant + np.log(self.share)[:, None] - _log_det(root)[:, None]
        return log - 0.5 * (_TAIL_FREEDOM + n) * np.log1p(square / _TAIL_FREEDOM), square

    def log_density(self, points: Float[ndarray, "point coordinate"]) -> ndarray:
        """Log density at points."""
        return logsumexp(self.log_parts(points)[0], axis=0)

    def learnt(self, points: ndarray, weight: ndarray) -> "_Mixture":
        """The mixture fitted to weighted draws by expectation maximisation."""
        mixture = self
        if len(self.share) < _MIXTURE_PARTS:  # apart along the longest axis of what was seen
            mean = weight @ points
            spread = (weight[:, None] * (points - mean)).T @ (points - mean)
            spread += 0.05 * self.scale[0]
            unit = np.sqrt(np.diag(spread))
            size, axis = np.linalg.eigh(spread / np.outer(unit, unit))
            along = axis[:, -1] * np.sqrt(size[-1]) * unit
            places = mean + np.linspace(-1.0, 1.0, _MIXTURE_PARTS)[:, None] * along
            share = np.full(_MIXTURE_PARTS, 1.0 / _MIXTURE_PARTS)
            mixture = _Mixture(share, places, np.tile(spread, (_MIXTURE_PARTS, 1, 1)))
        n = points.shape[1]
        for _ in range(5):
            log, square = mixture.log_parts(points)
            member = weight * np.exp(log - logsumexp(log, axis=0))
            share = np.maximum(member.sum(axis=1), 0.02)
            tail = member * (_TAIL_FREEDOM + n) / (_TAIL_FREEDOM + square)
            held = tail.sum(axis=1)[:, None] + _PLACE_WEIGHT
            mean = (tail @ points + _PLACE_WEIGHT * mixture.mean) / held
            away = points[None] - mean[:, None]
            scale = np.einsum("kp,kpi,kpj->kij", tail, away, away) / share[:, None, None]
            scale += 0.05 * mixture.scale  # a part that few draws hold does not shrink to a line
            mixture = _Mixture(share / share.sum(), mean, scale)
        return mixture
