"""Which tables contradict each other: a table left out predicted, and sets no geometry meets."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.reproduction.calibration import Calibration, Linear, linearise, posterior

# A number is met within this many standard deviations of its tolerance, a parameter is possible
# within that many of its prior.
MET = 2.0
POSSIBLE = 3.0
# Largest step at once, in prior standard deviations.
_REACH = 1.5


@dataclass(frozen=True)
class LeftOut:
    """A table predicted from the others: z by target, chi^2, and the chance of one as large."""

    table: str
    z: Float[ndarray, " target"]
    chi_square: float
    chance: float


@dataclass(frozen=True)
class Incompatible:
    """Tables that no geometry meets together, while any fewer of them can be met.

    `inflation` is the factor on all tolerances at which the nearest geometry found meets every
    number; `linear` the least such factor by the linear model alone, from which the search starts.
    """

    tables: tuple[str, ...]
    inflation: float
    linear: float
    point: Float[ndarray, " parameter"]


def left_out(asked: Calibration, linear: Linear, fitted: Sequence[str]) -> list[LeftOut]:
    """Each table as the other fitted tables predict it."""
    from scipy.special import gammaincc

    tables = np.array(asked.tables)
    result = []
    for table in dict.fromkeys(asked.tables):
        mine = tables == table
        mean, covariance = posterior(asked, linear, asked.where(fitted) & ~mine)
        jacobian = linear.jacobian[mine]
        spread = jacobian @ covariance @ jacobian.T + asked.covariance[np.ix_(mine, mine)]
        residual = (linear.at(mean) - asked.reference)[mine]
        chi_square = float(residual @ np.linalg.solve(spread, residual))
        chance = float(gammaincc(mine.sum() / 2, chi_square / 2))
        result.append(LeftOut(table, residual / np.sqrt(np.diag(spread)), chi_square, chance))
    return result


def incompatible_sets(asked: Calibration, linear: Linear, refinements: int) -> list[Incompatible]:
    """Smallest sets of tables that no geometry within the priors meets, fewest tables first.

    The linear model proposes a set; up to `refinements` solutions of the whole model, each near the
    best so far, then look for a geometry that meets it after all. A set counts if none does.
    """
    names = list(dict.fromkeys(asked.tables))
    found: list[Incompatible] = []
    for size in range(1, len(names) + 1):
        for tables in combinations(names, size):
            if any(set(one.tables) <= set(tables) for one in found):
                continue
            part = linear.of(asked.where(tables))
            _, worst = _minimax(asked.of(tables), part)
            if worst <= MET:
                continue
            point, refined = _refine(asked.of(tables), part, refinements)
            if refined > MET:
                found.append(Incompatible(tables, refined / MET, worst / MET, point))
    return found


def pair_inflation(asked: Calibration, linear: Linear) -> Float[ndarray, "table table"]:
    """Least factor on tolerances at which both tables of a pair are met, by the linear model."""
    names = list(dict.fromkeys(asked.tables))
    result = np.empty((len(names),) * 2)
    for i, one in enumerate(names):
        for j, other in enumerate(names[: i + 1]):
            part = linear.of(asked.where([one, other]))
            result[i, j] = result[j, i] = _minimax(asked.of([one, other]), part)[1] / MET
    return result


def _refine(asked: Calibration, linear: Linear, count: int) -> tuple[ndarray, float]:
    """Least worst misfit of the whole model, by linear programs within a limited reach."""

    def misfit(there: Linear) -> float:
        return float(np.abs((there.values - asked.reference) / asked.tolerance).max())

    least, reach = misfit(linear), _REACH
    for _ in range(count):
        if least <= MET:
            break
        point, _ = _minimax(asked, linear, reach)
        try:
            there = linearise(asked, point)
        except ValueError:  # a shape that cannot be, or that loses a mode
            reach *= 0.5
            continue
        if misfit(there) < least:
            linear, least = there, misfit(there)
        else:
            reach *= 0.5
    return linear.point, least


def _minimax(
    asked: Calibration, linear: Linear, reach: float = np.inf
) -> tuple[Float[ndarray, " parameter"], float]:
    """Parameters of the least largest misfit (in tolerances), within the priors and a reach.

    `reach` is the largest step from the linear model's point, in prior standard deviations.
    """
    from scipy.optimize import linprog

    std, tolerance = asked.prior.std, asked.tolerance
    slope = linear.jacobian * std / tolerance[:, None]
    misfit = (asked.reference - linear.values) / tolerance
    centre = (asked.prior.mean - linear.point) / std
    low = np.maximum(centre - POSSIBLE, -reach)
    high = np.maximum(np.minimum(centre + POSSIBLE, reach), low)
    ones = np.ones((len(misfit), 1))
    solved = linprog(
        np.r_[np.zeros(len(std)), 1.0],
        A_ub=np.block([[slope, -ones], [-slope, -ones]]),
        b_ub=np.r_[misfit, -misfit],
        bounds=[*zip(low, high, strict=True), (0.0, None)],
    )
    if not solved.success:
        raise ValueError(f"no least misfit of {set(asked.tables)}: {solved.message}")
    return linear.point + std * solved.x[:-1], float(solved.x[-1])
