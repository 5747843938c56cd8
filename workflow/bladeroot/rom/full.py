"""The joint without any reduction: beam and slots with springs between them, all dofs.

It says what reduction and parametric model together cost in accuracy, at any force.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Structure
from bladeroot.fem.linear import factor
from bladeroot.fem.mesh import base_nodes, body_mesh
from bladeroot.fem.prestress import materials_of
from bladeroot.fem.symmetry import (
    Reflection,
    Sector,
    among,
    keeps,
    reflections,
    sector_eigenpairs,
    sectors,
    that_keep,
    whole_shapes,
)
from bladeroot.rom.assembly import axis_of, find_modes
from bladeroot.rom.reduction import beam_model, contact_dofs, force_stiffness

_SEARCHED_MODES = 12  # the lowest, among which the named ones are found
# Each mode is followed from point to point of the box by steps of inverse iteration.
_CONVERGED = 1e-10  # of omega^2, what a further step would change
_MOST_STEPS = 30


@dataclass(frozen=True)
class FullJoint:
    """Mass, stiffness and geometric stiffness (per newton) of all free dofs; Kn, Kt of 1 N/m.

    number: dof of each node's axis (3 * node + axis), -1 where it is fixed; view: dofs of display
    nodes and of the beam's contact nodes; seen: those as an assembly, by which modes are named.
    mirrors: reflections that keep all matrices.
    """

    mass: sp.csr_array
    stiffness: sp.csr_array
    geometric: sp.csr_array
    normal: sp.csr_array
    tangential: sp.csr_array
    number: ndarray
    view: ndarray
    seen: xr.Dataset
    mirrors: tuple[Reflection, ...] = ()


def full_joint(structure: Structure, mesh: xr.Dataset, prestress: xr.Dataset) -> FullJoint:
    """Matrices of the beam and both slots, far faces fixed, before contact springs."""
    beam = beam_model(structure, mesh, prestress)
    masses, stiffnesses = [beam.mass], [beam.stiffness]
    held = []
    for body in (1, 2):
        slot, start = body_mesh(mesh, body)
        rule, materials = elasticity.quadrature(slot), materials_of(structure, mesh, body)
        masses.append(elasticity.mass(slot, rule, materials))
        stiffnesses.append(elasticity.stiffness(slot, rule, materials))
        held.append(start + base_nodes(slot))
    nodes = mesh.sizes["node"]
    free = contact_dofs(np.setdiff1d(np.arange(nodes), np.concatenate(held)))
    per_newton = force_stiffness(beam)
    empty = sp.csr_array((3 * nodes - per_newton.shape[0],) * 2)
    whole = (
        elasticity.per_axis(sp.csr_array(sp.block_diag(masses, format="csr"))),
        sp.csr_array(sp.block_diag(stiffnesses, format="csr")),
        sp.csr_array(sp.block_diag([per_newton, empty], format="csr")),
    )
    number = np.full(3 * nodes, -1)
    number[free] = np.arange(len(free))
    full = with_contact(mesh, number, *(sp.csr_array(part[free][:, free]) for part in whole))
    # nodes of beam and slots that lie in one place are told apart by a fourth coordinate
    body = np.minimum(mesh.node_body.values, 1.0)[:, None]
    found = reflections(np.hstack([mesh.node_position.values, body]), *whole)
    found = among(that_keep(found, free), free)
    kept = (full.normal, full.tangential)
    return replace(full, mirrors=tuple(one for one in found if all(keeps(one, k) for k in kept)))


def with_contact(
    mesh: xr.Dataset,
    number: ndarray,
    mass: sp.csr_array,
    stiffness: sp.csr_array,
    geometric: sp.csr_array,
) -> FullJoint:
    """Contact springs and display of bodies whose free dofs are numbered by node and axis."""
    flank, area = mesh.pair_flank.values, mesh.pair_weight.values
    share = area / np.bincount(flank, area)[flank]
    frame = mesh.flank_frame.values[flank]
    size = mass.shape[0]
    contact = [_springs(mesh, number, size, share, frame[:, local]) for local in ([0], [1, 2])]
    shown = contact_dofs(mesh.display_node.values)
    touched = contact_dofs(mesh.pair_node.values[:, 0])
    count = len(shown) // 3
    shape = np.zeros((count, 3, len(shown) + len(touched)))
    shape.reshape(len(shown), -1)[:, : len(shown)] = np.eye(len(shown))
    seen = xr.Dataset(
        {
            "display_position": (
                ("display", "axis"),
                mesh.node_position.values[mesh.display_node.values],
            ),
            "display_shape": (("display", "axis", "dof"), shape),
            "beam_dof": (
                ("pair", "axis"),
                len(shown) + np.arange(len(touched)).reshape(-1, 3),
            ),
            "frame": (("pair", "local", "axis"), frame),
            "weight": ("pair", share),
        }
    )
    view = number[np.concatenate([shown, touched])]
    return FullJoint(mass, stiffness, geometric, *contact, number, view, seen)


def _springs(
    mesh: xr.Dataset,
    number: ndarray,
    size: int,
    share: ndarray,
    axes: Float[ndarray, "pair k 3"],
) -> sp.csr_array:
    """Contact matrix of 1 N/m of flank stiffness along the given local axes."""
    dofs = number[3 * mesh.pair_node.values[:, :, None] + np.arange(3)]  # pair, side, axis
    gaps = gaps_along(np.sqrt(share)[:, None, None] * axes, dofs[:, 0], dofs[:, 1], size)
    return sp.csr_array(gaps.T @ gaps)


def gaps_along(
    direction: Float[ndarray, "pair k 3"],
    first: Int[ndarray, "pair 3"],
    second: Int[ndarray, "pair 3"],
    size: int,
) -> sp.csr_array:
    """Sparse rows of direction . (u_first - u_second); rows of displacements, -1: fixed."""
    pairs, k, _ = direction.shape
    row = np.broadcast_to(np.arange(pairs * k).reshape(pairs, k, 1), direction.shape)
    parts = []
    for sign, dof in ((1.0, first), (-1.0, second)):
        column = np.broadcast_to(dof[:, None, :], direction.shape)
        there = column >= 0
        parts.append((sign * direction[there], row[there], column[there]))
    value, i, j = (np.concatenate(part) for part in zip(*parts, strict=True))
    return sp.csr_array((value, (i, j)), shape=(pairs * k, size))


def full_frequencies(
    full: FullJoint, kn: float, kt: float, forces: Sequence[float], names: Sequence[str]
) -> Float[ndarray, "force name"]:
    """Frequencies (Hz) of named modes of the whole model at several axial forces (N).

    ValueError if a mode is not found or does not converge.
    """
    found = full_modes(full, [(kn, kt, force) for force in forces], names)
    return np.sqrt(np.array([values for values, _ in found])) / (2.0 * np.pi)


def full_modes(
    full: FullJoint, points: Sequence[tuple[float, float, float]], names: Sequence[str]
) -> list[tuple[Float[ndarray, " name"], Float[ndarray, "dof name"]]]:
    """Eigenvalues (rad^2/s^2) and shapes of named modes at points (kn, kt in N/m, force in N).

    One factor, in the points' middle, serves them all: elsewhere it preconditions a Davidson
    iteration, started from the modes there; each mode in the sector of its own parity. ValueError
    if a mode is not found or does not converge.
    """
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    parts = [one for one in sectors(full.mirrors, full.mass.shape[0]) if _shows(full, one, names)]
    within = [_within(full, one) for one in parts]
    middle = (*np.sqrt(low[:2] * high[:2]), 0.5 * (low[2] + high[2]))
    problems = [(_stiffness(one, *middle), one.mass) for one in within]
    solves = [factor(stiffness) for stiffness, _ in problems]
    _, found = sector_eigenpairs(problems, solves, _SEARCHED_MODES)
    column = find_modes(full.seen, whole_shapes(parts, found)[full.view], names)
    values, shapes = (
        np.empty((len(points), len(names))),
        np.empty((len(points), len(names)), object),
    )
    for place in {found[column[name]][0] for name in names}:
        own = [mode for mode, (sector, _) in enumerate(found) if sector == place]
        mine = [k for k, name in enumerate(names) if found[column[name]][0] == place]
        start = np.column_stack([found[mode][1] for mode in own])
        chosen = [own.index(column[names[k]]) for k in mine]
        for p, point in enumerate(points):
            value, shape = _followed(within[place], point, solves[place], start, chosen)
            values[p, mine] = value
            for k, one in zip(mine, shape.T, strict=True):
                shapes[p, k] = (place, one)
    return [
        (value, whole_shapes(parts, list(shape)))
        for value, shape in zip(values, shapes, strict=True)
    ]


def _shows(full: FullJoint, part: Sector, names: Sequence[str]) -> bool:
    """Whether a sector's motions can be those of a named mode: they move what it is known by."""
    if "mode_shape" in full.seen:
        return True
    shape = full.seen.display_shape.values
    shown = sp.csr_array(shape.reshape(-1, shape.shape[2])) @ part.columns[full.view]
    moved = abs(shown).max(axis=1).toarray().reshape(shape.shape[:2]).max(axis=0)
    return any(moved[axis_of(name)] > 0.0 for name in names)


