"""Fits of models whose errors are Gaussian with an unknown covariance, and what they predict.

Parameters and ln of scales of a problem are found together, by Newton's method with expected
curvature. The evidence is Laplace's.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import lapack

from bladeroot.inference.problem import Prior, Problem, Slopes, State

_STEPS, _HALVINGS = 60, 5
# Maxima lie so many of their standard deviations apart; those of so many nats less do not count.
_APART, _AS_GOOD = 1.0, 7.0
_FIRST_STEPS, _LEFT = (2, 4), 3  # from each of several starts, and how many of these go on at least
_NO_GAIN = 3e-3  # nats a step
# Nats that a step which fails must have promised to be tried shorter: the covariance, whose slope
# steps do not know, has its own say in the rest.
_PROMISED = 0.05
_SETTLED = 1e-2  # prior's standard deviations, and of a scale's coordinate
_LONGEST = 1.5  # of a step of a scale's coordinate
_SMALL = 0.02  # such a step is taken without asking whether it gains
_FIRST_GAIN = 0.1  # nats, of a first step at fixed scales that is still worth another
_FARTHEST = 8.0  # prior's standard deviations that a step goes at most
# Parts of what a step promised, beyond and below which the next goes so many times farther, or half
# as far; that part after one that fails; and how near to its length a step is held.
_GOOD, _LONGER, _POOR, _HALF, _SHORTER, _WITHIN = 0.75, 2.0, 0.25, 0.5, 0.25, 0.9
_SECULAR = 8  # rounds to that length
# Turns that go the same way (cosine), each at least such a part of the one before, go on as a
# geometric series; so many times the last at most.
_SAME_WAY, _SERIES, _AHEAD = 0.9, 0.3, 20.0
_ROUNDING = 1e-14  # of a curvature
_RISE = 1e-9  # nats, that rounding may add to the cost


@dataclass(frozen=True)
class Fit:
    """The MAP estimate of parameters and scales, and the data's covariance there.

    residual: data less the prior's mean, by the model made straight. precision: inverse of the
    covariance of `residual`, with the parameters' prior in it. covariance, scales_covariance:
    Laplace's. log_evidence: Laplace's, of the data with parameters and scales integrated out.
    """

    problem: Problem
    parameters: Float[ndarray, " parameter"]
    scales: Float[ndarray, " scale"]
    state: State
    residual: Float[ndarray, " datum"]
    precision: Float[ndarray, "datum datum"]
    covariance: Float[ndarray, "parameter parameter"]
    scales_covariance: Float[ndarray, "scale scale"]
    log_evidence: float

    @property
    def std(self) -> Float[ndarray, " parameter"]:
        """Standard deviations of the parameters."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class _Descent:
    """Of the cost by the parameters: pull, minus the gradient, and curve, the curvature.

    unit: of each parameter's step.
    """

    pull: Float[ndarray, " parameter"]
    curve: Float[ndarray, "parameter parameter"]
    unit: Float[ndarray, " parameter"]

    @cached_property
    def principal(self) -> tuple[ndarray, ndarray]:
        """Eigenvalues and vectors of the curvature in its steps' units."""
        value, vector = np.linalg.eigh(self.curve * np.outer(self.unit, self.unit))
        return np.maximum(value, _ROUNDING * value[-1:]), vector


