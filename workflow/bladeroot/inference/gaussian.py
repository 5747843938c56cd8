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

# Several starts: all make a few steps at fixed scales, and the best ones go on.
_FIRST_STEPS = (2, 4)  # steps before the first and the second choice among the starts
_FEWEST_LEFT = 3  # starts that a choice leaves at least; a third of them, if that is more
# When a search ends.
_MOST_STEPS = 60  # of parameters and scales in turn
_LEAST_GAIN = 3e-3  # nats of marginal likelihood that a step must gain, unless the caller says else
_WORTHWHILE_GAIN = 0.1  # nats of cost that a step must promise, or gain at fixed scales
# A move that gains less than `_LEAST_PROMISE` and is smaller than this is the last: in the prior's
# standard deviations, and in ln of a scale.
_SETTLED_MOVE = 1e-2
# A step of the parameters is held to a length (a trust region) that follows from how much of the
# promised gain the last one brought; the first step only where a state has `turns`.
_FARTHEST_STEP = 8.0  # prior's standard deviations: the first length, and any parameter's move
_GOOD_STEP = 0.75  # gain over promise, above which the length becomes
_LENGTHENED = 2.0  # times the step just made
_POOR_STEP = 0.25  # gain over promise, below which it becomes
_SHORTENED = 0.5  # times the step just made
_RETRIED = 0.25  # times the step, after one that fails: the cost rises
# A failing step that promised less (nats) is not tried shorter: steps do not know the slope of the
# covariance, which has its own say in so small a change.
_LEAST_PROMISE = 0.05
_LENGTH_TOLERANCE = 0.9  # ratio of a step's length to the wanted one, within this and its inverse
_LENGTH_ROUNDS = 8  # of Newton's method for that length
# A step of ln of the scales.
_LONGEST_SCALE_STEP = 1.5
_UNCHECKED_SCALE_STEP = 0.02  # a shorter one is taken without asking whether it gains
_MOST_HALVINGS = 5  # of a step, until the marginal likelihood does not fall
# A search that creeps along a ridge is extrapolated as a geometric series (`_ahead`).
_CREEP_COSINE = 0.9  # between two successive moves, at least
_CREEP_RATIO = 0.3  # of a move to the one before along it, at least
_CREEP_FARTHEST = 20.0  # times the last move, at most
# Several maxima of a posterior (`maxima_of`).
_MAXIMA_APART = 1.0  # standard deviations of one of the parameters, at least
_MAXIMA_WITHIN = 7.0  # nats of evidence below the best, at most
# Rounding.
_CURVATURE_ROUNDING = 1e-14  # of the largest curvature: the least that is counted
_COST_ROUNDING = 1e-9  # nats that it may add to the cost


