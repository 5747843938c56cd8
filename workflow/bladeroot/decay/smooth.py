"""A smooth curve and its derivatives from noisy values: an adaptive penalised spline.

The curve is a B-spline; the prior on it is that its third derivative is white, with an intensity
that may vary along the record (much at large amplitude, where the joint slips, little on the
stick plateau, a spike where one turns into the other). The intensities are those of highest
restricted likelihood, found by the Fellner-Schall iteration (Wood & Fasiolo 2017). The posterior
gives standard errors which include the smoothing bias on average over the curve (Nychka 1988).

Two passes: one on few knots finds the intensities, a second puts the knots where the curve
bends. The cost does not grow with the number of values but for the sums over them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.linalg import lapack

DEGREE = 5
ORDER = 3
# A region is made no stiffer once it has fewer degrees of freedom: the errors of a stretch that
# looks exactly straight would come out too small.
FEWEST_FREEDOM = 0.25
# The posterior's errors are those of a curve as rough as the prior; most stretches are smoother.
# Found by simulation over sharp and gradual onsets at 40 and 60 dB (benchmarks/decays.py).
CALIBRATION = 0.9


@dataclass(frozen=True)
class Prior:
    """Log-precision of each part's third derivative at node times (in record lengths)."""

    node: Float[ndarray, " node"]
    log_precision: Float[ndarray, "part node"]
    softest: Float[ndarray, "part node"]


@dataclass(frozen=True)
class Spline:
    """Posterior of the curves of all parts: coefficients and their covariance."""

    origin: float
    scale: float
    knots: Float[ndarray, " knot"]
    trend: Float[ndarray, "part 2"]
    coefficient: Float[ndarray, "part coefficient"]
    covariance: Float[ndarray, "part coefficient coefficient"]
    prior: Prior

    def value(self, time: Float[ndarray, " point"]) -> Float[ndarray, "3 part point"]:
        """The curves and their first two derivatives."""
        start, power = self._polynomials
        x = (time - self.origin) / self.scale
        cell = np.clip(np.searchsorted(start, x, side="right") - 1, 0, start.size - 1)
        s = x - start[cell]
        own = power[:, :, cell]
        value = np.zeros((3, self.trend.shape[0], time.size))
        for k in range(DEGREE, -1, -1):
            if k > 1:
                value[2] = value[2] * s + k * (k - 1) * own[k]
            if k > 0:
                value[1] = value[1] * s + k * own[k]
            value[0] = value[0] * s + own[k]
        value[0] += self.trend[:, :1] * x + self.trend[:, 1:]
        value[1] += self.trend[:, :1]
        value[1] /= self.scale
        value[2] /= self.scale**2
        return value

    @cached_property
    def _polynomials(self) -> tuple[ndarray, ndarray]:
        """Where each polynomial piece starts, and its coefficients (power, part, piece)."""
        start = self.knots[DEGREE : -DEGREE - 1]
        width = self.knots[DEGREE + 1 : -DEGREE] - start
        at = np.arange(DEGREE + 1) / DEGREE  # places within a piece, both ends among them
        inside = (start + at[:, None] * width * (1.0 - 1e-12)).ravel()
        shape, first = alive_splines(inside, self.knots, DEGREE)
        alive = self.coefficient[:, first[:, None] + np.arange(DEGREE + 1)]
        value = (alive * shape).sum(axis=2).reshape(-1, DEGREE + 1, start.size)
        power = np.linalg.inv(np.vander(at, increasing=True)) @ value
        return start, power.transpose(1, 0, 2) / width ** np.arange(DEGREE + 1)[:, None, None]

    def std(self, time: Float[ndarray, " point"]) -> Float[ndarray, "3 part point"]:
        """Standard errors of `value`."""
        shape, first = self._shapes((time - self.origin) / self.scale)
        pairs = (shape[..., :, None] * shape[..., None, :]).reshape(3, time.size, -1)
        row = first[:, None] + np.repeat(np.arange(DEGREE + 1), DEGREE + 1)
        column = first[:, None] + np.tile(np.arange(DEGREE + 1), DEGREE + 1)
        error = [(pairs * covariance[row, column]).sum(axis=2) for covariance in self.covariance]
        return CALIBRATION * np.sqrt(np.maximum(np.stack(error, axis=1), 0.0))

    def _shapes(
        self, x: Float[ndarray, " point"]
    ) -> tuple[Float[ndarray, "3 point alive"], Int[ndarray, " point"]]:
        shape = np.zeros((3, x.size, DEGREE + 1))
        for d in range(3):
            value, first = alive_splines(x, self.knots[d : self.knots.size - d], DEGREE - d)
            rows = derivative_rows(self.knots, DEGREE, d)
            for j in range(DEGREE + 1 - d):
                shape[d, :, j : j + d + 1] += value[:, j : j + 1] * rows[first + j]
            shape[d] /= self.scale**d
        return shape, first


