"""The sums of a penalised spline, and the iteration by which its penalty is found.

With a random walk in the values the normal matrix has no band. Roots of it are then used
(`root_of`), not the matrix itself: a stiff penalty and what it leaves free differ by more than
floating point resolves.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.interpolate import BSpline
from scipy.linalg import cholesky_banded, solve_banded, solve_triangular

from bladeroot.signal.banded import lower_band


def alive_splines(
    x: Float[ndarray, " point"], knots: Float[ndarray, " knot"], degree: int
) -> tuple[Float[ndarray, "point alive"], Int[ndarray, " point"]]:
    """The degree + 1 B-splines that are not zero at each point, and the first one's number.

    On (already padded) knots; beyond the ends the outermost polynomials go on.
    """
    matrix = BSpline.design_matrix(x, knots, degree, extrapolate=True)
    return matrix.data.reshape(-1, degree + 1), matrix.indices[:: degree + 1]


def derivative_rows(
    knots: Float[ndarray, " knot"], degree: int, order: int
) -> Float[ndarray, "row alive"]:
    """From a spline's coefficients to those of its derivative: row j weighs j ... j + order."""
    rows = np.zeros((knots.size - degree - 1, order + 1))
    rows[:, 0] = 1.0
    for done in range(order):
        # the derivative of a spline of degree d is a difference over the width of d knots
        d, left = degree - done, knots[done + 1 :]
        width = left[d : d + len(rows) - 1] - left[: len(rows) - 1]
        difference = -rows[:-1]
        difference[:, 1:] += rows[1:, :-1]
        rows = d / width[:, None] * difference
    return rows


SPLINE_DEGREE = 5
PENALTY_ORDER = 3  # of the derivative whose roughness is penalised
# The precision (one over the intensity) of the penalty in each region of the record.
# With fewer degrees of freedom than this a region is made no stiffer: the errors of a segment that
# looks exactly straight would come out too small.
FEWEST_FREEDOM = 0.25
PRECISION_STD = 3.0  # of a region's log-precision, before the data: e^3, twentyfold either way
STIFFEST_RANGE = 50.0  # log-precision of a region over its softest, at most


def normal_sums(
    x: Float[ndarray, " value"],
    y: Float[ndarray, "part value"],
    std: Float[ndarray, " value"],
    shape: Float[ndarray, "value alive"],
    first: Int[ndarray, " value"],
    count: int,
) -> tuple[Float[ndarray, "n width"], Float[ndarray, "part n"], Float[ndarray, "part 2"]]:
    """Normal equations (lower band) of the values less a straight line, and the line."""

    def summed(values: Float[ndarray, " value"], a: int) -> Float[ndarray, " n"]:
        return np.bincount(first + a, values, count)

    weight = std**-2
    mean, level = np.average(x, weights=weight), np.average(y, axis=1, weights=weight)
    from_mean = weight * (x - mean)
    slope = ((y - level[:, None]) * from_mean).sum(axis=1) / (from_mean * (x - mean)).sum()
    trend = np.stack([slope, level - slope * mean], axis=1)
    about = weight * (y - trend[:, :1] * x - trend[:, 1:])
    alive = shape.shape[1]
    gram = np.zeros((count, alive))
    for a in range(alive):
        for b in range(a, alive):
            gram[:, b - a] += summed(weight * shape[:, a] * shape[:, b], a)
    right = [sum(summed(own * shape[:, a], a) for a in range(alive)) for own in about]
    return gram, np.array(right), trend


def penalty_rows(
    knots: Float[ndarray, " knot"],
) -> tuple[Float[ndarray, "row alive"], Float[ndarray, " row"]]:
    """The third derivative's coefficients, of unit variance where it is white; where they lie.

    Row j weighs the spline's coefficients j ... j + `PENALTY_ORDER`.
    """
    rows = derivative_rows(knots, SPLINE_DEGREE, PENALTY_ORDER)
    reach = SPLINE_DEGREE - PENALTY_ORDER + 1
    inside = knots[PENALTY_ORDER : knots.size - PENALTY_ORDER]
    # a white derivative has coefficients of variance intensity over spacing
    spacing = (inside[reach:] - inside[:-reach]) / reach
    centre = sum(inside[k : k + rows.shape[0]] for k in range(reach + 1)) / (reach + 1)
    return rows * np.sqrt(spacing)[:, None], centre


