"""The bench's specimen: reduced beam and slots joined by the springs of the stuck flanks."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray


@dataclass(frozen=True)
class Specimen:
    """Matrices of the clamped specimen without contact springs, and what the bench reads off them.

    `normal` (pair, dof) and `tangential` (2 pair, dof; along Y and along the slope in turn) give
    the displacement of the beam relative to the slot at each pair. `share` is each pair's part of
    its flank's area. `line_x` (m) and `line_z` (point, dof) are the positions along the beam and
    the displacement in the direction of bending.
    """

    mass: Float[ndarray, "dof dof"]
    stiffness: Float[ndarray, "dof dof"]
    normal: Float[ndarray, "pair dof"]
    tangential: Float[ndarray, "slider dof"]
    flank: Int[ndarray, " pair"]
    share: Float[ndarray, " pair"]
    place: Float[ndarray, "pair 2"]
    line_x: Float[ndarray, " point"]
    line_z: Float[ndarray, "point dof"]


def specimen(
    reduced: xr.Dataset,
    force: float,
    modulus_factor: float = 1.0,
    density_factor: float = 1.0,
    added_mass: float = 0.0,
    added_mass_x: float = 0.0,
) -> Specimen:
    """Join a reduced beam and its two slots under an axial force (N); bases are already fixed.

    The factors scale the modulus and density of beam and slots, `added_mass` (kg) sits on the
    beam's middle line at `added_mass_x` (m) and moves in all three directions: the real specimen
    is never quite the analyst's model.

    Raises ValueError if the beam's contact dofs are not three a pair.
    """
    pairs = reduced.sizes["pair"]
    n_beam = reduced.sizes["beam_dof"]
    if n_beam < 3 * pairs:
        raise ValueError(f"expected at least {3 * pairs} beam dofs for {pairs} pairs, got {n_beam}")
    n_slot = reduced.sizes["slot_dof"]
    slots = reduced.sizes["slot"]
    total = n_beam + slots * n_slot
    mass = np.zeros((total, total))
    stiffness = np.zeros((total, total))
    mass[:n_beam, :n_beam] = density_factor * reduced["beam_mass"].values
    stiffness[:n_beam, :n_beam] = (
        modulus_factor * reduced["beam_stiffness"].values
        + force * reduced["beam_geometric_stiffness"].values
    )
    relative = np.zeros((pairs, 3, total))
    for pair in range(pairs):
        relative[pair, :, 3 * pair : 3 * pair + 3] = np.eye(3)
    for slot in range(slots):
        first = n_beam + slot * n_slot
        block = slice(first, first + n_slot)
        mass[block, block] = density_factor * reduced["slot_mass"].values[slot]
        stiffness[block, block] = modulus_factor * reduced["slot_stiffness"].values[slot]
        for k, pair in enumerate(reduced["slot_pairs"].values[slot].astype(int)):
            relative[pair, :, first + 3 * k : first + 3 * k + 3] -= np.eye(3)

    flank = reduced["pair_flank"].values.astype(np.int64)
    local = np.einsum("pla,pad->pld", reduced["flank_frame"].values[flank], relative)
    line_x, rows = _middle_line(reduced, total)
    at_mass = np.array(
        [[np.interp(added_mass_x, line_x, column) for column in rows[:, a].T] for a in range(3)]
    )
    mass += added_mass * at_mass.T @ at_mass
    weight = reduced["pair_weight"].values
    return Specimen(
        mass=(mass + mass.T) / 2,
        stiffness=(stiffness + stiffness.T) / 2,
        normal=local[:, 0],
        tangential=local[:, 1:].reshape(2 * pairs, total),
        flank=flank,
        share=weight / np.bincount(flank, weight)[flank],
        place=_place_on_flank(reduced, flank),
        line_x=line_x,
        line_z=rows[:, 2],
    )


def stuck_stiffness(
    body: Specimen, kn: float, kt: float
) -> tuple[Float[ndarray, "dof dof"], Float[ndarray, " slider"]]:
    """Stiffness with all flanks stuck, and each slider's spring (N/m).

    kn and kt are totals of one flank in N/m; a pair carries its share of the flank's area.
    """
    slider_kt = kt * np.repeat(body.share, 2)
    stiffness = body.stiffness + body.normal.T @ (kn * body.share[:, None] * body.normal)
    stiffness += body.tangential.T @ (slider_kt[:, None] * body.tangential)
    return stiffness, slider_kt


def sensor_row(body: Specimen, x: float) -> Float[ndarray, " dof"]:
    """Row that reads the bending displacement at x (m) on the beam's middle line.

    Raises ValueError outside the line.
    """
    if not body.line_x[0] <= x <= body.line_x[-1]:
        raise ValueError(
            f"expected a position between {body.line_x[0]} and {body.line_x[-1]} m, got {x}"
        )
    return np.array([np.interp(x, body.line_x, column) for column in body.line_z.T])


def _middle_line(
    reduced: xr.Dataset, total: int
) -> tuple[Float[ndarray, " point"], Float[ndarray, "point 3 dof"]]:
    """Points of the middle line sorted by x and their displacement rows over all dofs."""
    x = reduced["display_position"].values[:, 0]
    order = np.argsort(x)
    shape = reduced["display_shape"].values[order]
    rows = np.zeros((len(x), 3, total))
    rows[:, :, : shape.shape[2]] = shape
    return x[order], rows


def _place_on_flank(reduced: xr.Dataset, flank: Int[ndarray, " pair"]) -> Float[ndarray, "pair 2"]:
    """Each pair's place along Y and along the slope, from -1 to 1 between the flank's edges."""
    frames = reduced["flank_frame"].values[flank][:, 1:]
    along = np.einsum("pla,pa->pl", frames, reduced["pair_position"].values)
    place = np.zeros_like(along)
    for which in np.unique(flank):
        here = flank == which
        low, high = along[here].min(axis=0), along[here].max(axis=0)
        half = np.where(high > low, (high - low) / 2, 1.0)
        place[here] = (along[here] - (low + high) / 2) / half
    return place