def coarse(
    time: Float[ndarray, " value"],
    y: Float[ndarray, "part value"],
    std: Float[ndarray, " value"],
    duration: float,
    prior: Prior | None = None,
    knots: int = 50,
    iterations: int = 4,
) -> Spline:
    """Penalised splines on few knots through independent values that share their errors.

    prior: one to start from, as of an earlier call on the same record, `duration` s long.
    """
    clock = sites(time, y[0], knots)
    prior = prior or _even(time, std, clock, duration, y.shape[0])
    return _fit(time, y, std, duration, clock, prior, iterations)


def fine(
    time: Float[ndarray, " value"],
    y: Float[ndarray, "part value"],
    std: Float[ndarray, " value"],
    before: Spline,
    knots: int = 90,
    iterations: int = 2,
) -> Spline:
    """Penalised splines with knots where an earlier, coarse fit bends."""
    where = _bending(time, std, sites(time, y[0], 50), before, knots)
    return _fit(time, y, std, before.scale, where, before.prior, iterations)


def sites(
    time: Float[ndarray, " value"], level: Float[ndarray, " value"], most: int
) -> Float[ndarray, " site"]:
    """Places for a spline's knots: even in log-amplitude as much as in number of values."""
    lowest = np.minimum.accumulate(level)
    fall = (lowest[0] - lowest) / max(lowest[0] - lowest[-1], 1e-9)
    clock = 0.5 * fall + 0.5 * np.linspace(0.0, 1.0, time.size)
    count = max(min(most, time.size // 2), 4)
    # a stretch that grows has no fall, and its clock would end early
    return np.interp(np.linspace(0.0, clock[-1], count), clock, time)


def alive_splines(
    x: Float[ndarray, " point"], knots: Float[ndarray, " knot"], degree: int
) -> tuple[Float[ndarray, "point alive"], Int[ndarray, " point"]]:
    """The degree + 1 B-splines that are not zero at each point, and the first one's number.

    By the recursion of Cox and de Boor on (already padded) knots; beyond the ends the outermost
    polynomials go on.
    """
    cell = np.searchsorted(knots, x, side="right") - 1
    cell = np.clip(cell, degree, knots.size - degree - 2)
    value = np.zeros((degree + 1, x.size))
    value[0] = 1.0
    left = x - knots[cell - np.arange(degree)[:, None]]
    right = knots[cell + 1 + np.arange(degree)[:, None]] - x
    for d in range(1, degree + 1):
        share = value[:d] / (right[:d] + left[d - 1 :: -1] if d > 1 else right[:1] + left[:1])
        value[1 : d + 1] = share * left[d - 1 :: -1] if d > 1 else share * left[:1]
        value[0] = 0.0
        value[:d] += share * right[:d]
    return np.ascontiguousarray(value.T), cell - degree


def derivative_rows(
    knots: Float[ndarray, " knot"], degree: int, order: int
) -> Float[ndarray, "row alive"]:
    """From a spline's coefficients to those of its derivative: row j weighs j ... j + order."""
    rows = np.ones((knots.size - degree - 1, 1))
    for d in range(degree, degree - order, -1):
        inner = knots[degree - d : knots.size - degree + d]
        width = inner[d + 1 : d + rows.shape[0]] - inner[1 : rows.shape[0]]
        step = np.zeros((rows.shape[0] - 1, rows.shape[1] + 1))
        step[:, 1:] += rows[1:]
        step[:, :-1] -= rows[:-1]
        rows = step * (d / width)[:, None]
    return rows


def _even(
    time: ndarray, std: ndarray, clock: ndarray, duration: float, parts: int, regions: int = 18
) -> Prior:
    """A prior that weighs about as much as the data on the spacing of the clock."""
    regions = min(regions, clock.size)
    node = np.interp(np.linspace(0.0, 1.0, regions), np.linspace(0.0, 1.0, clock.size), clock)
    width = np.gradient(clock / duration)
    at = np.interp(node, clock, width)
    own = 2.0 * np.log(np.interp(node, time, std)) - 5.0 * np.log(at)
    start = np.tile(-own - np.log(0.1), (parts, 1))
    return Prior((node - time[0]) / duration, start, start - 15.0)


def _fit(
    time: ndarray,
    y: ndarray,
    std: ndarray,
    duration: float,
    where: ndarray,
    prior: Prior,
    iterations: int,
) -> Spline:
    """The splines on given knots, after some steps of the intensities' iteration."""
    origin, scale = float(time[0]), duration
    x, inner = (time - origin) / scale, (where - origin) / scale
    knots = np.concatenate([np.full(DEGREE, inner[0]), inner, np.full(DEGREE, inner[-1])])
    count = knots.size - DEGREE - 1
    shape, first = alive_splines(x, knots, DEGREE)
    gram, right, trend = _sums(x, y, std, shape, first, count)
    penalty, centre = _penalty(knots)
    rows = penalty[0].size
    place = np.interp(centre, prior.node, np.arange(prior.node.size))
    tent = np.maximum(0.0, 1.0 - np.abs(place[:, None] - np.arange(prior.node.size)))
    coefficient, covariance = np.empty((y.shape[0], count)), np.empty((y.shape[0], count, count))
    found = np.empty_like(prior.log_precision)
    lower = [(a, b, penalty[a] * penalty[b]) for a in range(ORDER + 1) for b in range(a + 1)]
    for part in range(y.shape[0]):
        log_precision, softest = prior.log_precision[part], prior.softest[part]
        left = iterations
        while True:
            # where it bends is known no better than to a region: the last step spreads that
            own = log_precision if left else _spread(log_precision)
            precision = np.exp(tent @ own)
            matrix = gram.copy()
            for a, b, product in lower:
                matrix.reshape(-1)[a * count + b :: count + 1][:rows] += precision * product
            inverse = _inverse(matrix)
            value = inverse @ right[part]
            if not left:
                break
            variance, bend = np.zeros(rows), np.zeros(rows)
            for a, b, product in lower:
                weight = product if a == b else 2.0 * product
                variance += weight * inverse.reshape(-1)[a * count + b :: count + 1][:rows]
            for a in range(ORDER + 1):
                bend += penalty[a] * value[a : a + rows]
            freedom = np.maximum(1.0 - precision * variance, 0.0) @ tent + 1e-12
            roughness = (precision * bend**2) @ tent
            step = np.log(freedom / np.maximum(roughness, 1e-30))
            # a stretch that is straight already gains nothing by being stiffer
            step = np.where(freedom < FEWEST_FREEDOM, np.minimum(step, 0.0), step)
            step = np.clip(2.0 * step, -4.0, 4.0)
            log_precision = np.clip(log_precision + step, softest, softest + 50.0)
            moving = (np.abs(step) * np.minimum(freedom, 1.0)).max() > 0.2
            left = left - 1 if moving else 0
        coefficient[part], covariance[part], found[part] = value, inverse, log_precision
    return Spline(
        origin, scale, knots, trend, coefficient, covariance,
        Prior(prior.node, found, prior.softest),
    )  # fmt: skip


def _spread(log_precision: Float[ndarray, " node"]) -> Float[ndarray, " node"]:
    """Intensities averaged with a half of each neighbour's."""
    stiffest = log_precision.max()
    intensity = np.pad(np.exp(stiffest - log_precision), 1, mode="edge")
    mean = 0.25 * intensity[:-2] + 0.5 * intensity[1:-1] + 0.25 * intensity[2:]
    return stiffest - np.log(mean)


def _sums(
    x: ndarray, y: ndarray, std: ndarray, shape: ndarray, first: ndarray, count: int
) -> tuple[ndarray, ndarray, ndarray]:
    """Normal equations (lower triangle) of the values less a straight line, and the line."""
    weight = 1.0 / std**2
    total = weight.sum()
    mean, level = weight @ x / total, y @ weight / total
    slope = ((y - level[:, None]) @ (weight * (x - mean))) / (weight @ (x - mean) ** 2)
    trend = np.stack([slope, level - slope * mean], axis=1)
    about = y - slope[:, None] * x - trend[:, 1:]
    starts = np.flatnonzero(np.diff(first, prepend=-1))
    cell = first[starts]
    weighted = shape * weight[:, None]
    row, column = np.tril_indices(DEGREE + 1)
    pairs = np.add.reduceat(weighted[:, row] * shape[:, column], starts, axis=0)
    sums = np.add.reduceat(weighted * about[:, :, None], starts, axis=1)
    gram, right = np.zeros((count, count)), np.zeros((y.shape[0], count))
    for a in range(DEGREE + 1):
        right[:, cell + a] += sums[:, :, a]
    for k, (a, b) in enumerate(zip(row, column, strict=True)):
        gram[cell + a, cell + b] += pairs[:, k]
    return gram, right, trend


def _penalty(
    knots: Float[ndarray, " knot"],
) -> tuple[list[Float[ndarray, " row"]], Float[ndarray, " row"]]:
    """The third derivative's coefficients, of unit variance where it is white; where they lie.

    The weights of the spline's coefficients j ... j + ORDER in row j, one array each.
    """
    rows = derivative_rows(knots, DEGREE, ORDER)
    reach = DEGREE - ORDER + 1
    inside = knots[ORDER : knots.size - ORDER]
    # a white derivative has coefficients of variance intensity over spacing
    spacing = (inside[reach:] - inside[:-reach]) / reach
    penalty = [np.ascontiguousarray(column) for column in (rows * np.sqrt(spacing)[:, None]).T]
    centre = sum(inside[k : k + rows.shape[0]] for k in range(reach + 1)) / (reach + 1)
    return penalty, centre


def _bending(
    time: ndarray, std: ndarray, clock: ndarray, fit: Spline, count: int, grid: int = 200
) -> Float[ndarray, " site"]:
    """Knots as dense as the spline's own local width, not denser than half the values."""
    even = np.linspace(0.0, 1.0, grid)
    at = np.interp(even, np.linspace(0.0, 1.0, clock.size), clock)
    x = (at - fit.origin) / fit.scale
    reached = np.interp(at, time, np.arange(time.size))
    values = np.maximum(np.gradient(reached, x), 1.0)
    known = np.log(values) - 2.0 * np.log(np.interp(at, time, std))
    own = [np.interp(x, fit.prior.node, part) for part in fit.prior.log_precision]
    width = np.exp(np.max([(known - part) / 6.0 for part in own], axis=0))
    density = 0.3 * np.gradient(even, x) + 0.7 * width / np.trapezoid(width, x)
    count = max(min(count, time.size // 2), 4)
    density = np.minimum(density, 0.5 * values / count)
    total = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x))])
    return np.interp(np.linspace(0.0, total[-1], count), total, at)


def _inverse(lower: Float[ndarray, "n n"]) -> Float[ndarray, "n n"]:
    """Inverse of a positive definite matrix from its lower triangle, balanced first."""
    scale = 1.0 / np.sqrt(lower.diagonal())
    balanced = lower * scale[:, None]
    balanced *= scale
    balanced.reshape(-1)[:: scale.size + 1] += 1e-13
    # LAPACK stores by columns: its upper triangle is our lower
    factor, fault = lapack.dpotrf(balanced.T, lower=0, overwrite_a=1)
    if fault:
        raise ValueError("the spline's equations are singular: values without finite errors?")
    half = lapack.dpotri(factor, lower=0, overwrite_c=1)[0].T
    full = half + half.T
    full.reshape(-1)[:: scale.size + 1] *= 0.5
    full *= scale[:, None]
    full *= scale
    return full
