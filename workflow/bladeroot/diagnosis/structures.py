"""What changed matrices do to the stick frequencies of records."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.rom.ritz import Ritz, solve, turning

LEAST = 0.05  # of stiffness and mass, that a change may leave


def solved_change(
    records: Records,
    ritzes: Sequence[Ritz],
    one: Mechanism,
    values: ndarray,
    points: Float[ndarray, "record coordinate"],
) -> tuple[
    Float[ndarray, " record"],
    Float[ndarray, "record parameter"],
    Float[ndarray, "record coordinate"],
]:
    """Change of ln f of each record by changed matrices, and its derivatives by the mechanism's
    parameters and by the record's place (ln k..., load).

    Rayleigh's quotient with the unchanged shape there: the frequency is stationary in the shape.
    ritzes: projected problems by mode.
    """
    n = records.force.size
    change, slopes, along = np.zeros(n), np.zeros((n, values.size)), np.zeros(points.shape)
    for mode, ritz in enumerate(ritzes):
        mine = records.mode == mode
        places, where = distinct(points[mine])
        parts = _of_mode(ritz, one, values, places)
        change[mine], slopes[mine], along[mine] = (part[where] for part in parts)
    return change, slopes, along


def _of_mode(
    ritz: Ritz, one: Mechanism, values: ndarray, places: ndarray
) -> tuple[ndarray, ndarray, ndarray]:
    """The same of one mode at some places, as the shape turns and omega^2 grows with these."""
    whole, parts = one.structure(ritz, values)
    found, kept = solve(ritz, places), slice(0, ritz.own)
    moved, turned = turning(ritz, places, found)
    own, y = found.value, found.shape

    def share(matrix: ndarray) -> tuple[ndarray, ndarray]:
        times = y @ matrix[kept, kept]
        return (times * y).sum(axis=1), 2.0 * np.einsum("pv,pvc->pc", times, turned)

    growth = np.einsum("pv,pvc->pc", y, moved) / own[:, None]
    (stiff, by_stiff), (mass, by_mass) = share(whole.stiffness), share(whole.mass)
    stiff, by_stiff = stiff / own, by_stiff / own[:, None]
    by_stiff = by_stiff - stiff[:, None] * growth
    left = np.maximum(1.0 + np.stack([stiff, mass]), LEAST)
    along = np.stack([by_stiff, by_mass]) / left[:, :, None]
    along[left == LEAST] = 0.0
    slopes = [
        0.5 * (share(part.stiffness)[0] / own / left[0] - share(part.mass)[0] / left[1])
        for part in parts
    ]
    change = 0.5 * (np.log(left[0]) - np.log(left[1]))
    return change, np.reshape(slopes, (values.size, -1)).T, 0.5 * (along[0] - along[1])


def distinct(points: Float[ndarray, "point coordinate"]) -> tuple[ndarray, ndarray]:
    """The different points, and which of them each is; `np.unique` of rows takes far longer."""
    order = np.lexsort(points.T)
    placed = points[order]
    new = np.ones(len(points), dtype=bool)
    new[1:] = (placed[1:] != placed[:-1]).any(axis=1)
    where = np.empty(len(points), dtype=int)
    where[order] = np.cumsum(new) - 1
    return placed[new], where
