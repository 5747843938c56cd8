"""A smooth curve and its derivatives from noisy values: an adaptive penalised spline.

The curve is a B-spline; the prior on it is that a derivative of some order is white, with an
intensity that may vary along the record (much at large amplitude, where the joint slips, little
on the stick plateau). The intensities are those of highest restricted likelihood, found by the
Fellner-Schall iteration (Wood & Fasiolo 2017). The posterior gives standard errors which include
the smoothing bias on average over the curve (Nychka 1988).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray


@dataclass(frozen=True)
class Smooth:
    """Value, first and second derivative at each point, with standard errors."""

    value: Float[ndarray, "3 point"]
    std: Float[ndarray, "3 point"]


def basis(
    x: Float[ndarray, " point"], knots: Float[ndarray, " knot"], degree: int
) -> Float[ndarray, "point coefficient"]:
    """B-splines of a degree on (already padded) knots by the Cox-de Boor recursion."""
    last = knots.size - degree - 2
    cell = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, last)
    value = np.zeros((x.size, knots.size - 1))
    value[np.arange(x.size), cell] = 1.0
    for d in range(1, degree + 1):
        width = knots[d:] - knots[:-d]
        inverse = np.where(width > 0.0, 1.0 / np.where(width > 0.0, width, 1.0), 0.0)
        left = (x[:, None] - knots[: -d - 1]) * inverse[:-1]
        right = (knots[d + 1 :] - x[:, None]) * inverse[1:]
        value = left * value[:, :-1] + right * value[:, 1:]
    return value


def differences(
    knots: Float[ndarray, " knot"], degree: int, order: int
) -> Float[ndarray, "row coefficient"]:
    """Matrix from a spline's coefficients to those of its derivative of an order."""
    matrix = np.eye(knots.size - degree - 1)
    for d in range(degree, degree - order, -1):
        inner = knots[degree - d :]
        inner = inner[: matrix.shape[0] + d + 1]
        width = inner[d + 1 : d + matrix.shape[0]] - inner[1 : matrix.shape[0]]
        matrix = d * np.diff(matrix, axis=0) / width[:, None]
    return matrix


def smooth(
    time: Float[ndarray, " value"],
    y: Float[ndarray, " value"],
    std: Float[ndarray, " value"],
    sites: Float[ndarray, " site"],
    point: Float[ndarray, " point"],
    order: int = 3,
    degree: int = 5,
    regions: int = 6,
    iterations: int = 60,
    stiff: float = 0.5,
) -> Smooth:
    """Penalised spline through independent values, with knots at `sites`.

    `order` is the derivative taken as white in the prior; its intensity varies log-linearly
    between `regions` nodes spread evenly over the knots. A region is made no stiffer once it has
    fewer than `stiff` degrees of freedom, for the errors would come out too small.
    """
    origin, scale = time[0], time[-1] - time[0]
    x, at, inner = (time - origin) / scale, (point - origin) / scale, (sites - origin) / scale
    knots = np.concatenate([np.full(degree, inner[0]), inner, np.full(degree, inner[-1])])
    design = basis(x, knots, degree)
    penalty = differences(knots, degree, order)
    # a white derivative has coefficients of variance intensity over spacing
    reach = degree - order + 1
    inside = knots[order : knots.size - order]
    spacing = (inside[reach:] - inside[:-reach])[: penalty.shape[0]] / reach
    penalty = penalty * np.sqrt(spacing)[:, None]
    node = np.linspace(0.0, 1.0, regions)
    row = np.linspace(0.0, 1.0, penalty.shape[0])
    tent = np.maximum(0.0, 1.0 - np.abs(row[:, None] - node) * (regions - 1))
    trend = np.polyfit(x, y, 1, w=1.0 / std)
    about = y - np.polyval(trend, x)
    weighted = design / std[:, None] ** 2
    gram, right = design.T @ weighted, weighted.T @ about
    # start where the penalty weighs as much as the data
    data_weight = np.log(np.interp(row, np.linspace(0.0, 1.0, y.size), 1.0 / std**2))
    log_precision = (tent.T @ (data_weight - np.log((penalty**2).sum(axis=1)))) / tent.sum(axis=0)
    softest, stiffest = log_precision - 15.0, log_precision + 35.0
    for _ in range(iterations):
        precision = np.exp(tent @ log_precision)
        inverse = _inverse(gram + penalty.T @ (precision[:, None] * penalty))
        coefficient = inverse @ right
        variance = np.einsum("rc,cd,rd->r", penalty, inverse, penalty, optimize=True)
        freedom = tent.T @ np.maximum(1.0 - precision * variance, 1e-12)
        roughness = tent.T @ (precision * (penalty @ coefficient) ** 2)
        step = np.clip(np.log(freedom / np.maximum(roughness, 1e-30)), -3.0, 3.0)
        # a stretch that is straight already gains nothing by being stiffer
        step = np.where(freedom < stiff, np.minimum(step, 0.0), step)
        log_precision = np.clip(log_precision + step, softest, stiffest)
        if np.abs(step).max() < 0.05:
            break
    value, error = [], []
    for d in range(3):
        shape = basis(at, knots[d : knots.size - d], degree - d) @ differences(knots, degree, d)
        value.append(shape @ coefficient / scale**d)
        error.append(np.sqrt(np.einsum("pc,pc->p", shape @ inverse, shape)) / scale**d)
    value[0] = value[0] + np.polyval(trend, at)
    value[1] = value[1] + trend[0] / scale
    return Smooth(np.stack(value), np.stack(error))


def _inverse(matrix: Float[ndarray, "n n"]) -> Float[ndarray, "n n"]:
    """Inverse of a positive definite matrix, balanced first."""
    scale = 1.0 / np.sqrt(np.diag(matrix))
    balanced = matrix * scale[:, None] * scale
    factor = np.linalg.inv(balanced + 1e-13 * np.eye(scale.size))
    return factor * scale[:, None] * scale
