"""The sums of a penalised spline, and the iteration by which its penalty is found."""

from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.compiled import njit
from bladeroot.signal.banded import factored, inverse_band, solved
from bladeroot.signal.bsplines import derivative_rows

DEGREE = 5
ORDER = 3
# A region is made no stiffer once it has fewer degrees of freedom: the errors of a stretch that
# looks exactly straight would come out too small.
FEWEST_FREEDOM = 0.25
# Furthest that the log-precision of a region is moved above its softest.
STIFFEST = 50.0


@njit(cache=True)
@no_type_check
def normal_sums(
    x: Float[ndarray, " value"],
    y: Float[ndarray, "part value"],
    std: Float[ndarray, " value"],
    shape: Float[ndarray, "value alive"],
    first: Int[ndarray, " value"],
    count: int,
) -> tuple[Float[ndarray, "n width"], Float[ndarray, "part n"], Float[ndarray, "part 2"]]:
    """Normal equations (lower band) of the values less a straight line, and the line."""
    parts, alive = y.shape[0], shape.shape[1]
    gram, right, trend = np.zeros((count, alive)), np.zeros((parts, count)), np.empty((parts, 2))
    # all by loops: sums of whole arrays take two seconds to compile
    total = mean = spread = 0.0
    for v in range(x.size):
        total += 1.0 / std[v] ** 2
        mean += 1.0 / std[v] ** 2 * x[v]
    mean /= total
    for v in range(x.size):
        spread += 1.0 / std[v] ** 2 * (x[v] - mean) * (x[v] - mean)
    for part in range(parts):
        level = slope = 0.0
        for v in range(x.size):
            level += 1.0 / std[v] ** 2 * y[part, v]
        level /= total
        for v in range(x.size):
            slope += 1.0 / std[v] ** 2 * (x[v] - mean) * (y[part, v] - level)
        slope /= spread
        trend[part, 0], trend[part, 1] = slope, level - slope * mean
    for v in range(x.size):
        j, weight = first[v], 1.0 / std[v] ** 2
        for a in range(alive):
            weighted = weight * shape[v, a]
            for b in range(a, alive):
                gram[j + a, b - a] += weighted * shape[v, b]
            for part in range(parts):
                about = weight * (y[part, v] - trend[part, 0] * x[v] - trend[part, 1])
                right[part, j + a] += about * shape[v, a]
    return gram, right, trend


def penalty_rows(
    knots: Float[ndarray, " knot"],
) -> tuple[Float[ndarray, "row alive"], Float[ndarray, " row"]]:
    """The third derivative's coefficients, of unit variance where it is white; where they lie.

    Row j weighs the spline's coefficients j ... j + ORDER.
    """
    rows = derivative_rows(knots, DEGREE, ORDER)
    reach = DEGREE - ORDER + 1
    inside = knots[ORDER : knots.size - ORDER]
    # a white derivative has coefficients of variance intensity over spacing
    spacing = (inside[reach:] - inside[:-reach]) / reach
    centre = sum(inside[k : k + rows.shape[0]] for k in range(reach + 1)) / (reach + 1)
    return rows * np.sqrt(spacing)[:, None], centre


@njit(cache=True)
@no_type_check
def penalised(
    gram: Float[ndarray, "n width"],
    rows: Float[ndarray, "row alive"],
    precision: Float[ndarray, " row"],
) -> Float[ndarray, "n width"]:
    """Lower band of gram + P' diag(precision) P, with the rows of P as of `penalty_rows`."""
    band = gram.copy()
    for j in range(rows.shape[0]):
        for a in range(rows.shape[1]):
            weighted = precision[j] * rows[j, a]
            for b in range(a, rows.shape[1]):
                band[j + a, b - a] += weighted * rows[j, b]
    return band


