"""What several causes together change of the records' stick frequencies.

They act on each other as on the specimen: a law of the axial force takes the true force, as the
other causes change it, not the gauge's reading; and what changed matrices do to a frequency depends
on the contact stiffness as the other causes change it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.inference.problem import Prior
from bladeroot.mechanisms.mechanism import COORDINATES, Mechanism, Records

_FORCE = COORDINATES.index("force")
_STEP = 1e-4  # of a force, for slopes by differences
_LEAST = 1e-3  # of the gauge's reading: a joint is held by more, and never by a negative force


@dataclass(frozen=True)
class Causes:
    """Changes by `COORDINATES` (force in N).

    changes: of all together. effects: of each alone, and, to first order, what laws of the force
    make of its change of the force. slopes: derivatives of `changes` by each cause's own
    coordinates in the fit, shape (record, 4, own). by_place: derivatives of what changed matrices
    do by the record's place (ln k..., load). inside: whether every record is left a force; where it
    is not, it has the least.
    """

    changes: Float[ndarray, "record 4"]
    effects: Float[ndarray, "cause record 4"]
    slopes: list[ndarray]
    by_place: ndarray | float
    inside: bool = True


def causes(
    mechanisms: Sequence[Mechanism],
    theta: Float[ndarray, " parameter"],
    records: Records,
    structures: Callable[[Mechanism, ndarray, ndarray], tuple[ndarray, ndarray, ndarray]],
) -> Causes:
    """At coordinates `theta` of all mechanisms in order.

    structures: takes a mechanism, its values, and the others' changes of ln kn and ln kt; returns
    the change of ln f by its changed matrices, and the derivatives by the values and the place.
    """
    pairs = zip(mechanisms, places(mechanisms), strict=True)
    asked = [(one, *one.values(theta[own])) for one, own in pairs]
    n = records.force.size
    own = [np.zeros((n, 4)) for _ in asked]
    through = [np.zeros((n, 4)) for _ in asked]  # by way of the force, in the laws of others
    slopes = [np.zeros((n, 4, len(one.parameters))) for one in mechanisms]
    laws = [k for k, one in enumerate(mechanisms) if one.stick is not None]
    for k in laws:
        own[k], slopes[k] = of_law(*asked[k], records)
    moving = [k for k in laws if mechanisms[k].moves_load and slopes[k][:, _FORCE].any()]
    there = records.force + sum(own[k][:, _FORCE] for k in moving)
    force = np.maximum(there, _LEAST * records.force)
    for k in laws if moving else ():
        if k in moving or "force" not in mechanisms[k].over:
            continue
        own[k], slopes[k] = of_law(*asked[k], replace(records, force=force))
        beyond, _ = of_law(*asked[k], replace(records, force=(1.0 + _STEP) * force))
        rate = (beyond - own[k]) / (_STEP * force)[:, None]
        for i in moving:
            through[i] += rate * own[i][:, [_FORCE]]
            slopes[i] = slopes[i] + rate[:, :, None] * slopes[i][:, [_FORCE]]
    by_place: ndarray | float = 0.0
    ln_k = sum((changes[:, :2].T for changes in own), np.zeros((2, n)))
    for k, (one, values, chain) in enumerate(asked):
        if one.structure is not None:
            change, slope, further = structures(one, values, ln_k)
            own[k][:, 3], slopes[k][:, 3] = change, slope * chain
            by_place = by_place + further
    effects = np.array([a + b for a, b in zip(own, through, strict=True)]).reshape(-1, n, 4)
    changes = sum(own, np.zeros((n, 4)))
    changes[:, _FORCE] += force - there
    return Causes(changes, effects, slopes, by_place, bool((force == there).all()))


def places(mechanisms: Sequence[Mechanism], first: int = 0) -> list[slice]:
    """Where each mechanism's parameters stand in a fit, from `first` on."""
    ends = accumulate((len(one.parameters) for one in mechanisms), initial=first)
    return [slice(*pair) for pair in pairwise(ends)]


def with_causes(
    mean: Float[ndarray, " base"], std: Float[ndarray, " base"], mechanisms: Sequence[Mechanism]
) -> Prior:
    """A baseline's priors, and those of its causes behind them."""
    return Prior(
        np.concatenate([mean, *(one.start for one in mechanisms)]),
        np.concatenate([std, *(one.std for one in mechanisms)]),
    )


def with_smooth(
    scales: Sequence[tuple[float, float]], extra: Sequence[tuple[ndarray, float]]
) -> Prior:
    """Priors of ln of scales, and of a smooth competitor's sizes (`extra`) behind them."""
    return Prior(*np.array([*scales, *((np.log(size), 1.5) for _, size in extra)], float).T)


def of_law(
    one: Mechanism, values: ndarray, chain: ndarray, records: Records
) -> tuple[Float[ndarray, "record 4"], Float[ndarray, "record 4 parameter"]]:
    """What a mechanism's `stick` changes, and the slopes by the fit's coordinates."""
    effect, n = one.stick(records, values), records.force.size
    changes, slopes = np.zeros((n, 4)), np.zeros((n, 4, values.size))
    for axis, name in enumerate(COORDINATES):
        if name in effect.changes:
            changes[:, axis], slopes[:, axis] = effect.changes[name], effect.slopes[name] * chain
    return changes, slopes


def of_load(
    mechanisms: Sequence[Mechanism],
    theta: Float[ndarray, " parameter"],
    force: Float[ndarray, " force"],
) -> tuple[Float[ndarray, "force 4"], list[Float[ndarray, "force 4 own"]]]:
    """What laws of the load alone change of kn and kt at loads, and the slopes by each cause's."""
    none = np.zeros(force.size)
    at = Records(none.astype(int), force, none, none, none, 0.0, 0.0)
    changes = np.zeros((force.size, 4))
    slopes = [np.zeros((force.size, 4, len(one.parameters))) for one in mechanisms]
    for k, (one, own) in enumerate(zip(mechanisms, places(mechanisms), strict=True)):
        if one.stick is not None and one.over == ("force",):
            change, slope = of_law(one, *one.values(theta[own]), at)
            changes[:, :2] += change[:, :2]
            slopes[k][:, :2] = slope[:, :2]
    return changes, slopes
