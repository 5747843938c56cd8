"""The curve of one level over amplitude: its records' mean excess over their plateaus, with errors.

Each record is counted from its own stick frequency and loss factor, so that what a clamping or the
gauge does to these drops out. The inference with curves and the diagnosis read levels so, from
curves that are brought to one ladder of amplitudes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int
from numpy import ndarray

POINTS_A_DECADE = 40  # of amplitude, on the ladder where records are compared
LENGTH = 1.0  # in ln A, over which a curve's errors are one, where its record does not say
_LEAST_LENGTH = 0.05
# What the motion's other modes may change of the two, where the records say: alike in all of them.
COUPLING = ("frequency_coupling", "loss_factor_coupling")


@dataclass(frozen=True)
class LevelCurve:
    """Points of one level by rising amplitude (m), first of ln f, then of the loss factor.

    stated: covariance by the records' own errors, their plateaus' and other modes' among them.
    repeats: by what records differ beyond that. records: how many reach a point. stuck: whether any
    has a plateau; plateau_loss: mean loss factor of the plateaus, or the curves' least.
    """

    amplitude: Float[ndarray, " point"]
    mean: Float[ndarray, "2 point"]
    stated: Float[ndarray, "2 point point"]
    repeats: Float[ndarray, "2 point point"]
    records: Int[ndarray, " point"]
    stuck: bool
    plateau_loss: float


def level_curve(seen: xr.Dataset, spacing: int = 1, reach: float = np.inf) -> LevelCurve | None:
    """The curve of the records of one level; None where they have none.

    seen: these records of `bladeroot.diagnosis.observations`. spacing: ladder's points from one
    that is used to the next. reach: from the largest amplitude down.
    """
    amplitude = seen["amplitude"].values
    f, loss = seen["frequency"].values, seen["loss_factor"].values
    stds = seen["frequency_std"].values / f, seen["loss_factor_std"].values
    known = np.isfinite(f) & np.isfinite(loss) & np.isfinite(stds[0]) & np.isfinite(stds[1])
    reached = np.flatnonzero(known.any(axis=0))
    if not reached.size:
        return None
    reached = reached[amplitude[reached] * reach >= amplitude[reached[-1]]]
    chosen = reached[::-1][::spacing][::-1]
    stuck = seen["stick_frequency"].values, seen["stick_loss_factor"].values
    stuck_std = seen["stick_frequency_std"].values / stuck[0], seen["stick_loss_factor_std"].values
    mask = known[:, chosen]
    count = mask.sum(axis=0)
    length = np.nan_to_num(seen["correlation_decades"].values, nan=LENGTH)
    distance = np.abs(np.log(amplitude[chosen])[:, None] - np.log(amplitude[chosen]))
    smooth = np.exp(-distance[None] / np.maximum(length, _LEAST_LENGTH)[:, None, None])
    means, stated, repeats = [], [], []
    for value, std, plateau, plateau_std, name in zip(
        (np.log(f), loss), stds, (np.log(stuck[0]), stuck[1]), stuck_std, COUPLING, strict=True
    ):
        line = _less_plateau(value, known, plateau)[:, chosen]
        means.append(np.where(mask, line, 0.0).sum(axis=0) / count)
        own = np.where(mask, std[:, chosen], 0.0) / count
        # The error of a record's plateau is a step of the mean where that record begins or ends.
        step = np.nan_to_num(plateau_std)[:, None] * mask / count
        stated.append((own[:, :, None] * own[:, None] * smooth).sum(axis=0) + step.T @ step)
        if name in seen:
            others = np.where(mask, seen[name].values[:, chosen], 0.0).sum(axis=0) / count
            stated[-1] += np.outer(others, others) * np.exp(-distance)
        more = _beyond(line, std[:, chosen], mask)
        repeats.append(np.outer(more, more) * np.exp(-distance))
    reaches = bool(np.isfinite(stuck[0]).any())
    plateau_loss = float(np.nanmean(stuck[1]) if np.isfinite(stuck[1]).any() else loss[known].min())
    parts = (np.array(part) for part in (means, stated, repeats))
    return LevelCurve(amplitude[chosen], *parts, count, reaches, plateau_loss)


def _beyond(
    line: Float[ndarray, "record point"],
    std: Float[ndarray, "record point"],
    mask: Bool[ndarray, "record point"],
) -> Float[ndarray, " point"]:
    """Standard error of the mean of repeats by what they differ beyond their stated errors.

    Beside another mode, or after a blow, records are worse than they say, each in its own way.
    Points of one record have that of the nearest point of several.
    """
    count = mask.sum(axis=0)
    here = np.where(mask, line, 0.0)
    off = np.where(mask, line - here.sum(axis=0) / count, 0.0)
    freedom = np.maximum(count - 1, 1)
    stated = np.where(mask, std**2, 0.0).sum(axis=0) / count
    more = np.maximum((off**2).sum(axis=0) / freedom - stated, 0.0)
    several = np.flatnonzero(count > 1)
    if not several.size:
        return np.zeros(count.size)
    nearest = several[np.abs(np.arange(count.size)[:, None] - several).argmin(axis=1)]
    return np.sqrt(more[nearest] / count)


def _less_plateau(
    line: Float[ndarray, "record amplitude"],
    known: Bool[ndarray, "record amplitude"],
    plateau: Float[ndarray, " record"],
) -> Float[ndarray, "record amplitude"]:
    """Curves less their plateaus; one without lies as the others' mean where they overlap."""
    have = np.isfinite(plateau)
    left = np.where(known, line, np.nan) - np.where(have, plateau, np.nan)[:, None]
    order = np.argsort(~have, kind="stable")
    for i in order[have.sum() :]:
        own = np.where(known[i], line[i], np.nan)
        others = np.isfinite(left) & known[i]
        if others.any():
            total = np.where(others, left, 0.0).sum(axis=0)
            middle = total / np.maximum(others.sum(axis=0), 1)
            left[i] = own - np.mean((own - middle)[others.any(axis=0)])
        else:
            left[i] = own - own[np.flatnonzero(known[i])[0]] if known[i].any() else own
    return left


