"""One mode of the joint in a small basis of its own: frequency, shape, derivatives.

The basis holds shapes of one mode, and of lower ones that it mixes with, at many points. There the
mode keeps its rank, and its frequency, being stationary, is wrong only by the square of what the
basis misses. Vectors that come after the first `own` serve perturbations: what an added mass or
another modulus does to the shape.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg.lapack import dsyevr


@dataclass(frozen=True)
class Ritz:
    """Projections of one mode; the projected mass is the identity.

    beam, slots: stiffness without contact and force, 1/s^2. geometric: per newton, 1/(s^2 N).
    springs: of each contact stiffness, the factor whose square is what 1 N/m adds, kg^-1/2; gap and
    slip are kn's and kt's of a single interface. beam_mass: the beam's share of the mass. contact:
    motion across each pair by local axis, display: motion of the display nodes at `display_x` (m),
    kg^-1/2. residual: factor of the residual's dual norm over (own vector, [K0, Kg, Kc..., M]).
    own: how many vectors are the mode's own. rank: how many lower modes are in them. amplification:
    how much the nearest neighbour enlarges the error.
    """

    beam: Float[ndarray, "vector vector"]
    slots: Float[ndarray, "vector vector"]
    geometric: Float[ndarray, "vector vector"]
    springs: tuple[Float[ndarray, "vector vector"], ...]
    beam_mass: Float[ndarray, "vector vector"]
    contact: Float[ndarray, "pair 3 vector"]
    display: Float[ndarray, "display 3 vector"]
    display_x: Float[ndarray, " display"]
    residual: Float[ndarray, "row part"]
    own: int
    rank: int
    amplification: float


@dataclass(frozen=True)
class Pairs:
    """Eigenpairs of a projected problem at many points.

    value, shape: the mode's omega^2 (1/s^2) and shape of unit modal mass.
    """

    value: Float[ndarray, " point"]
    shape: Float[ndarray, "point vector"]


def solve(ritz: Ritz, points: Float[ndarray, "point coordinate"]) -> Pairs:
    """Eigenpairs at points (ln k..., F) in the mode's own vectors.

    By bisection for the mode alone: all eigenpairs of a stack would take three times as long.
    """
    kept = slice(0, ritz.own)
    body, geometric, *springs = (
        part[kept, kept] for part in (ritz.beam + ritz.slots, ritz.geometric, *ritz.springs)
    )
    shape, one = np.empty((len(points), len(body))), ritz.rank + 1
    for place, matrix in zip(shape, stiffness_of(body, geometric, springs, points), strict=True):
        _, found, _, _, fault = dsyevr(matrix, range="I", il=one, iu=one)
        if fault:
            raise np.linalg.LinAlgError(f"a projected mode was not found (dsyevr: {fault})")
        place[:] = found[:, 0]
    return Pairs(quotient(body, geometric, springs, shape, points), shape)


def turning(
    ritz: Ritz, points: Float[ndarray, "point coordinate"], found: Pairs
) -> tuple[Float[ndarray, "point vector coordinate"], Float[ndarray, "point vector coordinate"]]:
    """Derivatives by (ln k..., F) of the stiffness times a mode's shape, and of the shape itself.

    The latter solves (K - omega^2) y' = -(K' - omega^2') y, y' without a part of y (Nelson 1976),
    here as one bordered system for all coordinates.
    """
    kept, shape = slice(0, ritz.own), found.shape
    body, geometric, *springs = (
        part[kept, kept] for part in (ritz.beam + ritz.slots, ritz.geometric, *ritz.springs)
    )
    moved = [k[:, None] * (shape @ (rows.T @ rows))
             for k, rows in zip(np.exp(points[:, :-1].T), springs, strict=True)]  # fmt: skip
    moved = np.stack([*moved, shape @ geometric], axis=2)
    own = np.einsum("pv,pvc->pc", shape, moved)
    count, size = shape.shape
    system = np.zeros((count, size + 1, size + 1))
    system[:, :size, :size] = stiffness_of(body, geometric, springs, points)
    system[:, range(size), range(size)] -= found.value[:, None]
    system[:, size, :size] = system[:, :size, size] = found.value[:, None] * shape
    right = np.zeros((count, size + 1, moved.shape[2]))
    right[:, :size] = own[:, None] * shape[:, :, None] - moved
    return moved, np.linalg.solve(system, right)[:, :size]


def stiffness_of(body, geometric, springs, points) -> ndarray:
    """Projected stiffness at points (ln k..., F), 1/s^2."""
    parts = np.stack([body, geometric, *(rows.T @ rows for rows in springs)])
    weights = np.column_stack([np.ones(len(points)), points[:, -1], np.exp(points[:, :-1])])
    return (weights @ parts.reshape(len(parts), -1)).reshape(-1, *body.shape)


def quotient(
    body: Float[ndarray, "vector vector"],
    geometric: Float[ndarray, "vector vector"],
    springs: Sequence[Float[ndarray, "_ vector"]],
    shape: Float[ndarray, "point vector"],
    points: Float[ndarray, "point coordinate"],
) -> Float[ndarray, " point"]:
    """Rayleigh's quotient of shapes of unit mass; the contact's part from the gaps themselves.

    An eigenvalue solver rounds by the largest eigenvalue, a stiff contact's; this does not.
    """
    whole = ((shape @ body) * shape).sum(axis=1)
    whole = whole + points[:, -1] * ((shape @ geometric) * shape).sum(axis=1)
    for k, rows in zip(np.exp(points[:, :-1].T), springs, strict=True):
        whole = whole + k * ((shape @ rows.T) ** 2).sum(axis=1)
    return whole


def frequency(value: Float[ndarray, "*shape"]) -> Float[ndarray, "*shape"]:
    """Hz, of omega^2."""
    return np.sqrt(value) / (2.0 * np.pi)