@dataclass(frozen=True)
class Fit:
    """The MAP estimate of parameters and scales, and the data's covariance there.

    residual: data less what the model, linear about the estimate, gives at the prior's mean.
    precision: inverse of the covariance of `residual`, which includes the parameters' prior.
    covariance, scales_covariance: by Laplace's approximation. log_evidence: Laplace's, of the data
    with parameters and scales integrated out.
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
class _Point:
    """A point of the search: its cost, and the Cholesky factor of the covariance there."""

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
        """The covariance's inverse."""
        # LAPACK fills the lower triangle alone
        half, _ = _of_blocks(lapack.dpotri, self.factor, self.problem.blocks)
        whole = half + half.T
        whole[np.diag_indices_from(whole)] *= 0.5
        return whole

    @cached_property
    def information(self) -> ndarray:
        """Expected information of the parameters, with their prior."""
        slope = self.whitened(self.state.slope)
        return slope.T @ slope + np.diag(1.0 / self.problem.prior.std**2)

    @cached_property
    def marginal(self) -> float:
        """Minus the scales' likelihood, with the parameters integrated out."""
        if not np.isfinite(self.cost):
            return np.inf
        return self.cost + 0.5 * float(np.linalg.slogdet(self.information)[1])

    @cached_property
    def descent(self) -> tuple[ndarray, ndarray, ndarray, ndarray]:
        """Of the cost by the parameters: the unit in which a step of each is measured, and in these
        units minus the gradient, and eigenvalues and vectors of the expected curvature.

        With C_j the derivative of the covariance C by parameter j, and w = C^-1 times the residual,
        the gradient of the misfit has a term w C_j w, and its curvature is that of the slope plus
        C_j w. Where a state gives these derivatives (`turns`), steps are measured in the prior's
        standard deviations: what is known well moves freely, what is known badly only as far as the
        model is linear. Elsewhere they are measured in the standard deviations by the curvature.
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
        value, vector = np.linalg.eigh(curve * np.outer(unit, unit))
        return unit, unit * pull, np.maximum(value, _CURVATURE_ROUNDING * value[-1:]), vector

    def over(self, values: ndarray) -> ndarray:
        """The covariance's inverse times values."""
        return lapack.dpotrs(self.factor, values, lower=1)[0]

    def whitened(self, columns: ndarray) -> ndarray:
        """The inverse of the covariance's Cholesky factor times columns."""
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
        # A sum is not finite if any number is not, and is quicker to test.
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
    """Newton's step of a bounded length (More and Sorensen 1983), and the gain that it promises.

    farthest: the bound, in the steps' units.
    """
    unit, pull, value, vector = at.descent
    pull, held = vector.T @ pull, 0.0
    for _ in range(_LENGTH_ROUNDS):
        step = pull / (value + held)
        size = float(np.sqrt(step @ step))
        if size <= farthest / _LENGTH_TOLERANCE and (
            held == 0.0 or size >= farthest * _LENGTH_TOLERANCE
        ):
            break
        slope = float(step @ (step / (value + held))) / size**2
        held = max(held + (size / farthest - 1.0) / slope, 0.0)
    whole = unit * (vector @ step)
    part = 1.0 / max(1.0, np.abs(whole / at.problem.prior.std).max(initial=0.0) / _FARTHEST_STEP)
    gain = part * (step @ pull) - 0.5 * part**2 * (step**2 @ value)
    return part * whole, float(gain)


def _solved(curve: ndarray, pull: ndarray) -> ndarray:
    """Solution with a positive definite matrix, scaled for coordinates of unlike units."""
    unit = np.sqrt(np.diag(curve))
    even = curve / np.outer(unit, unit) + _CURVATURE_ROUNDING * np.eye(unit.size)
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
    step = np.clip(step, -_LONGEST_SCALE_STEP, _LONGEST_SCALE_STEP)
    for _ in range(_MOST_HALVINGS):
        new = _point(problem, at.parameters, at.scales + step, at.state)
        if np.abs(step).max() < _UNCHECKED_SCALE_STEP or new.marginal <= before:
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
    """Data less what the model, linear about the point, gives at the prior's mean."""
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
    least: float = _LEAST_GAIN,
) -> Fit:
    """The MAP estimate from one start (the prior's means where none is given).

    least: nats; the search ends with a step that gains less.
    """
    return best_fit(problem, [problem.prior.mean if start is None else start], scales, least)


