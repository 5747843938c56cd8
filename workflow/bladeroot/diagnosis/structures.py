"""What changed matrices do to the stick frequencies of records."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.rom.chebyshev import Surface
from bladeroot.rom.ritz import Pairs, Ritz, solve, turning
from bladeroot.rom.sensitivity import Change

_GRID = 0.2  # of ln kn and ln kt
LEAST = 0.05  # of stiffness and mass, that a change may leave
_CORNERS = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])


class Structures:
    """Change of ln f by changed matrices, from the modes' shapes at the unchanged ones.

    Rayleigh's quotient: the frequency is stationary in the shape. Shapes are worked out on a grid
    of ln kn and ln kt at each force, between whose points the change is interpolated.
    """

    def __init__(
        self, records: Records, ritz: Sequence[Ritz], surface: Surface, known: dict
    ) -> None:
        """Projected problems by mode, the surface whose box their points must lie in, and what is
        known already by mode, force and place on the grid, which is added to.
        """
        self.records, self.ritz, self.surface, self.known = records, ritz, surface, known
        self.forces, self.where = np.unique(records.force, return_inverse=True)
        self.many = np.bincount(self.where)
        self.together: dict = {}  # rows of corners, as they are asked for again and again

    def __call__(
        self,
        one: Mechanism,
        values: ndarray,
        ln_kn: Float[ndarray, " record"],
        ln_kt: Float[ndarray, " record"],
    ) -> tuple[Float[ndarray, " record"], Float[ndarray, "record parameter"]]:
        """Change of ln f of each record, and its derivative by the mechanism's parameters."""
        ln_k = np.array([np.bincount(self.where, part) / self.many for part in (ln_kn, ln_kt)])
        corner, weight = self._place(ln_k.T)
        n = self.records.force.size
        change, slopes = np.zeros(n), np.zeros((n, values.size))
        for mode, ritz in enumerate(self.ritz):
            mine = self.records.mode == mode
            at_shapes, by_values = _of_shapes(ritz, one, values, *self._shapes(mode, corner))

            def between(at_corners: ndarray) -> ndarray:
                at_forces = (at_corners.reshape(weight.shape) * weight).sum(axis=1)
                return at_forces[self.where[mine]]  # noqa: B023 - used in this round only

            change[mine] = between(at_shapes)
            for k, slope in enumerate(by_values):
                slopes[mine, k] = between(slope)
        return change, slopes

    def _place(self, ln_k: Float[ndarray, "force 2"]) -> tuple[ndarray, ndarray]:
        """Places on the grid (force, corner, 2) around each force's ln kn, ln kt; their weights."""
        low, high = self.surface.low[:2], self.surface.high[:2]
        steps = np.clip(ln_k, low, high) / _GRID
        first = np.floor(steps)
        over = (steps - first)[:, None]
        weight = np.where(_CORNERS, over, 1.0 - over).prod(axis=2)
        return first.astype(int)[:, None] + _CORNERS, weight

    def _shapes(self, mode: int, corner: ndarray) -> tuple[ndarray, ndarray]:
        """omega^2 and shape of a mode at every force's corners, in one row."""
        whole = (mode, corner.tobytes())
        if whole in self.together:
            return self.together[whole]
        keys = [
            (mode, force, *place)
            for force, places in zip(self.forces.tolist(), corner.tolist(), strict=True)
            for place in places
        ]
        new = [key for key in dict.fromkeys(keys) if key not in self.known]
        if new:
            places = np.array([(*key[2:], key[1]) for key in new]) * [_GRID, _GRID, 1.0]
            found = solve(self.ritz[mode], np.clip(places, self.surface.low, self.surface.high))
            self.known.update(zip(new, zip(found.value, found.shape, strict=True), strict=True))
        values, shapes = zip(*(self.known[key] for key in keys), strict=True)
        self.together[whole] = np.array(values), np.array(shapes)
        return self.together[whole]


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
    """The same with the shapes at each record's own place (ln k..., load), and the derivative by
    that place.
    """
    n = records.force.size
    change, slopes, along = np.zeros(n), np.zeros((n, values.size)), np.zeros(points.shape)
    for mode, ritz in enumerate(ritzes):
        mine = records.mode == mode
        places, where = distinct(points[mine])
        found = solve(ritz, places)
        here, by_values = _of_shapes(ritz, one, values, found.value, found.shape)
        change[mine] = here[where]
        slopes[mine] = np.reshape(by_values, (values.size, -1)).T[where]
        along[mine] = _by_place(ritz, one, values, places, found)[where]
    return change, slopes, along


def _by_place(
    ritz: Ritz, one: Mechanism, values: ndarray, places: ndarray, found: Pairs
) -> Float[ndarray, "point coordinate"]:
    """Derivative of the change as the shape turns and omega^2 grows with (ln k..., load)."""
    whole, kept, y = one.structure(ritz, values)[0], slice(0, ritz.own), found.shape
    moved, turned = turning(ritz, places, found)

    def share(matrix: ndarray) -> tuple[ndarray, ndarray]:
        times = y @ matrix[kept, kept]
        return (times * y).sum(axis=1)[:, None], 2.0 * np.einsum("pv,pvc->pc", times, turned)

    growth = np.einsum("pv,pvc->pc", y, moved) / found.value[:, None]
    stiff, by_stiff = (part / found.value[:, None] for part in share(whole.stiffness))
    mass, by_mass = share(whole.mass)
    by_stiff = np.where(1.0 + stiff > LEAST, (by_stiff - stiff * growth) / (1.0 + stiff), 0.0)
    by_mass = np.where(1.0 + mass > LEAST, by_mass / (1.0 + mass), 0.0)
    return 0.5 * (by_stiff - by_mass)


def distinct(points: Float[ndarray, "point coordinate"]) -> tuple[ndarray, ndarray]:
    """The different points, and which of them each is; `np.unique` of rows takes far longer."""
    order = np.lexsort(points.T)
    placed = points[order]
    new = np.ones(len(points), dtype=bool)
    new[1:] = (placed[1:] != placed[:-1]).any(axis=1)
    where = np.empty(len(points), dtype=int)
    where[order] = np.cumsum(new) - 1
    return placed[new], where


def _of_shapes(
    ritz: Ritz, one: Mechanism, values: ndarray, own: ndarray, y: ndarray
) -> tuple[ndarray, list[ndarray]]:
    """Change of ln f at shapes of omega^2 `own`, and its derivative by each parameter."""
    whole, parts = one.structure(ritz, values)
    kept = slice(0, ritz.own)

    def share(matrix: ndarray) -> ndarray:
        return ((y @ matrix[kept, kept]) * y).sum(axis=1)

    stiff = np.maximum(1.0 + share(whole.stiffness) / own, LEAST)
    mass = np.maximum(1.0 + share(whole.mass), LEAST)
    slopes = [
        0.5 * (share(part.stiffness) / own / stiff - share(part.mass) / mass) for part in parts
    ]
    return 0.5 * (np.log(stiff) - np.log(mass)), slopes


def shift(whole: Change, parts: Sequence[Change]) -> tuple[float, Float[ndarray, " parameter"]]:
    """Change of ln f of a mode of one degree of freedom, and its derivatives."""
    stiff = max(1.0 + float(whole.stiffness[0, 0]), LEAST)
    mass = max(1.0 + float(whole.mass[0, 0]), LEAST)
    slope = [
        0.5 * (float(part.stiffness[0, 0]) / stiff - float(part.mass[0, 0]) / mass)
        for part in parts
    ]
    return 0.5 * float(np.log(stiff) - np.log(mass)), np.array(slope)