@dataclass(frozen=True)
class _Within:
    """The matrices of a `FullJoint` in one sector."""

    mass: sp.csr_array
    stiffness: sp.csr_array
    geometric: sp.csr_array
    normal: sp.csr_array
    tangential: sp.csr_array


def _within(full: FullJoint, part: Sector) -> _Within:
    matrices = (full.mass, full.stiffness, full.geometric, full.normal, full.tangential)
    return _Within(*map(part.within, matrices))


def _stiffness(one: _Within, kn: float, kt: float, force: float) -> sp.csr_array:
    contact = kn * one.normal + kt * one.tangential
    return sp.csr_array(one.stiffness + contact + force * one.geometric)


def _followed(
    one: _Within, point: tuple[float, float, float], solve, shapes: ndarray, chosen: list[int]
) -> tuple[Float[ndarray, " name"], Float[ndarray, "dof name"]]:
    """Eigenpairs nearest in shape to the chosen ones of given orthonormal shapes."""
    stiffness = _stiffness(one, *point)
    basis, wanted = shapes, shapes[:, chosen]
    image, heavy = stiffness @ basis, one.mass @ basis
    projected = basis.T @ image
    for _ in range(_MOST_STEPS):
        values, combination = np.linalg.eigh(0.5 * (projected + projected.T))
        places = np.abs(combination.T @ (heavy.T @ wanted)).argmax(axis=0)
        turn, values = combination[:, places], values[places]
        wanted = basis @ turn
        residual = image @ turn - values * (heavy @ turn)
        step = solve(residual)
        if np.all(np.einsum("dm,dm->m", residual, step) < _CONVERGED * values):
            return values, wanted
        for _ in range(2):
            step = step - basis @ (heavy.T @ step)
            step = step @ np.linalg.inv(np.linalg.cholesky(step.T @ (one.mass @ step))).T
        basis = np.hstack([basis, step])
        image = np.hstack([image, stiffness @ step])
        heavy = np.hstack([heavy, one.mass @ step])
        projected = basis.T @ image
    raise ValueError(f"modes of the full model did not converge in {_MOST_STEPS} steps")