@dataclass(frozen=True)
class _Point:
    """A candidate of the search: its objective, and Cholesky's factor of its covariance."""

    problem: Problem
    parameters: ndarray
    scales: ndarray
    state: State
    cost: float
    factor: ndarray
    slopes: Slopes

    @property
    def log_det(self) -> float:
        """ln of the covariance's determinant."""
        return 2.0 * float(np.log(np.diag(self.factor)).sum())

    @cached_property
    def inverse(self) -> ndarray:
        """Of the covariance."""
        # nothing above the diagonal
        half, _ = _of_blocks(lapack.dpotri, self.factor, self.problem.blocks)
        whole = half + half.T
        whole[np.diag_indices_from(whole)] *= 0.5
        return whole

    @cached_property
    def information(self) -> ndarray:
        """Expected, of the parameters with their prior."""
        slope = self.whitened(self.state.slope)
        return slope.T @ slope + np.diag(1.0 / self.problem.prior.std**2)

    @cached_property
    def marginal(self) -> float:
        """Minus the scales' likelihood, with the parameters integrated out."""
        if not np.isfinite(self.cost):
            return np.inf
        return self.cost + 0.5 * float(np.linalg.slogdet(self.information)[1])

    @cached_property
    def descent(self) -> _Descent:
        """With C_j the covariance's derivative by parameter j and w what is left over the
        covariance, the misfit's gradient has w C_j w, and its curvature is that of the slope plus
        C_j w.

        Where steps see how the covariance turns, their unit is the prior's standard deviation: what
        is known well moves freely, what is known badly as far as the model is straight. Elsewhere
        it is that of the data.
        """
        prior, bent = self.problem.prior, self.state.slope
        weight, weighted = 1.0 / prior.std**2, self.over(self.problem.data - self.state.mean)
        pull = bent.T @ weighted - weight * (self.parameters - prior.mean)
        if self.state.turns is not None:
            turned, traces = self.state.turns(self.scales, weighted, self.inverse)
            pull = pull + 0.5 * (weighted @ turned - traces)
            bent = bent + turned
        white = self.whitened(bent)
        curve = white.T @ white + np.diag(weight)
        unit = 1.0 / np.sqrt(np.diag(curve)) if self.state.turns is None else prior.std
        return _Descent(pull, curve, unit)

    def over(self, values: ndarray) -> ndarray:
        """Values over the covariance."""
        return lapack.dpotrs(self.factor, values, lower=1)[0]

    def whitened(self, columns: ndarray) -> ndarray:
        """Columns over the covariance's root."""
        return lapack.dtrtrs(self.factor, columns, lower=1)[0]


def _of_blocks(
    routine: Callable, matrix: ndarray, blocks: Sequence[slice]
) -> tuple[Float[ndarray, "datum datum"], bool]:
    """A routine of LAPACK's for a lower triangle, block by block, and whether it failed."""
    made, bad = np.zeros(matrix.shape, order="F"), False
    for one in blocks:
        made[one, one], failed = routine(matrix[one, one], lower=1)
        bad = bad or failed > 0
    return made, bad


def _point(
    problem: Problem, parameters: ndarray, scales: ndarray, state: State | None = None
) -> _Point:
    """Cost: half the misfit, the covariance's logarithm and both priors."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        state = problem.predict(parameters) if state is None else state
        own, slopes = problem.covariance(state, scales)
        miss = problem.data - state.mean
        # A sum is not finite where a number is not, and cheaper to ask.
        whole = own.sum() + miss.sum()
    if not (state.inside and np.isfinite(whole)):
        return _Point(problem, parameters, scales, state, np.inf, own, slopes)
    factor, bad = _of_blocks(lapack.dpotrf, own, problem.blocks)
    at = _Point(problem, parameters, scales, state, np.inf, factor, slopes)
    if bad:
        return at
    white = at.whitened(miss)
    off = (parameters - problem.prior.mean) / problem.prior.std
    wide = (scales - problem.scales.mean) / problem.scales.std
    cost = 0.5 * (white @ white + at.log_det + off @ off + wide @ wide)
    if problem.repeats is not None:
        cost += problem.repeats.cost(state, scales)
    return replace(at, cost=float(cost))


def _step(at: _Point, farthest: float) -> tuple[ndarray, float]:
    """Newton's step within a distance in its units (More and Sorensen 1983), and what it should
    gain.
    """
    by, wide = at.descent, at.problem.prior.std
    value, vector = by.principal
    pull, held = vector.T @ (by.unit * by.pull), 0.0
    for _ in range(_SECULAR):
        step = pull / (value + held)
        size = float(np.sqrt(step @ step))
        if size <= farthest / _WITHIN and (held == 0.0 or size >= farthest * _WITHIN):
            break
        slope = float(step @ (step / (value + held))) / size**2
        held = max(held + (size / farthest - 1.0) / slope, 0.0)
    whole = by.unit * (vector @ step)
    part = 1.0 / max(1.0, np.abs(whole / wide).max(initial=0.0) / _FARTHEST)
    gain = part * (step @ pull) - 0.5 * part**2 * (step**2 @ value)
    return part * whole, float(gain)


def _solved(curve: ndarray, pull: ndarray) -> ndarray:
    """Solution with a positive definite matrix, however unlike its coordinates' units are."""
    unit = np.sqrt(np.diag(curve))
    even = curve / np.outer(unit, unit) + _ROUNDING * np.eye(unit.size)
    return (np.linalg.solve(even, (pull.T / unit).T).T / unit).T