def best_fit(
    problem: Problem,
    starts: Sequence[ndarray],
    scales: ndarray | None = None,
    least: float = _LEAST_GAIN,
) -> Fit:
    """The fit from the start that is best after a few steps at fixed scales.

    Starts that are far behind after the first of these steps are dropped.
    """
    scales = problem.scales.mean if scales is None else np.asarray(scales, float)
    points = [_point(problem, np.asarray(start, float), scales) for start in starts]
    for steps in _FIRST_STEPS if len(points) > 1 else ():
        points = [_iterated(point, steps, free=False) for point in points]
        points = sorted(points, key=lambda point: point.cost)[: max(_FEWEST_LEFT, len(points) // 3)]
    at = min(points, key=lambda point: point.cost)
    return _finish(_iterated(at, _MOST_STEPS, least=least))


def about(prior: Prior, count: int) -> list[ndarray]:
    """Starts a prior's standard deviation above and below its mean, by each of the first `count`
    parameters in turn.
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
        new = all((away > _MAXIMA_APART * one.std[:count]).any() for away in off)
        if new and (not found or one.log_evidence > found[0].log_evidence - _MAXIMA_WITHIN):
            found.append(one)
    return found


def cost(problem: Problem, parameters: ndarray, scales: ndarray | None = None) -> float:
    """Minus the log posterior at a point, but for a constant; infinite where there is none."""
    scales = problem.scales.mean if scales is None else scales
    return _point(problem, np.asarray(parameters, float), scales).cost


def information(problem: Problem, parameters: ndarray, scales: ndarray) -> ndarray:
    """Expected information of the parameters at a point, with their prior."""
    return _point(problem, parameters, scales).information


def _iterated(at: _Point, steps: int, free: bool = True, least: float = _LEAST_GAIN) -> _Point:
    """Newton's steps of the parameters, and of the scales in turn if they are free.

    Parameters and scales have goals of their own, so that one may lose what the other gains; with
    free scales the search ends where the marginal likelihood gains no more.
    """
    if not np.isfinite(at.cost):
        return at
    problem, wide = at.problem, at.problem.prior.std
    farthest = _FARTHEST_STEP if at.state.turns is not None else np.inf
    before = None
    for _ in range(steps):
        step, expected = _step(at, farthest)
        size = float(np.linalg.norm(step / at.descent[0]))
        new = _point(problem, at.parameters + step, at.scales)
        gain = at.cost - new.cost
        if gain < -_COST_ROUNDING and expected > _LEAST_PROMISE:
            farthest = _RETRIED * min(size, farthest)
            continue
        if gain < -_COST_ROUNDING:
            new, gain = at, 0.0
        elif gain > _GOOD_STEP * expected:
            farthest = max(farthest, _LENGTHENED * size)
        elif gain < _POOR_STEP * expected:
            farthest = _SHORTENED * size
        moved = np.abs((new.parameters - at.parameters) / wide).max(initial=0.0)
        settled = gain < _WORTHWHILE_GAIN
        if free:
            stepped, new = new, _rescaled(new)
            moved = max(moved, float(np.abs(new.scales - at.scales).max(initial=0.0)))
            settled = at.marginal - new.marginal < least and expected < _WORTHWHILE_GAIN
            new = min(stepped, new, key=lambda one: one.marginal) if settled else new
        if settled or (
            gain < _LEAST_PROMISE and moved < _SETTLED_MOVE * np.sqrt(least / _LEAST_GAIN)
        ):
            at = new
            break
        before, at = at, _ahead(before, at, new) if free and before is not None else new
    if not free:
        return at
    # One more step of the parameters, to their maximum at the final scales.
    last = _point(problem, at.parameters + _step(at, np.inf)[0], at.scales)
    return min(at, last, key=lambda one: one.cost)


def _ahead(first: _Point, second: _Point, third: _Point) -> _Point:
    """The point to which three successive ones lead, if it is better than the last of them.

    Parameters and scales that explain the same data creep along a ridge in turns; their moves are
    extrapolated as a geometric series (Aitken).
    """
    steps = [
        np.concatenate([(b.parameters - a.parameters) / a.problem.prior.std, b.scales - a.scales])
        for a, b in ((first, second), (second, third))
    ]
    along, (short, long) = steps[0] @ steps[1], (float(step @ step) for step in steps)
    if not (along > _CREEP_COSINE * np.sqrt(short * long) and _CREEP_RATIO < along / short < 1.0):
        return third
    part = along / short
    far = min(part / (1.0 - part), _CREEP_FARTHEST)
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