def penalised(
    gram: Float[ndarray, "n width"],
    rows: Float[ndarray, "row alive"],
    precision: Float[ndarray, " row"],
) -> Float[ndarray, "n width"]:
    """Lower band of gram + P' diag(precision) P, with the rows of P as of `penalty_rows`."""
    band = gram.copy()
    for a in range(rows.shape[1]):
        for b in range(a, rows.shape[1]):
            band[a : a + len(rows), b - a] += precision * rows[:, a] * rows[:, b]
    return band


def posterior(
    solve: Callable[[ndarray], tuple[ndarray, ndarray, Callable[[ndarray], ndarray]]],
    rows: Float[ndarray, "row alive"],
    place: Float[ndarray, " row"],
    log_precision: Float[ndarray, " node"],
    softest: Float[ndarray, " node"],
    iterations: int,
) -> tuple[Float[ndarray, " node"], Float[ndarray, " n"], Float[ndarray, "n width"]]:
    """Log-precisions after some steps, coefficients, and their covariance in the band.

    The covariance has what the precisions leave unknown (Kass & Steffey 1989).

    solve: for the precisions of the rows, coefficients, their covariance in the band, and what
    multiplies columns by it; place: where each row of the penalty lies among the nodes, in nodes.
    LinAlgError where the equations are singular.
    """
    found = log_precision
    for _ in range(iterations):
        precision = at_rows(place, found)
        value, inverse, _ = solve(precision)
        freedom, roughness = _freedom(inverse, value, rows, place, precision, found.size)
        change, moving = _step(freedom, roughness)
        found = np.clip(found + change, softest, softest + STIFFEST_RANGE)
        if not moving:
            break
    # where the curve bends is known to within a region only
    precision = at_rows(place, _spread(found))
    value, inverse, times = solve(precision)
    freedom, _ = _freedom(inverse, value, rows, place, precision, found.size)
    moved = times(_pull(value, rows, place, precision, found.size))
    moved /= np.sqrt(0.5 * freedom + PRECISION_STD**-2)
    return found, value, inverse + lower_band(moved @ moved.T, inverse.shape[1])


def at_rows(
    place: Float[ndarray, " row"], log_precision: Float[ndarray, " node"]
) -> Float[ndarray, " row"]:
    """Precision of each row: its logarithm runs straight from node to node."""
    return np.exp(np.interp(place, np.arange(float(log_precision.size)), log_precision))


def _freedom(
    inverse: Float[ndarray, "n width"],
    value: Float[ndarray, " n"],
    rows: Float[ndarray, "row alive"],
    place: Float[ndarray, " row"],
    precision: Float[ndarray, " row"],
    nodes: int,
) -> tuple[Float[ndarray, " node"], Float[ndarray, " node"]]:
    """Each node's degrees of freedom, and the sum of squares that the penalty has there."""
    count, alive = rows.shape
    bend, variance = np.zeros(count), np.zeros(count)
    for a in range(alive):
        bend += rows[:, a] * value[a : a + count]
        for b in range(a, alive):
            own = rows[:, a] * rows[:, b] * inverse[a : a + count, b - a]
            variance += own if a == b else 2.0 * own
    shares = _shares(place, nodes)
    return np.maximum(1.0 - precision * variance, 0.0) @ shares, (precision * bend**2) @ shares


def _shares(place: Float[ndarray, " row"], nodes: int) -> Float[ndarray, "row node"]:
    """How much of each node's log-precision a row has: it runs straight from node to node."""
    return np.maximum(1.0 - np.abs(place[:, None] - np.arange(nodes)), 0.0)