def _rescaled(at: _Point) -> _Point:
    """The point after one step of the scales by their marginal likelihood.

    The parameters' own freedom is taken off (restricted likelihood, parameters with their prior);
    the step is halved until the likelihood does not fall.
    """
    if not at.scales.size:
        return at
    problem, before = at.problem, at.marginal
    whole, slopes = _precision(at), at.slopes()
    pulled = whole @ _straight(at)
    parts = [_times(whole, part) for part in slopes]
    gradient = np.array(
        [
            0.5 * (_times(pulled, part) @ pulled - np.trace(product))
            for part, product in zip(slopes, parts, strict=True)
        ]
    )
    weight = 1.0 / problem.scales.std**2
    gradient -= weight * (at.scales - problem.scales.mean)
    if problem.repeats is not None:
        gradient += problem.repeats.pull(at.state, at.scales)[0]
    step = np.linalg.solve(_curvature(at, parts), gradient)
    # A variance v that is too large wants ln(wanted / v) / 2, of which Newton sees the first term.
    step = 0.5 * np.log(np.maximum(1.0 + 2.0 * step, 1e-9))
    step = np.clip(step, -_LONGEST, _LONGEST)
    for _ in range(_HALVINGS):
        new = _point(problem, at.parameters, at.scales + step, at.state)
        if np.abs(step).max() < _SMALL or new.marginal <= before:
            return new
        step = 0.5 * step
    return at


def _curvature(at: _Point, parts: Sequence[ndarray]) -> ndarray:
    """Expected curvature of the scales' likelihood and prior; `parts` are precision times slope."""
    turned = [np.ascontiguousarray(part.T).ravel() for part in parts]
    products = [[0.5 * (one.ravel() @ two) for two in turned] for one in parts]
    whole, repeats = np.diag(1.0 / at.problem.scales.std**2), at.problem.repeats
    if repeats is not None:
        whole = whole + repeats.pull(at.state, at.scales)[1]
    return whole + np.array(products).reshape(len(parts), len(parts))


def _times(left: ndarray, part: ndarray) -> ndarray:
    """A matrix or vector times a covariance's derivative."""
    return left * part if part.ndim == 1 else left @ part


def _straight(at: _Point) -> ndarray:
    """Data less the prior's mean, by the model made straight."""
    own = at.state.slope @ (at.parameters - at.problem.prior.mean)
    return at.problem.data - at.state.mean + own


def _precision(at: _Point) -> ndarray:
    """Inverse of the covariance with the parameters' prior in it."""
    inverse = at.inverse
    slope, weighted = at.state.slope, inverse @ at.state.slope
    curve = slope.T @ weighted + np.diag(1.0 / at.problem.prior.std**2)
    return inverse - weighted @ _solved(curve, weighted.T)


def fit(
    problem: Problem,
    start: ndarray | None = None,
    scales: ndarray | None = None,
    least: float = _NO_GAIN,
) -> Fit:
    """The MAP estimate from one start (the prior's means where none is given).

    least: nats; the search ends with a step that gains less.
    """
    return best_fit(problem, [problem.prior.mean if start is None else start], scales, least)


