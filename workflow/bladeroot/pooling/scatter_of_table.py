"""How much the stick frequencies of a table scatter about a smooth law of the force.

Records at neighbouring forces repeat one another but for a law that is smooth in ln F. The law is
free: its second derivative in ln F is white with an unknown intensity (a smoothing spline). What it
leaves beyond the table's own errors is scatter; it may fall with the force by a power, as the grip
of a joint becomes more repeatable. All three have their restricted likelihood on a grid. New
clampings and the force's own errors are part of that scatter.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

FEWEST_ROWS = 6  # rows of a mode from which a scatter can be told
FALL_POWERS = np.arange(0.0, 3.1, 0.75)  # of the force, by which the scatter may fall with it


@dataclass(frozen=True)
class Scatter:
    """Posterior median of each row's scatter and of the law; ratio to the stated errors.

    `rms`: posterior rms of each row's scatter, wider where few rows tell it: with it a normal
    interval of one row covers what it should, with the median it does not.
    `ratio`: the rows' median of scatter over stated error, as its 2.5, 50 and 97.5 % quantiles.
    """

    std: Float[ndarray, " row"]
    rms: Float[ndarray, " row"]
    law: Float[ndarray, " row"]
    ratio: Float[ndarray, " 3"]


def scatter_about_law(
    force: Float[ndarray, " row"], value: Float[ndarray, " row"], stated: Float[ndarray, " row"]
) -> Scatter:
    """Scatter of values about a smooth law of ln F; NaN for fewer than `FEWEST_ROWS` rows."""
    if force.size < FEWEST_ROWS:
        none = np.full(force.size, np.nan)
        return Scatter(none, none, none, np.full(3, np.nan))
    log_force = np.log(force / force.min())
    x = log_force / log_force.max()
    low, high = np.minimum(x[:, None], x), np.maximum(x[:, None], x)
    wiener = low**2 * (3.0 * high - low) / 6.0
    design = np.stack([np.ones_like(x), x], axis=1)
    y = value - value.mean()
    size = max(y.std(), 1e-3 * stated.min())  # rows may all read the same
    stds = np.geomspace(1e-3, 3.0, 28) * size
    fall = np.exp(-FALL_POWERS[:, None] * (log_force - np.median(log_force)))
    rows = (stds[:, None, None] * fall).reshape(-1, x.size)
    scatter = rows[:, :, None] ** 2 * np.eye(x.size)
    bends = np.geomspace(1e-2, 1e3, 14) * size
    log, laws = np.empty((bends.size, rows.shape[0])), np.empty((bends.size, *rows.shape))
    for k, bend in enumerate(bends):
        smooth = bend**2 * wiener
        whole = smooth + np.diag(stated**2) + scatter
        inverse = np.linalg.inv(whole)
        gram = design.T @ inverse @ design
        effect = np.linalg.solve(gram, (design.T @ (inverse @ y)[..., None]))[..., 0]
        rest = y - effect @ design.T
        pulled = (inverse @ rest[..., None])[..., 0]
        log[k] = -0.5 * (np.linalg.slogdet(whole)[1] + np.linalg.slogdet(gram)[1])
        log[k] -= 0.5 * (rest * pulled).sum(axis=1)
        laws[k] = effect @ design.T + pulled @ smooth
    log += np.log(np.mean(rows**2, axis=1) / np.mean(rows**2 + stated**2, axis=1))
    weight = np.exp(log - log.max())
    weight /= weight.sum()
    law = np.einsum("kg,kgr->r", weight, laws) + value.mean()
    weight = weight.sum(axis=0)
    std = np.array([_quantiles(row, weight, [0.5])[0] for row in rows.T])
    ratio = _quantiles(np.median(rows / stated, axis=1), weight, [0.025, 0.5, 0.975])
    return Scatter(std, np.sqrt(weight @ rows**2), law, ratio)


def _quantiles(
    values: Float[ndarray, " grid"], weight: Float[ndarray, " grid"], shares: list[float]
) -> Float[ndarray, " share"]:
    order = np.argsort(values)
    below = np.cumsum(weight[order]) - 0.5 * weight[order]
    return np.interp(shares, below, values[order])
