"""Scatter within records, between records of a clamping and between clampings, told apart.

    y = mean of its force (+ half the difference of the directions) + clamping + record + own error

Own errors are known; the standard deviations of records and of clampings are the same at all forces
of a mode. Their joint posterior is the restricted likelihood (means integrated out) on a grid,
under Jeffreys' prior of ln scatter, with which intervals of balanced data are Student's. A scatter
that nothing repeats is left out: nothing is known of it.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

SCATTER_GRID = 56  # values of each scatter at which its posterior is evaluated
STDS_OF_95 = 1.959964  # half of a normal distribution's interval of 95 %, in standard deviations


@dataclass(frozen=True)
class Pooled:
    """Means of the forces and their intervals; scatter of records and clampings.

    `std` is what a normal distribution needs to have the right 95 % interval. Standard deviations
    are posterior medians, NaN with no degree of freedom. `difference` is up less down over all
    forces, NaN unless both exist at a force and something else tells the scatter.
    """

    mean: Float[ndarray, " force"]
    std: Float[ndarray, " force"]
    record_std: float
    clamping_std: float
    record_freedom: int
    clamping_freedom: int
    difference: float
    difference_std: float


def pool(
    y: Float[ndarray, " record"],
    std: Float[ndarray, " record"],
    force: Int[ndarray, " record"],
    clamping: Int[ndarray, " record"],
    direction: Float[ndarray, " record"],
) -> Pooled:
    """Means of all forces from records that share clampings.

    force, clamping: numbers from 0; a clamping belongs to one force. direction: 1 up, -1 down, 0
    unknown.
    """
    design = (force[:, None] == np.arange(force.max() + 1)).astype(float)
    member = (clamping[:, None] == np.arange(clamping.max() + 1)).astype(float)
    record_freedom, clamping_freedom = _freedoms(design, member)
    both = np.column_stack([design, 0.5 * direction])
    directed = bool(np.linalg.matrix_rank(both) > design.shape[1])
    if directed:
        left = _freedoms(both, member)
        # a difference that takes a scatter's last freedom is not told from that scatter
        directed = (left[0] > 0) == (record_freedom > 0) and (left[1] > 0) == (clamping_freedom > 0)
    if directed:
        design, (record_freedom, clamping_freedom) = both, left
    level = np.average(y)
    rest = y - level - design @ np.linalg.lstsq(design, y - level, rcond=None)[0]
    scale = float(np.sqrt((rest**2).mean() + (std**2).mean()))
    # Errors far below the scatter decide nothing, and would cancel to rounding.
    std = np.maximum(std, 1e-4 * scale)
    axis = np.geomspace(1e-3, 300.0, SCATTER_GRID) * scale
    of_record = axis if record_freedom else np.zeros(1)
    of_clamping = axis if clamping_freedom else np.zeros(1)
    weight, mean, variance = [], [], []
    for record_std in of_record:
        log, beta, covariance = _restricted(y - level, std, design, member, record_std, of_clamping)
        if record_freedom:
            log = log + _prior(np.array([record_std]), std**2)
        if clamping_freedom:
            own = 1.0 / (member.T @ (1.0 / (std**2 + record_std**2)))
            log = log + _prior(of_clamping, own)
        weight.append(log)
        mean.append(beta)
        variance.append(np.diagonal(covariance, axis1=1, axis2=2))
    weight = np.exp(np.array(weight) - np.max(weight))
    weight /= weight.sum()
    mean, variance = np.concatenate(mean), np.concatenate(variance)
    centre, half = _intervals(weight.ravel(), mean, variance)
    forces = int(force.max()) + 1
    return Pooled(
        centre[:forces] + level, half[:forces] / STDS_OF_95,
        _median(of_record, weight.sum(axis=1)) if record_freedom else np.nan,
        _median(of_clamping, weight.sum(axis=0)) if clamping_freedom else np.nan,
        record_freedom, clamping_freedom,
        float(centre[-1]) if directed else np.nan,
        float(half[-1]) / STDS_OF_95 if directed else np.nan,
    )  # fmt: skip


def _prior(
    scatter: Float[ndarray, " grid"], variance: Float[ndarray, " one"]
) -> Float[ndarray, " grid"]:
    """Log of Jeffreys' prior of ln scatter: the sharpest of the known variances decide."""
    whole = variance + scatter[:, None] ** 2
    return np.log(scatter**2 * np.sqrt((whole**-2.0).mean(axis=1)))


def _freedoms(
    design: Float[ndarray, "record effect"], member: Float[ndarray, "record clamping"]
) -> tuple[int, int]:
    """Degrees of freedom for the scatter of records and of clampings."""
    effects = int(np.linalg.matrix_rank(design))
    with_clampings = int(np.linalg.matrix_rank(np.hstack([design, member])))
    return len(design) - with_clampings, with_clampings - effects


def _restricted(
    y: Float[ndarray, " record"],
    std: Float[ndarray, " record"],
    design: Float[ndarray, "record effect"],
    member: Float[ndarray, "record clamping"],
    record_std: float,
    clamping_std: Float[ndarray, " grid"],
) -> tuple[Float[ndarray, " grid"], Float[ndarray, "grid effect"], ndarray]:
    """Restricted log-likelihood, effects and their covariance for each scatter of the clampings.

    A clamping's covariance is diagonal plus a constant, so its inverse is known (Woodbury).
    """
    trust = 1.0 / (std**2 + record_std**2)
    inside = member.T @ trust
    to_effect = member.T @ (trust[:, None] * design)
    to_value = member.T @ (trust * y)
    shared = clamping_std[:, None] ** 2 / (1.0 + clamping_std[:, None] ** 2 * inside)
    outer = (to_effect[:, :, None] * to_effect[:, None]).reshape(inside.size, -1)
    gram = (design.T * trust) @ design
    gram = gram - (shared @ outer).reshape(-1, *gram.shape)
    right = design.T @ (trust * y) - (shared * to_value) @ to_effect
    covariance = np.linalg.inv(gram)
    effect = (covariance @ right[:, :, None])[:, :, 0]
    square = (trust * y**2).sum() - shared @ to_value**2 - (effect * right).sum(axis=1)
    log = 0.5 * np.log(trust).sum()
    log = log - 0.5 * np.log1p(clamping_std[:, None] ** 2 * inside).sum(axis=1)
    return log - 0.5 * np.linalg.slogdet(gram)[1] - 0.5 * square, effect, covariance


def _intervals(
    weight: Float[ndarray, " grid"],
    mean: Float[ndarray, "grid effect"],
    variance: Float[ndarray, "grid effect"],
) -> tuple[Float[ndarray, " effect"], Float[ndarray, " effect"]]:
    """Mean of the mixture of normals, and half the width of the 95 % interval about it."""
    from scipy.special import ndtr

    keep = weight > 1e-9
    weight, mean, std = weight[keep], mean[keep], np.sqrt(variance[keep])
    centre = weight @ mean / weight.sum()
    low, high = np.zeros_like(centre), 10.0 * (std + np.abs(mean - centre)).max(axis=0)
    for _ in range(50):
        half = 0.5 * (low + high)
        inside = ndtr((centre + half - mean) / std) - ndtr((centre - half - mean) / std)
        enough = weight @ inside / weight.sum() > 0.95
        low, high = np.where(enough, low, half), np.where(enough, half, high)
    return centre, 0.5 * (low + high)


def _median(values: Float[ndarray, " grid"], weight: Float[ndarray, " grid"]) -> float:
    return float(np.interp(0.5, np.cumsum(weight) - 0.5 * weight, values))