def best_fit(
    problem: Problem,
    starts: Sequence[ndarray],
    scales: ndarray | None = None,
    least: float = _NO_GAIN,
) -> Fit:
    """The fit from the start that is best after a few steps at fixed scales, which those that are
    far behind after the first do not make.
    """
    scales = problem.scales.mean if scales is None else np.asarray(scales, float)
    points = [_point(problem, np.asarray(start, float), scales) for start in starts]
    for steps in _FIRST_STEPS if len(points) > 1 else ():
        points = [_iterated(point, steps, free=False) for point in points]
        points = sorted(points, key=lambda point: point.cost)[: max(_LEFT, len(points) // 3)]
    at = min(points, key=lambda point: point.cost)
    return _finish(_iterated(at, _STEPS, least=least))


def about(prior: Prior, count: int) -> list[ndarray]:
    """Starts beside the prior's mean: its standard deviation up and down along each of the first
    `count` parameters.
    """
    steps = np.diag(prior.std)[:count]
    return [*(prior.mean + steps), *(prior.mean - steps)]


def maxima_of(fits: Sequence[Fit], count: int) -> list[Fit]:
    """Fits at the posterior's several maxima, the best first, by the first `count` parameters;
    none that is far less probable than the best.
    """
    found: list[Fit] = []
    for one in sorted(fits, key=lambda one: -one.log_evidence):
        off = [np.abs(one.parameters - other.parameters)[:count] for other in found]
        new = all((away > _APART * one.std[:count]).any() for away in off)
        if new and (not found or one.log_evidence > found[0].log_evidence - _AS_GOOD):
            found.append(one)
    return found


def cost(problem: Problem, parameters: ndarray, scales: ndarray | None = None) -> float:
    """Minus the log posterior at a point, but for a constant; infinite where there is none."""
    scales = problem.scales.mean if scales is None else scales
    return _point(problem, np.asarray(parameters, float), scales).cost


def information(problem: Problem, parameters: ndarray, scales: ndarray) -> ndarray:
    """Expected information of the parameters at a point, with their prior."""
    return _point(problem, parameters, scales).information


def _iterated(at: _Point, steps: int, free: bool = True, least: float = _NO_GAIN) -> _Point:
    """Newton's steps of the parameters, and of the scales in turn if they are free.

    The two have goals of their own, so that what one gains the other may lose in the end; with free
    scales the search ends where the marginal likelihood gains no more.
    """
    if not np.isfinite(at.cost):
        return at
    problem, wide = at.problem, at.problem.prior.std
    farthest = _FARTHEST if at.state.turns is not None else np.inf
    before = None
    for _ in range(steps):
        step, expected = _step(at, farthest)
        size = float(np.linalg.norm(step / at.descent.unit))
        new = _point(problem, at.parameters + step, at.scales)
        gain = at.cost - new.cost
        if gain < -_RISE and expected > _PROMISED:
            farthest = _SHORTER * min(size, farthest)
            continue
        if gain < -_RISE:
            new, gain = at, 0.0
        elif gain > _GOOD * expected:
            farthest = max(farthest, _LONGER * size)
        elif gain < _POOR * expected:
            farthest = _HALF * size
        moved = np.abs((new.parameters - at.parameters) / wide).max(initial=0.0)
        settled = gain < _FIRST_GAIN
        if free:
            stepped, new = new, _rescaled(new)
            moved = max(moved, float(np.abs(new.scales - at.scales).max(initial=0.0)))
            settled = at.marginal - new.marginal < least and expected < _FIRST_GAIN
            new = min(stepped, new, key=lambda one: one.marginal) if settled else new
        if settled or (gain < _PROMISED and moved < _SETTLED * np.sqrt(least / _NO_GAIN)):
            at = new
            break
        before, at = at, _ahead(before, at, new) if free and before is not None else new
    if not free:
        return at
    # The parameters' maximum is that at the scales as they are in the end.
    last = _point(problem, at.parameters + _step(at, np.inf)[0], at.scales)
    return min(at, last, key=lambda one: one.cost)


def _ahead(first: _Point, second: _Point, third: _Point) -> _Point:
    """Where points go on to, if that is better than the last: parameters and scales that mean the
    same creep along a ridge in turns (Aitken's extrapolation).
    """
    steps = [
        np.concatenate([(b.parameters - a.parameters) / a.problem.prior.std, b.scales - a.scales])
        for a, b in ((first, second), (second, third))
    ]
    along, (short, long) = steps[0] @ steps[1], (float(step @ step) for step in steps)
    if not (along > _SAME_WAY * np.sqrt(short * long) and _SERIES < along / short < 1.0):
        return third
    part = along / short
    far = min(part / (1.0 - part), _AHEAD)
    parameters = third.parameters + far * (third.parameters - second.parameters)
    new = _point(third.problem, parameters, third.scales + far * (third.scales - second.scales))
    return min(third, new, key=lambda one: one.marginal)


def _finish(at: _Point) -> Fit:
    """The fit at a point: covariances, and the evidence by Laplace's integral.

    No evidence at all (-inf) where the model has no finite likelihood from any start.
    """
    problem, precision, curve = at.problem, _precision(at), at.information
    covariance = _solved(curve, np.eye(len(curve)))
    curvature = _curvature(at, [_times(precision, part) for part in at.slopes()])
    straight = _straight(at)
    log = -at.marginal
    if np.isfinite(log):
        log -= 0.5 * (straight.size * np.log(2.0 * np.pi) + np.linalg.slogdet(curvature)[1])
    log -= float(np.log(problem.prior.std).sum() + np.log(problem.scales.std).sum())
    return Fit(
        problem, at.parameters, at.scales, at.state, straight, precision, covariance,
        np.linalg.inv(curvature), float(log),
    )  # fmt: skip
