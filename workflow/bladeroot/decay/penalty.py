"""The sums of a penalised spline, and the step by which its penalty is found."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import lapack

from bladeroot.decay.bsplines import derivative_rows

DEGREE = 5
ORDER = 3
# A region is made no stiffer once it has fewer degrees of freedom: the errors of a stretch that
# looks exactly straight would come out too small.
FEWEST_FREEDOM = 0.25


def normal_sums(
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


def penalty_rows(
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


def penalised(
    gram: Float[ndarray, "n n"], penalty: list[ndarray], precision: Float[ndarray, " row"]
) -> Float[ndarray, "n n"]:
    """Lower triangle of gram + P' diag(precision) P, with the rows of P as of `penalty_rows`."""
    matrix, count = gram.copy(), gram.shape[0]
    for a in range(ORDER + 1):
        weighted = precision * penalty[a]
        for b in range(a + 1):
            matrix.reshape(-1)[a * count + b :: count + 1][: precision.size] += (
                weighted * penalty[b]
            )
    return matrix


def step(
    inverse: Float[ndarray, "n n"],
    right: Float[ndarray, " n"],
    penalty: list[ndarray],
    tent: Float[ndarray, "row node"],
    log_precision: Float[ndarray, " node"],
) -> tuple[Float[ndarray, " node"], bool]:
    """Fellner and Schall's step of the log-precisions, and whether it matters to the curve."""
    rows, count = tent.shape[0], right.size
    value = inverse @ right
    variance, bend = np.zeros(rows), np.zeros(rows)
    for a in range(ORDER + 1):
        bend += penalty[a] * value[a : a + rows]
        for b in range(a + 1):
            own = inverse.reshape(-1)[a * count + b :: count + 1][:rows]
            variance += (1.0 if a == b else 2.0) * penalty[a] * penalty[b] * own
    precision = np.exp(tent @ log_precision)
    freedom = np.maximum(1.0 - precision * variance, 0.0) @ tent + 1e-12
    roughness = (precision * bend**2) @ tent
    step = np.log(freedom / np.maximum(roughness, 1e-30))
    # a stretch that is straight already gains nothing by being stiffer
    step = np.where(freedom < FEWEST_FREEDOM, np.minimum(step, 0.0), step)
    step = np.clip(2.0 * step, -4.0, 4.0)  # twice the step: it is known to creep
    return step, bool((np.abs(step) * np.minimum(freedom, 1.0)).max() > 0.2)


def spread(log_precision: Float[ndarray, " node"]) -> Float[ndarray, " node"]:
    """Intensities averaged with a half of each neighbour's."""
    stiffest = log_precision.max()
    intensity = np.pad(np.exp(stiffest - log_precision), 1, mode="edge")
    mean = 0.25 * intensity[:-2] + 0.5 * intensity[1:-1] + 0.25 * intensity[2:]
    return stiffest - np.log(mean)


def inverse_of(lower: Float[ndarray, "n n"]) -> Float[ndarray, "n n"]:
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
