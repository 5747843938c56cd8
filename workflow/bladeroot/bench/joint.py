"""The bench's specimen: reduced beam and slots joined by the springs of the stuck flanks."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray


@dataclass(frozen=True, eq=False)  # told apart by identity, so that results can be kept by it
class Parts:
    """Beam and slots with fixed bases before they are clamped, all in the same dofs.

    `normal` (pair, dof) and `tangential` (2 pair, dof; along Y and along the slope in turn) give
    the displacement of the beam relative to the slot at each pair. `share` is each pair's part of
    its flank's area. `line_x` (m) and `line` (point, axis, dof) are the positions along the beam
    and the displacements of its middle line. Of an assembly, `interfaces` are what its flanks are
    called, `factor` is what a pair's springs have of the conditions' kn and kt, and `pressing` a
    flank's normal force over that of a dovetail's under the same load.
    """

    mass: Float[ndarray, "dof dof"]
    beam_stiffness: Float[ndarray, "dof dof"]
    slot_stiffness: Float[ndarray, "dof dof"]
    geometric: Float[ndarray, "dof dof"]
    normal: Float[ndarray, "pair dof"]
    tangential: Float[ndarray, "slider dof"]
    flank: Int[ndarray, " pair"]
    share: Float[ndarray, " pair"]
    place: Float[ndarray, "pair 2"]
    line_x: Float[ndarray, " point"]
    line: Float[ndarray, "point 3 dof"]
    interfaces: tuple[str, ...] = ()
    factor: Float[ndarray, " pair"] | float = 1.0
    pressing: Float[ndarray, " pair"] | float = 1.0


@dataclass(frozen=True, eq=False)
class Specimen:
    """The parts under an axial force, without the springs of their flanks."""

    parts: Parts
    mass: Float[ndarray, "dof dof"]
    stiffness: Float[ndarray, "dof dof"]


def parts(reduced: xr.Dataset) -> Parts:
    """Read beam and slots from a reduced structure, or all bodies of an assembly as one beam.

    Raises ValueError if the beam's contact dofs are not three a pair.
    """
    if "beam_mass" not in reduced:
        return _assembly_parts(reduced)
    pairs = reduced.sizes["pair"]
    n_beam = reduced.sizes["beam_dof"]
    if n_beam < 3 * pairs:
        raise ValueError(f"expected at least {3 * pairs} beam dofs for {pairs} pairs, got {n_beam}")
    n_slot = reduced.sizes["slot_dof"]
    slots = reduced.sizes["slot"]
    total = n_beam + slots * n_slot
    mass, beam, slot_stiffness, geometric = (np.zeros((total, total)) for _ in range(4))
    mass[:n_beam, :n_beam] = reduced["beam_mass"].values
    beam[:n_beam, :n_beam] = reduced["beam_stiffness"].values
    geometric[:n_beam, :n_beam] = reduced["beam_geometric_stiffness"].values
    relative = np.zeros((pairs, 3, total))
    for pair in range(pairs):
        relative[pair, :, 3 * pair : 3 * pair + 3] = np.eye(3)
    for slot in range(slots):
        first = n_beam + slot * n_slot
        block = slice(first, first + n_slot)
        mass[block, block] = reduced["slot_mass"].values[slot]
        slot_stiffness[block, block] = reduced["slot_stiffness"].values[slot]
        for k, pair in enumerate(reduced["slot_pairs"].values[slot].astype(int)):
            relative[pair, :, first + 3 * k : first + 3 * k + 3] -= np.eye(3)

    flank = reduced["pair_flank"].values.astype(np.int64)
    local = np.einsum("pla,pad->pld", reduced["flank_frame"].values[flank], relative)
    line_x, line = _middle_line(reduced, total)
    weight = reduced["pair_weight"].values
    return Parts(
        mass=mass,
        beam_stiffness=beam,
        slot_stiffness=slot_stiffness,
        geometric=geometric,
        normal=local[:, 0],
        tangential=local[:, 1:].reshape(2 * pairs, total),
        flank=flank,
        share=weight / np.bincount(flank, weight)[flank],
        place=_place_on_flank(reduced, flank),
        line_x=line_x,
        line=line,
    )


def _assembly_parts(reduced: xr.Dataset) -> Parts:
    """Parts of an assembly that is one body already; an interface takes the place of a flank."""
    pairs, total = reduced.sizes["pair"], reduced.sizes["dof"]
    relative, pair = np.zeros((pairs, 3, total)), np.arange(pairs)[:, None]
    relative[pair, np.arange(3), reduced["beam_dof"].values] = 1.0
    relative[pair, np.arange(3), reduced["slot_dof"].values] -= 1.0
    local = np.einsum("pla,pad->pld", reduced["frame"].values, relative)
    flank = reduced["flank"].values.astype(np.int64)
    x = reduced["display_position"].values[:, 0]
    order = np.argsort(x)
    return Parts(
        mass=reduced["mass"].values,
        beam_stiffness=reduced["stiffness"].values,
        slot_stiffness=np.zeros((total, total)),
        geometric=reduced["geometric_stiffness"].values,
        normal=local[:, 0],
        tangential=local[:, 1:].reshape(2 * pairs, total),
        flank=flank,
        share=reduced["weight"].values,
        place=np.zeros((pairs, 2)),
        line_x=x[order],
        line=reduced["display_shape"].values[order],
        interfaces=tuple(reduced["interface"].values.astype(str)),
    )


@lru_cache(maxsize=1)
def with_interfaces(
    whole: Parts, factor: tuple[tuple[str, float], ...], pressing: tuple[tuple[str, float], ...]
) -> Parts:
    """Interfaces told apart: factors of their springs, and normal forces over the load."""
    springs, pressed = (
        np.array([dict(one)[name] for name in whole.interfaces])[whole.flank]
        for one in (factor, pressing)
    )
    # a flank at 45 degrees has the load over the root of two
    return replace(whole, factor=springs, pressing=np.sqrt(2) * pressed)


def project(whole: Parts, basis: Float[ndarray, "dof few"]) -> Parts:
    """The parts restricted to the displacements that the columns of `basis` span."""
    matrices = ("mass", "beam_stiffness", "slot_stiffness", "geometric")
    rows = ("normal", "tangential", "line")
    return replace(
        whole,
        **{name: basis.T @ getattr(whole, name) @ basis for name in matrices},
        **{name: getattr(whole, name) @ basis for name in rows},
    )


@lru_cache(maxsize=1)  # records of one hold follow each other
def specimen(
    whole: Parts,
    force: float,
    modulus_factor: float = 1.0,
    density_factor: float = 1.0,
    added_mass: float = 0.0,
    added_mass_x: float = 0.0,
    slot_factor: float = 1.0,
    hung_at_Hz: float = 0.0,
) -> Specimen:
    """Put the parts under an axial force (N).

    The factors scale the modulus and density of beam and slots, `slot_factor` the stiffness of the
    slots alone; `added_mass` (kg) sits on the beam's middle line at `added_mass_x` (m) and moves
    in all three directions: the real specimen is never quite the analyst's model. A free one hangs
    so softly that its rigid motions have the frequency `hung_at_Hz`.
    """
    at_mass = np.array([line_row(whole, added_mass_x, axis) for axis in range(3)])
    mass = density_factor * whole.mass + added_mass * at_mass.T @ at_mass
    stiffness = (
        modulus_factor * (whole.beam_stiffness + slot_factor * whole.slot_stiffness)
        + force * whole.geometric
    )
    if hung_at_Hz:
        stiffness = stiffness + (2 * np.pi * hung_at_Hz) ** 2 * mass
    return Specimen(whole, (mass + mass.T) / 2, (stiffness + stiffness.T) / 2)


def stuck_stiffness(
    body: Specimen, kn: float, kt: float
) -> tuple[Float[ndarray, "dof dof"], Float[ndarray, " slider"]]:
    """Stiffness with all flanks stuck, and each slider's spring (N/m).

    kn and kt are totals of one flank in N/m; a pair carries its share of the flank's area.
    """
    whole = body.parts
    springs = whole.share * whole.factor
    slider_kt = kt * np.repeat(springs, 2)
    stiffness = body.stiffness + whole.normal.T @ (kn * springs[:, None] * whole.normal)
    stiffness += whole.tangential.T @ (slider_kt[:, None] * whole.tangential)
    return stiffness, slider_kt


def line_row(whole: Parts, x: float, axis: int = 2) -> Float[ndarray, " dof"]:
    """Row that reads the displacement (0, 1, 2: X, Y, Z) at x (m) on the beam's middle line.

    Raises ValueError outside the line.
    """
    if not whole.line_x[0] <= x <= whole.line_x[-1]:
        raise ValueError(
            f"expected a position between {whole.line_x[0]} and {whole.line_x[-1]} m, got {x}"
        )
    after = int(np.clip(np.searchsorted(whole.line_x, x), 1, len(whole.line_x) - 1))
    left, right = whole.line_x[after - 1 : after + 1]
    part = (x - left) / (right - left)
    return (1 - part) * whole.line[after - 1, axis] + part * whole.line[after, axis]


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
