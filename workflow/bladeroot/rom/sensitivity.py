"""What else moves a frequency: added mass, moduli, densities, compliant slots, kn, kt and force.

First and second derivatives by the parameters of the joint and by any linear change of its
matrices, and the frequency under finite changes, all inside the basis of one mode.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.ritz import Ritz, closest, frequency, solve, solve_whole, stiffness_of

SCALES = ("beam_stiffness", "slot_stiffness", "beam_mass", "slot_mass")


@dataclass(frozen=True)
class Change:
    """Stiffness and mass that one unit of a parameter adds, in the basis of one mode."""

    stiffness: Float[ndarray, "vector vector"]
    mass: Float[ndarray, "vector vector"]


def scaled(ritz: Ritz, part: str) -> Change:
    """One unit doubles the part: `beam_stiffness` (modulus), `slot_stiffness`, `beam_mass`, ...

    The geometric stiffness depends on the force alone and is not scaled.
    """
    nothing, unit = np.zeros_like(ritz.beam), np.eye(len(ritz.beam))
    changes = {
        "beam_stiffness": Change(ritz.beam, nothing),
        "slot_stiffness": Change(ritz.slots, nothing),
        "beam_mass": Change(nothing, ritz.beam_mass),
        "slot_mass": Change(nothing, unit - ritz.beam_mass),
    }
    if part not in changes:
        raise ValueError(f"a scaled part must be one of {', '.join(SCALES)}, got {part!r}")
    return changes[part]


def motion(ritz: Ritz, x: float) -> Float[ndarray, "3 vector"]:
    """Motion (X, Y, Z) of the display line at x (m) by basis vector, linear between its nodes."""
    order = np.argsort(ritz.display_x)
    along, rows = ritz.display_x[order], ritz.display[order]
    if not along[0] <= x <= along[-1]:
        raise ValueError(
            f"x must lie on the display line, {along[0]:g} to {along[-1]:g} m, got {x}"
        )
    right = int(np.clip(np.searchsorted(along, x), 1, len(along) - 1))
    share = (x - along[right - 1]) / (along[right] - along[right - 1])
    return (1.0 - share) * rows[right - 1] + share * rows[right]


def added_mass(ritz: Ritz, x: float) -> Change:
    """One unit adds a kilogram at x (m) on the display line, moving with it in X, Y and Z."""
    rows = motion(ritz, x)
    return Change(np.zeros_like(ritz.beam), rows.T @ rows)


def mode_shape(
    ritz: Ritz, points: Float[ndarray, "point coordinate"], x: float
) -> Float[ndarray, "point 3"]:
    """Motion (X, Y, Z) of the display line at x (m) in the mode of unit modal mass, kg^-1/2.

    The sign makes the half of the line at x > 0 move up on the whole, or to Y in a lateral mode.
    """
    return _signed(ritz, points) @ motion(ritz, x)[:, : ritz.own].T


def _signed(ritz: Ritz, points: Float[ndarray, "point coordinate"]) -> Float[ndarray, "point own"]:
    shape = solve(ritz, points).shape
    half = ritz.display[ritz.display_x > 0.0, :, : ritz.own].sum(axis=0)
    moves = shape @ half.T
    largest = moves[np.arange(len(moves)), np.abs(moves).argmax(axis=1)]
    return np.sign(largest)[:, None] * shape


def derivatives(
    ritz: Ritz, points: Float[ndarray, "point coordinate"], changes: Sequence[Change] = ()
) -> tuple[
    Float[ndarray, " point"],
    Float[ndarray, "point parameter"],
    Float[ndarray, "point parameter parameter"],
]:
    """Frequency (Hz), gradient and Hessian by ln kn, ln kt, F (N) and then each change's amount.

    lambda_a = phi'(K_a - lambda M_a) phi; the second derivatives add the sum over the other modes
    of the basis (section 5.3; Fox and Kapoor 1968). Ends at zero amounts.
    """
    pairs = solve_whole(ritz, points)
    y, value = pairs.shape, pairs.value
    normal, tangential = ritz.gap.T @ ritz.gap, ritz.slip.T @ ritz.slip
    kn, kt = np.exp(points[:, :2].T)[:, :, None]
    one = np.ones_like(kn)
    nothing = np.zeros_like(normal)
    parts = [(kn, normal, nothing), (kt, tangential, nothing), (one, ritz.geometric, nothing)]
    parts += [(one, change.stiffness, change.mass) for change in changes]
    # (K_a - lambda M_a) phi of each parameter, seen by every mode of the basis
    forces = np.stack([s * (y @ k) - value[:, None] * (y @ m) for s, k, m in parts], axis=1)
    seen = np.einsum("pai,piv->pav", forces, pairs.shapes)
    slope = np.einsum("pai,pi->pa", forces, y)
    slope[:, 0] = kn[:, 0] * ((y @ ritz.gap.T) ** 2).sum(axis=1)
    slope[:, 1] = kt[:, 0] * ((y @ ritz.slip.T) ** 2).sum(axis=1)
    masses = np.stack([((y @ m) * y).sum(axis=1) for _, _, m in parts], axis=1)
    distance = value[:, None] - pairs.values
    distance[np.arange(len(points)), pairs.place] = np.inf
    curve = 2.0 * np.einsum("pav,pbv,pv->pab", seen, seen, 1.0 / distance, optimize=True)
    mixed = slope[:, :, None] * masses[:, None, :]
    curve -= mixed + mixed.transpose(0, 2, 1)
    for axis in (0, 1):  # a stiffness is its own derivative by its logarithm
        curve[:, axis, axis] += slope[:, axis]
    f = frequency(value)
    gradient = slope / (8.0 * np.pi**2 * f)[:, None]
    hessian = curve / (8.0 * np.pi**2 * f)[:, None, None]
    hessian -= gradient[:, :, None] * gradient[:, None, :] / f[:, None, None]
    return f, gradient, hessian


def changed_frequencies(
    ritz: Ritz,
    points: Float[ndarray, "point coordinate"],
    changes: Sequence[Change],
    amounts: Float[ndarray, "point change"],
) -> Float[ndarray, " point"]:
    """Frequency (Hz) with finite amounts of each change; the unchanged shape tells the mode."""
    stiffness = stiffness_of(ritz, points)
    mass = np.broadcast_to(np.eye(len(ritz.beam)), stiffness.shape).copy()
    for change, amount in zip(changes, amounts.T, strict=True):
        stiffness += amount[:, None, None] * change.stiffness
        mass += amount[:, None, None] * change.mass
    root = np.linalg.inv(np.linalg.cholesky(mass))
    values, shapes = np.linalg.eigh(root @ stiffness @ root.transpose(0, 2, 1))
    before = np.zeros((len(points), len(ritz.beam)))
    before[:, : ritz.own] = solve(ritz, points).shape
    place = closest(root.transpose(0, 2, 1) @ shapes, before)
    return frequency(values[np.arange(len(points)), place])
