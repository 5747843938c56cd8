"""Scatter within records, between records of a clamping and between clampings, told apart.

    y = mean of its level (+ half the difference of the directions)
        + clamping + clamping at this level + record + own error

Own errors are known; standard deviations are the same at all levels (a load and a group) of a mode.
What a clamping keeps from level to level is told from what it has anew at each only where some
clamping is at several. The joint posterior of the standard deviations is the restricted likelihood
(means integrated out) on a grid, under Jeffreys' prior of ln scatter, with which intervals of
balanced data are Student's. A scatter that nothing repeats is left out: nothing is known of it.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

SCATTER_GRID = 56  # values of each scatter at which its posterior is evaluated
# One of so many of them for what clampings keep: of few clampings it is hardly known.
KEPT_STEP = 2
STDS_OF_95 = 1.959964  # half of a normal distribution's interval of 95 %, in standard deviations


@dataclass(frozen=True)
class Pooled:
    """Means of the levels and their intervals; scatter of records and clampings.

    `std` is what a normal distribution needs to have the right 95 % interval. Standard deviations
    are posterior medians, NaN with no degree of freedom; `clamping_std` is that of a clamping at
    one level, and `clamping_freedom` that of what it keeps where it is at several. `difference` is
    up less down over all levels, NaN unless both exist at a level and something else tells the
    scatter.
    """

    mean: Float[ndarray, " level"]
    std: Float[ndarray, " level"]
    record_std: float
    clamping_std: float
    record_freedom: int
    clamping_freedom: int
    difference: float
    difference_std: float


def pool(
    y: Float[ndarray, " record"],
    std: Float[ndarray, " record"],
    level: Int[ndarray, " record"],
    clamping: Int[ndarray, " record"],
    direction: Float[ndarray, " record"],
) -> Pooled:
    """Means of all levels from records that share clampings.

    level, clamping: numbers from 0; a clamping may be at several levels. direction: 1 up, -1 down,
    0 unknown.
    """
    design = _indicator(level)
    whole = _indicator(clamping)
    pairs, part = np.unique(np.stack([level, clamping]), axis=1, return_inverse=True)
    member, parts_of = _indicator(part), _indicator(pairs[1])
    freedom = _freedoms(design, whole, member)
    both = np.column_stack([design, 0.5 * direction])
    directed = bool(np.linalg.matrix_rank(both) > design.shape[1])
    if directed:
        left = _freedoms(both, whole, member)
        # a difference that takes a scatter's last freedom is not told from that scatter
        directed = all((a > 0) == (b > 0) for a, b in zip(left, freedom, strict=True))
    if directed:
        design, freedom = both, left
    # What is pooled is what plain means leave, so that large levels do not cancel to rounding.
    plain = np.linalg.lstsq(design, y, rcond=None)[0]
    rest = y - design @ plain
    scale = float(np.sqrt((rest**2).mean() + (std**2).mean()))
    # Errors far below the scatter decide nothing, and would cancel to rounding.
    std = np.maximum(std, 1e-4 * scale)
    axis = np.geomspace(1e-3, 300.0, SCATTER_GRID) * scale
    of_record, of_part, of_kept = (
        values if free else np.zeros(1)
        for values, free in zip((axis, axis, axis[::KEPT_STEP]), freedom, strict=True)
    )
    weight, mean, variance = [], [], []
    for record_std in of_record:
        trust = 1.0 / (std**2 + record_std**2)
        log, beta, covariance = _restricted(rest, trust, design, member, parts_of, of_part, of_kept)
        if freedom[0]:
            log = log + _prior(np.array([record_std]), std**2)
        weight.append(log)
        mean.append(beta)
        variance.append(np.diagonal(covariance, axis1=1, axis2=2))
    weight = np.exp(np.array(weight) - np.max(weight))
    weight /= weight.sum()
    centre, half = _intervals(weight.ravel(), np.concatenate(mean), np.concatenate(variance))
    centre += plain
    levels, of_clamping = design.shape[1] - directed, np.hypot.outer(of_part, of_kept).ravel()
    clamping_freedom = freedom[2] or freedom[1]
    return Pooled(
        centre[:levels], half[:levels] / STDS_OF_95,
        _median(of_record, weight.sum(axis=1)) if freedom[0] else np.nan,
        _median(of_clamping, weight.sum(axis=0)) if clamping_freedom else np.nan,
        freedom[0], clamping_freedom,
        float(centre[-1]) if directed else np.nan,
        float(half[-1]) / STDS_OF_95 if directed else np.nan,
    )  # fmt: skip


def _indicator(number: Int[ndarray, " row"]) -> Float[ndarray, "row number"]:
    return (number[:, None] == np.arange(number.max() + 1)).astype(float)


def _prior(
    scatter: Float[ndarray, " grid"], variance: Float[ndarray, "*other one"]
) -> Float[ndarray, "*other grid"]:
    """Log of Jeffreys' prior of ln scatter: the sharpest of the known variances decide."""
    whole = variance[..., None, :] + scatter[:, None] ** 2
    return np.log(scatter**2 * np.sqrt((whole**-2.0).mean(axis=-1)))


