"""A smooth curve and its derivatives from noisy values: an adaptive penalised spline.

The curve is a B-spline; the prior on it is that its third derivative is white, with an intensity
that may vary along the record (much at large amplitude, where the joint slips, little on the
stick plateau, a spike where one turns into the other). The intensities are those of highest
restricted likelihood, found by the Fellner-Schall iteration (Wood & Fasiolo 2017). The posterior
gives standard errors which include the smoothing bias on average over the curve (Nychka 1988), and
what the intensities leave unknown (Kass & Steffey 1989).

Two passes: one on few knots finds the intensities, a second puts the knots where the curve
bends. Only the sums over the values cost more with more of them.
"""

from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.interpolate import PPoly
from scipy.linalg import LinAlgError

from bladeroot.signal.banded import solution
from bladeroot.signal.penalty import (
    PENALTY_ORDER,
    SPLINE_DEGREE,
    alive_splines,
    at_rows,
    derivative_rows,
    full_solution,
    normal_sums,
    penalised,
    penalty_rows,
    posterior,
    root_of,
    spread_out,
    whitened,
)

# Factors on the standard errors of the value and of its first two derivatives. The posterior's
# errors are those of a curve as rough as the prior; most segments are smoother. Found by simulation
# over sharp and gradual onsets at 30 to 80 dB, so that intervals of 95 % hold 95 %
# (benchmarks/decays.py, seeds 771 and 772). With a random walk in the values, whose size is known
# only as well as its likelihood tells, the posterior's errors are not too large.
CALIBRATION = np.array([1.0, 0.75, 0.75])
# The spline.
FINE_KNOTS = 90  # knots of the second pass at most
REGIONS = 18  # regions of the record at most, each with a penalty of its own
WIDTH_PLACES = 200  # places at which the local width of the spline is evaluated to set the knots


@dataclass(frozen=True)
class Prior:
    """Log-precision of each part's third derivative at node times (in record lengths)."""

    node: Float[ndarray, " node"]
    log_precision: Float[ndarray, "part node"]
    softest: Float[ndarray, "part node"]


@dataclass(frozen=True)
class Spline:
    """Posterior of the curves of all parts: coefficients and their covariance.

    The covariance is kept only of coefficients that share a piece: row j holds those of the
    coefficient j with j, j + 1, ... j + `SPLINE_DEGREE`.
    """

    origin: float
    scale: float
    knots: Float[ndarray, " knot"]
    trend: Float[ndarray, "part 2"]
    coefficient: Float[ndarray, "part coefficient"]
    covariance: Float[ndarray, "part coefficient alive"]
    prior: Prior
    calibration: Float[ndarray, " order"] = field(default_factory=lambda: CALIBRATION)

    def value(self, time: Float[ndarray, " point"]) -> Float[ndarray, "3 part point"]:
        """The curves and their first two derivatives."""
        x = (time - self.origin) / self.scale
        value = np.array([[part(x, order) for part in self._polynomials] for order in range(3)])
        value[0] += self.trend[:, :1] * x + self.trend[:, 1:]
        value[1] += self.trend[:, :1]
        value[1] /= self.scale
        value[2] /= self.scale**2
        return value

    @cached_property
    def _polynomials(self) -> list[PPoly]:
        return [PPoly.from_spline((self.knots, part, SPLINE_DEGREE)) for part in self.coefficient]

    def std(
        self, time: Float[ndarray, " point"], orders: int = 3
    ) -> Float[ndarray, "orders part point"]:
        """Standard errors of `value`, or of its first `orders` rows only."""
        x = (time - self.origin) / self.scale
        error = np.zeros((orders, self.covariance.shape[0], time.size))
        for d in range(orders):
            value, first = alive_splines(x, self.knots[d : self.knots.size - d], SPLINE_DEGREE - d)
            rows = derivative_rows(self.knots, SPLINE_DEGREE, d) / self.scale**d
            error[d] = _errors(value, first, rows, self.covariance)
        return self.calibration[:orders, None, None] * error


def _errors(
    value: Float[ndarray, "point alive"],
    first: Int[ndarray, " point"],
    rows: Float[ndarray, "row wide"],
    covariance: Float[ndarray, "part coefficient width"],
) -> Float[ndarray, "part point"]:
    """Standard errors of a derivative, from the splines alive and the rows that differentiate."""
    width = covariance.shape[-1]
    shape = np.zeros((first.size, width))
    for a in range(value.shape[1]):
        shape[:, a : a + rows.shape[1]] += value[:, a, None] * rows[first + a]
    total = np.zeros((covariance.shape[0], first.size))
    for a in range(width):
        own = covariance[:, first + a]
        total += shape[:, a] ** 2 * own[..., 0]
        for b in range(a + 1, width):
            total += 2.0 * shape[:, a] * shape[:, b] * own[..., b - a]
    return np.sqrt(np.maximum(total, 0.0))


def coarse(
    time: Float[ndarray, " value"],
    y: Float[ndarray, "part value"],
    std: Float[ndarray, " value"],
    duration: float,
    prior: Prior | None = None,
    knots: int = 50,
    iterations: int = 3,
    walk: Float[ndarray, " value"] | None = None,
) -> Spline:
    """Penalised splines on few knots through independent values that share their errors.

    prior: one to start from, as of an earlier call on the same record, `duration` s long.
    walk: variances of the steps of a random walk that the values also hold.
    """
    clock = sites(time, y[0], knots)
    prior = prior or _even(time, std, clock, duration, y.shape[0])
    return _fit(time, y, std, duration, clock, prior, iterations, walk)