def _pull(
    value: Float[ndarray, " n"],
    rows: Float[ndarray, "row alive"],
    place: Float[ndarray, " row"],
    precision: Float[ndarray, " row"],
    nodes: int,
) -> Float[ndarray, "n node"]:
    """The penalty's force on the coefficients, by the node to whose log-precision it is due."""
    whole = spread_out(rows, np.arange(len(rows)), value.size)
    return whole.T @ ((precision * (whole @ value))[:, None] * _shares(place, nodes))


def _step(
    freedom: Float[ndarray, " node"], roughness: Float[ndarray, " node"]
) -> tuple[Float[ndarray, " node"], bool]:
    """Fellner and Schall's step of the log-precisions, and whether it matters to the curve."""
    freedom = freedom + 1e-12
    own = np.log(freedom / np.maximum(roughness, 1e-30))
    # a segment that is straight already gains nothing by being stiffer
    own = np.where(freedom < FEWEST_FREEDOM, np.minimum(own, 0.0), own)
    change = np.clip(2.0 * own, -4.0, 4.0)  # twice the step, as it converges slowly
    return change, bool((np.abs(change) * np.minimum(freedom, 1.0) > 0.2).any())


def _spread(log_precision: Float[ndarray, " node"]) -> Float[ndarray, " node"]:
    """Intensities averaged with a half of each neighbour's."""
    stiffest = log_precision.max()
    intensity = np.pad(np.exp(stiffest - log_precision), 1, mode="edge")
    mean = 0.25 * (intensity[:-2] + intensity[2:]) + 0.5 * intensity[1:-1]
    return stiffest - np.log(mean)


def spread_out(
    shape: Float[ndarray, "row alive"], first: Int[ndarray, " row"], count: int
) -> Float[ndarray, "row n"]:
    """Rows written out in full, of which only some neighbouring elements are not zero."""
    whole = np.zeros((first.size, count))
    np.put_along_axis(whole, first[:, None] + np.arange(shape.shape[1]), shape, axis=1)
    return whole


def whitened(
    values: Float[ndarray, "value column"],
    std: Float[ndarray, " value"],
    walk: Float[ndarray, " value"],
) -> tuple[Float[ndarray, "value column"], float]:
    """Columns made independent, of unit variance; half the ln of their covariance's determinant.

    Errors are `std` and a random walk, of whose steps `walk` has the variances, the first that of
    its start. Each value has the walk's mean over a step about its place, whose variance is a sixth
    of a step's less. The differences of neighbouring values have a covariance of three diagonals.
    """
    own = std**2 - np.minimum(walk, np.append(walk[1:], walk[-1])) / 6.0
    band = np.stack([own + walk, np.append(-own[:-1], 0.0)])
    band[0, 1:] += own[:-1]
    factor = cholesky_banded(band, lower=True)
    white = solve_banded((1, 0), factor, np.diff(values, axis=0, prepend=0.0))
    return white, float(np.log(factor[0]).sum())


def root_of(
    columns: Float[ndarray, "value column"],
    rows: Float[ndarray, "row alive"],
    precision: Float[ndarray, " row"],
) -> Float[ndarray, "column column"]:
    """Triangular root of whitened columns, the last of them data, with a penalty on the others."""
    size = np.sqrt(precision)[:, None] * rows
    penalty = spread_out(size, np.arange(len(rows)), columns.shape[1])
    return np.linalg.qr(np.concatenate([columns, penalty]), "r")


def full_solution(
    root: Float[ndarray, "column column"], width: int
) -> tuple[Float[ndarray, " n"], Float[ndarray, "n width"], Callable[[ndarray], ndarray]]:
    """Coefficients by a root as of `root_of`, a band of their covariance, what multiplies by it."""
    inverse = solve_triangular(root[:-1, :-1], np.eye(len(root) - 1))
    whole = inverse @ inverse.T
    return inverse @ root[:-1, -1], lower_band(whole, width), whole.__matmul__