def _freedoms(
    design: Float[ndarray, "record effect"],
    whole: Float[ndarray, "record clamping"],
    member: Float[ndarray, "record part"],
) -> tuple[int, int, int]:
    """Degrees of freedom for the scatter of records, of clampings at a level, of what they keep.

    Without a clamping at several levels nothing is kept.
    """
    rank = np.linalg.matrix_rank
    effects, all_parts = int(rank(design)), int(rank(np.hstack([design, member])))
    with_kept = effects
    if member.shape[1] > whole.shape[1]:
        with_kept = int(rank(np.hstack([design, whole])))
    return len(design) - all_parts, all_parts - with_kept, with_kept - effects


def _restricted(
    y: Float[ndarray, " record"],
    trust: Float[ndarray, " record"],
    design: Float[ndarray, "record effect"],
    member: Float[ndarray, "record part"],
    parts_of: Float[ndarray, "part clamping"],
    part_std: Float[ndarray, " grid"],
    kept_std: Float[ndarray, " kept"],
) -> tuple[Float[ndarray, " both"], Float[ndarray, "both effect"], ndarray]:
    """Log-posterior of the clampings' scatters, effects and their covariance, at each pair of them.

    trust: inverse variance of each record about its clamping at its level. The covariance is
    diagonal, plus a constant within a clamping at a level, plus one within a clamping, so that its
    inverse is known (Woodbury, twice). The prior of scatters that are not zero is in it.
    """
    inside, to_value = member.T @ trust, member.T @ (trust * y)
    to_effect = member.T @ (trust[:, None] * design)
    effects = design.shape[1]
    left = 1.0 / (1.0 + part_std[:, None] ** 2 * inside)
    shared = part_std[:, None] ** 2 * left
    outer = (to_effect[:, :, None] * to_effect[:, None]).reshape(inside.size, -1)
    gram = ((design.T * trust) @ design).ravel() - shared @ outer
    right = design.T @ (trust * y) - (shared * to_value) @ to_effect
    square = (trust * y**2).sum() - shared @ to_value**2
    log = 0.5 * np.log(trust).sum() + 0.5 * np.log(left).sum(axis=1)
    log = log + (_prior(part_std, 1.0 / inside) if part_std.any() else 0.0)

    inside, to_value = (left * inside) @ parts_of, (left * to_value) @ parts_of
    to_effect = parts_of.T @ (left[:, :, None] * to_effect)
    whole = 1.0 + kept_std[:, None] ** 2 * inside[:, None]
    shared = kept_std[:, None] ** 2 / whole
    outer = (to_effect[:, :, :, None] * to_effect[:, :, None]).reshape(*inside.shape, -1)
    gram = (gram[:, None] - shared @ outer).reshape(-1, effects, effects)
    right = (right[:, None] - (shared * to_value[:, None]) @ to_effect).reshape(-1, effects)
    square = (square[:, None] - (shared * to_value[:, None] ** 2).sum(axis=2)).ravel()
    log = log[:, None] - 0.5 * np.log(whole).sum(axis=2)
    log = log + (_prior(kept_std, 1.0 / inside) if kept_std.any() else 0.0)

    covariance = np.linalg.inv(gram)
    effect = (covariance @ right[:, :, None])[:, :, 0]
    square = square - (effect * right).sum(axis=1)
    return log.ravel() - 0.5 * np.linalg.slogdet(gram)[1] - 0.5 * square, effect, covariance


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
    order = np.argsort(values)
    below = np.cumsum(weight[order]) - 0.5 * weight[order]
    return float(np.interp(0.5, below, values[order]))