def fine(
    time: Float[ndarray, " value"],
    y: Float[ndarray, "part value"],
    std: Float[ndarray, " value"],
    before: Spline,
) -> Spline:
    """Penalised splines with knots where an earlier, coarse fit bends."""
    where = _bending(time, std, sites(time, y[0], 50), before, FINE_KNOTS)
    return _fit(time, y, std, before.scale, where, before.prior, 2)


def evidence(
    time: Float[ndarray, " value"],
    y: Float[ndarray, "part value"],
    std: Float[ndarray, " value"],
    walk: Float[ndarray, " value"],
    fit: Spline,
) -> tuple[float, float]:
    """Restricted log-likelihood of errors and a walk, and the likeliest factor on all variances.

    The prior is that of a fit to the same values, and its variances share the factor. The
    likelihood holds up to a constant that depends on the times and the fit's knots.
    """
    x = (time - fit.origin) / fit.scale
    roots, size = _roots(x, y, std, walk, fit.knots, fit.trend)
    rows, centre = penalty_rows(fit.knots)
    place = np.interp(centre, fit.prior.node, np.arange(float(fit.prior.node.size)))
    found, square = -size * len(y), 0.0
    for root, own in zip(roots, fit.prior.log_precision, strict=True):
        precision = at_rows(place, own)
        whole = np.abs(root_of(root, rows, precision).diagonal())
        found += 0.5 * np.log(precision).sum() - np.log(whole[:-1]).sum()
        square += whole[-1] ** 2
    free = len(y) * (time.size - PENALTY_ORDER)
    return float(found - 0.5 * free * np.log(square / free)), float(square / free)


def _roots(
    x: ndarray, y: ndarray, std: ndarray, walk: ndarray, knots: ndarray, trend: ndarray
) -> tuple[list[ndarray], float]:
    """Each part's root of whitened splines and values; half the ln of a covariance determinant."""
    count = knots.size - SPLINE_DEGREE - 1
    design = spread_out(*alive_splines(x, knots, SPLINE_DEGREE), count)
    about = y - trend[:, :1] * x - trend[:, 1:]
    white, size = whitened(np.column_stack([design, about.T]), std, walk)
    root = np.linalg.qr(white, "r")
    return [root[:, [*range(count), count + part]] for part in range(len(y))], size


def sites(
    time: Float[ndarray, " value"], level: Float[ndarray, " value"], most: int
) -> Float[ndarray, " site"]:
    """Places for a spline's knots: even in log-amplitude as much as in number of values."""
    lowest = np.minimum.accumulate(level)
    fall = (lowest[0] - lowest) / max(lowest[0] - lowest[-1], 1e-9)
    clock = 0.5 * fall + 0.5 * np.linspace(0.0, 1.0, time.size)
    count = max(min(most, time.size // 2), 4)
    # a segment that grows has no fall, and its clock would end early
    return np.interp(np.linspace(0.0, clock[-1], count), clock, time)


def _even(time: ndarray, std: ndarray, clock: ndarray, duration: float, parts: int) -> Prior:
    """A prior that weighs about as much as the data over the distance from one site to the next."""
    regions = min(REGIONS, clock.size)
    node = np.interp(np.linspace(0.0, 1.0, regions), np.linspace(0.0, 1.0, clock.size), clock)
    width = np.gradient(clock / duration)
    at = np.interp(node, clock, width)
    own = 2.0 * np.log(np.interp(node, time, std)) - 5.0 * np.log(at)
    start = np.tile(-own - np.log(0.1), (parts, 1))
    return Prior((node - time[0]) / duration, start, start - 40.0)


def _fit(
    time: ndarray,
    y: ndarray,
    std: ndarray,
    duration: float,
    where: ndarray,
    prior: Prior,
    iterations: int,
    walk: ndarray | None = None,
) -> Spline:
    """The splines on given knots, after some steps of the intensities' iteration."""
    origin, scale = float(time[0]), duration
    x, inner = (time - origin) / scale, (where - origin) / scale
    knots = np.concatenate(
        [np.full(SPLINE_DEGREE, inner[0]), inner, np.full(SPLINE_DEGREE, inner[-1])]
    )
    count = knots.size - SPLINE_DEGREE - 1
    shape, first = alive_splines(x, knots, SPLINE_DEGREE)
    gram, right, trend = normal_sums(x, y, std, shape, first, count)
    penalty, centre = penalty_rows(knots)
    place = np.interp(centre, prior.node, np.arange(float(prior.node.size)))
    # by the normal matrix's band, or, with a walk, by roots
    known = right if walk is None else _roots(x, y, std, walk, knots, trend)[0]

    def solve(own: ndarray, precision: ndarray) -> tuple:
        if walk is None:
            return solution(penalised(gram, penalty, precision), own)
        return full_solution(root_of(own, penalty, precision), SPLINE_DEGREE + 1)

    try:
        found = [
            posterior(partial(solve, own), penalty, place, before, softest, iterations)
            for own, before, softest in zip(known, prior.log_precision, prior.softest, strict=True)
        ]
    except LinAlgError:
        problem = "the spline's equations are singular: values without finite errors?"
        raise ValueError(problem) from None
    log_precision, coefficient, covariance = (
        np.stack([part[k] for part in found]) for k in range(3)
    )
    return Spline(
        origin, scale, knots, trend, coefficient, covariance,
        Prior(prior.node, log_precision, prior.softest),
        CALIBRATION if walk is None else np.ones(3),
    )  # fmt: skip


def _bending(
    time: ndarray, std: ndarray, clock: ndarray, fit: Spline, count: int
) -> Float[ndarray, " site"]:
    """Knots as dense as the spline's own local width, not denser than half the values."""
    even = np.linspace(0.0, 1.0, WIDTH_PLACES)
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
