"""What the extension is worth on data that the fit has not seen."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int
from numpy import ndarray

from bladeroot.diagnosis.naming import Found
from bladeroot.inference.hold_out import hold_out


@dataclass(frozen=True)
class Score:
    """Before and after, of data left out: rms of the parts' means, of all and by group; rms of
    every datum by group; log score.
    """

    error: tuple[float, float]
    log_score: tuple[float, float]
    by_group: dict[int, tuple[float, float]]
    of_data: dict[int, tuple[float, float]]


def score(
    found: Found, part: str, group: Int[ndarray, " datum"], allowance: slice = slice(0)
) -> Score:
    """Leave out every force, or every hold, once with the baseline and once with the causes.

    group: number of each datum's mode or quantity; the mean miss of a part's data of one group is
    one error, so that records of one hold count once. allowance: as of `hold_out`.
    """
    parts = found.channel.part[part]
    held = [hold_out(fitted, parts, allowance) for fitted in (found.baseline, found.final)]
    means: dict[int, list] = {}
    for g in np.unique(group):
        here = [(group == g) & (parts == p) for p in np.unique(parts[group == g])]
        means[int(g)] = [[float(side.error[rows].mean()) for rows in here] for side in held]

    def both(sides: Iterable) -> tuple[float, float]:
        before, after = (float(np.sqrt(np.mean(np.square(side)))) for side in sides)
        return before, after

    return Score(
        both(np.concatenate([own[k] for own in means.values()]) for k in (0, 1)),
        (float(held[0].log_score.sum()), float(held[1].log_score.sum())),
        {g: both(own) for g, own in means.items()},
        {g: both(side.error[group == g] for side in held) for g in means},
    )