def ladder_of(
    decays: Sequence[xr.Dataset], points_a_decade: int = POINTS_A_DECADE
) -> Float[ndarray, " amplitude"]:
    """Amplitudes evenly spaced in their logarithm, at places that no record can shift."""
    if not decays:
        return np.zeros(0)
    low = min(float(decay["amplitude"].min()) for decay in decays)
    high = max(float(decay["amplitude"].max()) for decay in decays)
    first = np.ceil(points_a_decade * np.log10(low))
    last = np.floor(points_a_decade * np.log10(high))
    return 10.0 ** (np.arange(first, last + 1) / points_a_decade)


def on_ladder(decay: xr.Dataset, name: str, ladder: ndarray) -> Float[ndarray, " amplitude"]:
    """A record's curve at the ladder's amplitudes, NaN beyond what it reaches."""
    value, amplitude = decay[name].values, decay["amplitude"].values
    known = np.isfinite(value) & np.isfinite(amplitude)
    if known.sum() < 2:
        return np.full(ladder.size, np.nan)
    order = np.argsort(amplitude[known])
    x, y = np.log(amplitude[known][order]), value[known][order]
    return np.interp(np.log(ladder), x, y, left=np.nan, right=np.nan)


def levels_of(
    value: Float[ndarray, "record amplitude"], weight: Float[ndarray, "record amplitude"]
) -> Float[ndarray, " record"]:
    """How far each record lies above the others: least squares of record + amplitude.

    They sum to zero over records that are linked by common amplitudes; others are not compared.
    """
    value = np.where(weight > 0.0, value, 0.0)
    total = weight.sum(axis=0)
    share = weight / np.where(total > 0.0, total, 1.0)
    normal = np.diag(weight.sum(axis=1)) - share @ weight.T
    right = (weight * (value - (share * value).sum(axis=0))).sum(axis=1)
    return np.linalg.pinv(normal, rcond=1e-12, hermitian=True) @ right