@njit(cache=True)
@no_type_check
def posterior(
    gram: Float[ndarray, "n width"],
    right: Float[ndarray, " n"],
    rows: Float[ndarray, "row alive"],
    place: Float[ndarray, " row"],
    log_precision: Float[ndarray, " node"],
    softest: Float[ndarray, " node"],
    iterations: int,
) -> tuple[Float[ndarray, " node"], Float[ndarray, " n"], Float[ndarray, "n width"], bool]:
    """Log-precisions after some steps, coefficients, their covariance in the band, and success.

    place: where each row of the penalty lies among the nodes, in nodes.
    """
    found = log_precision.copy()
    for _ in range(iterations):
        precision = _at_rows(place, found)
        scale, factor, good = factored(penalised(gram, rows, precision))
        if not good:
            break
        inverse = inverse_band(scale, factor)
        change, moving = _step(
            inverse, solved(scale, factor, right), rows, place, precision, found.size
        )
        for k in range(found.size):
            stiffest = softest[k] + STIFFEST
            found[k] = min(max(found[k] + change[k], softest[k]), stiffest)
        if not moving:
            break
    # where the curve bends is known no better than to a region
    precision = _at_rows(place, _spread(found))
    scale, factor, good = factored(penalised(gram, rows, precision))
    if not good:
        return found, right, gram, False
    return found, solved(scale, factor, right), inverse_band(scale, factor), True


@njit(cache=True)
@no_type_check
def _at_rows(place, log_precision):
    """Precision of each row: its logarithm runs straight from node to node."""
    precision = np.empty(place.size)
    for j in range(place.size):
        left = min(int(place[j]), log_precision.size - 2)
        share = place[j] - left
        precision[j] = np.exp((1.0 - share) * log_precision[left] + share * log_precision[left + 1])
    return precision


@njit(cache=True)
@no_type_check
def _step(inverse, value, rows, place, precision, nodes):
    """Fellner and Schall's step of the log-precisions, and whether it matters to the curve."""
    freedom, roughness = np.empty(nodes), np.zeros(nodes)
    for k in range(nodes):
        freedom[k] = 1e-12
    for j in range(rows.shape[0]):
        bend, variance = 0.0, 0.0
        for a in range(rows.shape[1]):
            bend += rows[j, a] * value[j + a]
            variance += rows[j, a] ** 2 * inverse[j + a, 0]
            for b in range(a + 1, rows.shape[1]):
                variance += 2.0 * rows[j, a] * rows[j, b] * inverse[j + a, b - a]
        free = max(1.0 - precision[j] * variance, 0.0)
        rough = precision[j] * bend**2
        left = min(int(place[j]), nodes - 2)
        share = place[j] - left
        freedom[left] += (1.0 - share) * free
        freedom[left + 1] += share * free
        roughness[left] += (1.0 - share) * rough
        roughness[left + 1] += share * rough
    change, moving = np.empty(nodes), False
    for k in range(nodes):
        own = np.log(freedom[k] / max(roughness[k], 1e-30))
        # a stretch that is straight already gains nothing by being stiffer
        if freedom[k] < FEWEST_FREEDOM:
            own = min(own, 0.0)
        change[k] = min(max(2.0 * own, -4.0), 4.0)  # twice the step: it is known to creep
        moving |= abs(change[k]) * min(freedom[k], 1.0) > 0.2
    return change, moving


@njit(cache=True)
@no_type_check
def _spread(log_precision):
    """Intensities averaged with a half of each neighbour's."""
    stiffest, last = log_precision[0], log_precision.size - 1
    for k in range(1, last + 1):  # the maximum, whose own function takes long to compile
        stiffest = max(stiffest, log_precision[k])
    intensity, mean = np.empty(last + 1), np.empty(last + 1)
    for k in range(last + 1):
        intensity[k] = np.exp(stiffest - log_precision[k])
    for k in range(last + 1):
        beside = intensity[max(k - 1, 0)] + intensity[min(k + 1, last)]
        mean[k] = stiffest - np.log(0.25 * beside + 0.5 * intensity[k])
    return mean
