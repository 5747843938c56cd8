"""What the extension is worth on data that the fit has not seen."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int
from numpy import ndarray

from bladeroot.diagnosis.naming import Found
from bladeroot.inference.gaussian import Fit
from bladeroot.inference.hold_out import hold_out


@dataclass(frozen=True)
class Score:
    """Held-out error (rms of the parts' means by group) before and after, and both log scores."""

    error: tuple[float, float]
    log_score: tuple[float, float]
    by_group: dict[int, tuple[float, float]]


def score(
    found: Found, part: str, group: Int[ndarray, " datum"], allowance: slice = slice(0)
) -> Score:
    """Leave out every force, or every hold, once with the baseline and once with the causes.

    group: number of each datum's mode or quantity; an error is the mean miss of a part's data of
    one group, so that records of one hold count once. allowance: as of `hold_out`.
    """
    parts = found.channel.part[part]
    sides = [_side(fitted, parts, group, allowance) for fitted in (found.baseline, found.final)]
    groups = {int(g): (sides[0][1][int(g)], sides[1][1][int(g)]) for g in np.unique(group)}
    return Score((sides[0][0], sides[1][0]), (sides[0][2], sides[1][2]), groups)


def _side(
    fitted: Fit, parts: ndarray, group: ndarray, allowance: slice
) -> tuple[float, dict[int, float], float]:
    held = hold_out(fitted, parts, allowance)
    means: dict[int, list[float]] = {int(g): [] for g in np.unique(group)}
    for g, rows in means.items():
        for p in np.unique(parts[group == g]):
            rows.append(float(held.error[(group == g) & (parts == p)].mean()))
    every = np.concatenate([np.array(rows) for rows in means.values()])
    each = {g: float(np.sqrt(np.mean(np.square(rows)))) for g, rows in means.items()}
    return float(np.sqrt(np.mean(every**2))), each, float(held.log_score.sum())


def within_records(
    found: Found, quantity: Int[ndarray, " datum"]
) -> dict[str, tuple[float, float]]:
    """Rms miss of the curves at forces left out, before and after, by quantity."""
    sides = [
        hold_out(fitted, found.channel.part["force"]).error
        for fitted in (found.baseline, found.final)
    ]
    return {
        name: tuple(float(np.sqrt(np.mean(side[quantity == q] ** 2))) for side in sides)
        for q, name in enumerate(("frequency", "loss_factor"))
    }
