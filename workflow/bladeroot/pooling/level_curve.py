"""The mean curve of one level over amplitude: one estimator for inferences, figures and report.

A record's curve is its own level plus a change with amplitude that all records of the level share:

    y_i(A) = level_i + change(A) + repeat_i(A) + error_i(A)

A record's level is its plateau; without one, what its distance from the others makes it, by least
squares. Levels are taken off before the mean, so that what a clamping or the gauge does to them
drops out and a record that begins or ends makes no step. The mean is a plain one: weights by the
stated errors make it 10 to 17 % sharper where records' noise differs tenfold, but where few records
differ beyond their errors they cover less (91 instead of 95 % of drawn points). The covariance is
that of this sum: of errors that are one along a record, of its level, of what the motion's other
modes may do, and of what repeats differ beyond all that.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

POINTS_A_DECADE = 40  # of amplitude, on the ladder where records are compared
# Distance in ln A over which the errors of a curve's points are alike: by exp(-distance over it).
ERROR_LENGTH = 1.0  # where a record does not say its own
_LEAST_ERROR_LENGTH = 0.05
# Variables of a record, if it has them: what the motion's other modes may change of frequency and
# loss factor, alike in all records.
COUPLING_VARIABLES = ("frequency_coupling", "loss_factor_coupling")


@dataclass(frozen=True)
class LevelCurve:
    """Points of one level by rising amplitude (m), first of ln f, then of the loss factor.

    mean: less the records' levels. stated: covariance by the records' own errors, their plateaus'
    and other modes' among them. repeats: by what records differ beyond that; scatter: its standard
    deviation of one record. own: each record's level, NaN of one without a point; own_std: its
    plateau's error, or that of the mean of independent points. records: how many reach a point.
    stuck: whether any has a plateau; plateau_loss: mean loss factor of the plateaus, or the curves'
    least.
    """

    amplitude: Float[ndarray, " point"]
    mean: Float[ndarray, "2 point"]
    stated: Float[ndarray, "2 point point"]
    repeats: Float[ndarray, "2 point point"]
    scatter: Float[ndarray, "2 point"]
    own: Float[ndarray, "2 record"]
    own_std: Float[ndarray, "2 record"]
    records: Int[ndarray, " point"]
    stuck: bool
    plateau_loss: float


def level_curve(seen: xr.Dataset, spacing: int = 1, reach: float = np.inf) -> LevelCurve | None:
    """The curve of the records of one level; None where they have none.

    seen: these records of `bladeroot.diagnosis.observations`, or of `on_one_ladder`. spacing:
    ladder's points from one that is used to the next. reach: from the largest amplitude down.
    """
    amplitude = seen["amplitude"].values
    f, loss = seen["frequency"].values, seen["loss_factor"].values
    stds = seen["frequency_std"].values / f, seen["loss_factor_std"].values
    known = np.isfinite(f * loss) & np.isfinite(stds).all(axis=0)
    reached = np.flatnonzero(known.any(axis=0))
    if not reached.size:
        return None
    reached = reached[amplitude[reached] * reach >= amplitude[reached[-1]]]
    chosen = reached[::-1][::spacing][::-1]
    stuck = seen["stick_frequency"].values, seen["stick_loss_factor"].values
    stuck_std = seen["stick_frequency_std"].values / stuck[0], seen["stick_loss_factor_std"].values
    length = np.nan_to_num(seen["correlation_decades"].values, nan=ERROR_LENGTH)
    distance = np.abs(np.log(amplitude[chosen])[:, None] - np.log(amplitude[chosen]))
    smooth = np.exp(-distance[None] / np.maximum(length, _LEAST_ERROR_LENGTH)[:, None, None])
    count = known[:, chosen].sum(axis=0)
    share, reaching = known[:, chosen] / count, known.any(axis=1)
    found = []
    for value, std, plateau, plateau_std, name in zip(
        (np.log(f), loss),
        stds,
        (np.log(stuck[0]), stuck[1]),
        stuck_std,
        COUPLING_VARIABLES,
        strict=True,
    ):
        std = np.where(known, std, 0.0)
        held = np.isfinite(plateau)
        middle = plateau[held].mean() if held.any() else 0.0
        own = middle + record_levels(value - middle, known.astype(float), plateau - middle)
        left = np.where(share > 0.0, (value - own[:, None])[:, chosen], 0.0)
        mean, error = (share * left).sum(axis=0), share * std[:, chosen]
        scatter = _beyond(left - mean, std[:, chosen], share)
        # The error of a record's level is a step of the mean where that record begins or ends. Of
        # one without a plateau it is that of a point; of levels without any, their differences'.
        point_std = np.array(
            [np.median(s[k]) if k.any() else 0.0 for s, k in zip(std, known, strict=True)]
        )
        doubt = np.where(held, np.nan_to_num(plateau_std), point_std)[:, None]
        step = doubt * (share - (0.0 if held.any() else (reaching / reaching.sum())[:, None]))
        stated = (error[:, :, None] * error[:, None] * smooth).sum(axis=0) + step.T @ step
        if not held.any():  # the curve begins with zero, where it is well known
            sharp = np.diag(stated) <= np.median(np.diag(stated))
            own, mean = own + mean[sharp][0], mean - mean[sharp][0]
        if name in seen:
            others = (share * np.nan_to_num(seen[name].values[:, chosen])).sum(axis=0)
            stated += np.outer(others, others) * np.exp(-distance)
        more = scatter / np.sqrt(count)
        repeats = np.outer(more, more) * np.exp(-distance)
        own = np.where(reaching, own, np.nan)
        own_std = np.where(held, plateau_std, point_std / np.sqrt(known.sum(axis=1).clip(1)))
        found.append((mean, stated, repeats, scatter, own, own_std))
    reaches = bool(np.isfinite(stuck[0]).any())
    plateau_loss = float(np.nanmean(stuck[1]) if np.isfinite(stuck[1]).any() else loss[known].min())
    parts = (np.array(part) for part in zip(*found, strict=True))
    return LevelCurve(amplitude[chosen], *parts, count, reaches, plateau_loss)


def _beyond(
    off: Float[ndarray, "record point"],
    std: Float[ndarray, "record point"],
    share: Float[ndarray, "record point"],
) -> Float[ndarray, " point"]:
    """Standard deviation by which repeats differ beyond their stated errors.

    Beside another mode, or after a blow, records are worse than they say, each in its own way.
    Points of one record have that of the nearest point of several.
    """
    here = share > 0.0
    count = here.sum(axis=0)
    several = np.flatnonzero(count > 1)
    if not several.size:
        return np.zeros(count.size)
    square = np.where(here, off**2, 0.0).sum(axis=0) / np.maximum(count - 1, 1)
    more = np.sqrt(np.maximum(square - (share * std**2).sum(axis=0), 0.0))
    return more[several[np.abs(np.arange(count.size)[:, None] - several).argmin(axis=1)]]


def record_levels(
    value: Float[ndarray, "record amplitude"],
    weight: Float[ndarray, "record amplitude"],
    given: Float[ndarray, " record"] | None = None,
) -> Float[ndarray, " record"]:
    """How far each record lies above the others: least squares of record + amplitude.

    given: levels that are known, NaN for the rest. Without any, levels sum to zero over records
    that are linked by common amplitudes; others are not compared, and have zero.
    """
    value = np.where(weight > 0.0, value, 0.0)
    total = weight.sum(axis=0)
    share = weight / np.where(total > 0.0, total, 1.0)
    normal = np.diag(weight.sum(axis=1)) - share @ weight.T
    right = (weight * (value - (share * value).sum(axis=0))).sum(axis=1)
    level = np.zeros(len(value)) if given is None else np.nan_to_num(given)
    free = np.full(len(value), True) if given is None else np.isnan(given)
    left = (right - normal @ level)[free]
    level[free] = np.linalg.pinv(normal[np.ix_(free, free)], rcond=1e-12, hermitian=True) @ left
    return level


def on_one_ladder(
    decays: Sequence[xr.Dataset | None], ladder: Float[ndarray, " amplitude"]
) -> dict[str, Float[ndarray, "record amplitude"]]:
    """Curves of the records at the ladder's amplitudes; NaN where there is none."""
    nowhere = np.full(ladder.size, np.nan)
    return {
        name: np.array(
            [nowhere if decay is None else on_ladder(decay, name, ladder) for decay in decays]
        ).reshape(len(decays), ladder.size)
        for name in ("frequency", "frequency_std", "loss_factor", "loss_factor_std")
    }


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
