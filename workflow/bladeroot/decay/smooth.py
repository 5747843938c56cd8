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

from bladeroot.decay.bsplines import alive_splines, derivative_rows
from bladeroot.decay.penalty import (
    DEGREE,
    inverse_of,
    normal_sums,
    penalised,
    penalty_rows,
    spread,
    step,
)

# The posterior's errors are those of a curve as rough as the prior; most stretches are smoother.
# For the value and its derivatives, found by simulation over sharp and gradual onsets at 30 to
# 80 dB (benchmarks/decays.py).
CALIBRATION = np.array([1.0, 0.88, 0.88])


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
        return CALIBRATION[:, None, None] * np.sqrt(np.maximum(np.stack(error, axis=1), 0.0))

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
    iterations: int = 3,
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
    gram, right, trend = normal_sums(x, y, std, shape, first, count)
    penalty, centre = penalty_rows(knots)
    place = np.interp(centre, prior.node, np.arange(prior.node.size))
    tent = np.maximum(0.0, 1.0 - np.abs(place[:, None] - np.arange(prior.node.size)))
    coefficient, covariance = np.empty((y.shape[0], count)), np.empty((y.shape[0], count, count))
    found = prior.log_precision.copy()
    for part in range(y.shape[0]):
        softest = prior.softest[part]
        for _ in range(iterations):
            inverse = inverse_of(penalised(gram, penalty, np.exp(tent @ found[part])))
            change, moving = step(inverse, right[part], penalty, tent, found[part])
            found[part] = np.clip(found[part] + change, softest, softest + 50.0)
            if not moving:
                break
        # where the curve bends is known no better than to a region
        precision = np.exp(tent @ spread(found[part]))
        covariance[part] = inverse_of(penalised(gram, penalty, precision))
        coefficient[part] = covariance[part] @ right[part]
    return Spline(
        origin, scale, knots, trend, coefficient, covariance,
        Prior(prior.node, found, prior.softest),
    )  # fmt: skip


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
