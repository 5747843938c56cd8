"""Craig-Bampton reduction of beam and slots: once, at zero force (thesis 4.4).

The basis found at F = 0 reduces the geometric stiffness too, so one reduction serves every force.
Because the basis spans the whole space of contact displacements exactly, only the fixed-interface
modes are an approximation.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Structure
from bladeroot.fem.linear import factor
from bladeroot.fem.mesh import SLOTS, Mesh, base_nodes, body_mesh
from bladeroot.fem.prestress import materials_of
from bladeroot.fem.symmetry import (
    Reflection,
    among,
    reflections,
    sector_eigenpairs,
    sectors,
    that_keep,
    whole_shapes,
)
from bladeroot.variables import dataset


@dataclass(frozen=True)
class Basis:
    """Columns of the reduction (dof, master + mode) and the fixed-interface frequencies squared."""

    columns: Float[ndarray, "dof reduced"]
    eigenvalues: Float[ndarray, " mode"]
    masters: Int[ndarray, " master"]


def craig_bampton(
    stiffness: sp.csr_array,
    mass: sp.csr_array,
    masters: Int[ndarray, " master"],
    modes: int,
    mirrors: Sequence[Reflection] = (),
) -> Basis:
    """Static modes of the master dofs and the lowest `modes` fixed-interface modes, eqs 4.5-4.10.

    `mass` is (dof, dof). `mirrors`, reflections that keep both, make the problem smaller. Raises
    ValueError if there are not more slave dofs than modes.
    """
    size = stiffness.shape[0]
    slaves = np.setdiff1d(np.arange(size), masters)
    if modes >= len(slaves):
        raise ValueError(f"cannot keep {modes} fixed-interface modes of {len(slaves)} slave dofs")
    mirrors = that_keep(mirrors, masters)
    outer = sectors(among(mirrors, masters), len(masters))
    inner = sectors(among(mirrors, slaves), len(slaves))
    rows, heavy = stiffness[slaves], sp.csr_array(mass[slaves][:, slaves])
    within, coupled = sp.csr_array(rows[:, slaves]), sp.csr_array(rows[:, masters])
    columns = np.zeros((size, len(masters) + modes))
    columns[masters, np.arange(len(masters))] = 1.0
    problems, solves = [], []
    for moved, held in zip(inner, outer, strict=True):
        problems.append((moved.within(within), moved.within(heavy)))
        solves.append(factor(problems[-1][0]) if len(moved.first) else None)
        if len(moved.first) and len(held.first):
            static = -solves[-1](moved.between(coupled, held).toarray())
            columns[slaves, : len(masters)] += moved.columns @ (held.columns @ static.T).T
    eigenvalues, found = sector_eigenpairs(problems, solves, modes)
    columns[slaves, len(masters) :] = whole_shapes(inner, found)
    return Basis(columns, eigenvalues, masters)


def project(matrix: sp.csr_array, basis: Basis) -> Float[ndarray, "reduced reduced"]:
    """alpha^T A alpha (eq. 4.12) of a matrix by dof, or by node that acts alike on each axis."""
    moved = matrix @ basis.columns.reshape(matrix.shape[0], -1)
    result = basis.columns.T @ moved.reshape(basis.columns.shape)
    return (result + result.T) / 2


def project_stiffness(stiffness: sp.csr_array, basis: Basis) -> Float[ndarray, "reduced reduced"]:
    """alpha^T K alpha at F = 0: no coupling between static modes and fixed-interface modes."""
    masters = basis.masters
    count = len(masters)
    result = np.zeros((basis.columns.shape[1],) * 2)
    block = stiffness[masters] @ basis.columns[:, :count]
    result[:count, :count] = (block + block.T) / 2
    result[count:, count:] = np.diag(basis.eigenvalues)
    return result


def contact_dofs(nodes: Int[ndarray, " pair"]) -> Int[ndarray, " dof"]:
    """Dofs of contact nodes, pair-major: 3*pair + axis."""
    return (3 * nodes[:, None] + np.arange(3)).ravel()


@dataclass(frozen=True)
class BeamModel:
    """The whole beam: stiffness by dof, mass and geometric stiffness (per newton) by node."""

    mesh: Mesh
    stiffness: sp.csr_array
    mass: sp.csr_array
    geometric: sp.csr_array


def beam_model(structure: Structure, mesh: xr.Dataset, prestress: xr.Dataset) -> BeamModel:
    """Matrices of the prestressed beam; ValueError if mesh and prestress differ about the pad."""
    if mesh.attrs["with_pad"] != prestress.attrs["with_pad"]:
        raise ValueError("mesh and prestress must agree on the pad")
    beam, _ = body_mesh(mesh, 0)
    materials = materials_of(structure, mesh, 0)
    rule = elasticity.quadrature(beam)
    return BeamModel(
        beam,
        elasticity.stiffness(beam, rule, materials),
        elasticity.mass(beam, rule, materials),
        elasticity.geometric_stiffness(beam, rule, prestress.stress.values),
    )


def force_stiffness(model: BeamModel) -> sp.csr_array:
    """Stiffness per newton of axial force (1/m) by dof, of the stress under a dead load."""
    return elasticity.per_axis(model.geometric)


def beam_basis(model: BeamModel, mesh: xr.Dataset, modes: int) -> Basis:
    """Craig-Bampton basis of the beam with its contact nodes as masters."""
    masters = contact_dofs(mesh.pair_node.values[:, 0])
    mass = elasticity.per_axis(model.mass)
    mirrors = reflections(model.mesh.nodes, model.stiffness, mass)
    return craig_bampton(model.stiffness, mass, masters, modes, mirrors)


def reduce_structure(structure: Structure, mesh: xr.Dataset, prestress: xr.Dataset) -> xr.Dataset:
    """Reduced beam (mass, stiffness, geometric stiffness per newton) and slots: `reduced.nc`.

    The contact nodes are the masters; the slots' far faces are fixed before the reduction, which
    equals removing them afterwards (eqs 5.1, 5.2). Display rows are recovered, not kept as masters.
    """
    model = beam_model(structure, mesh, prestress)
    basis = beam_basis(model, mesh, structure.beam_modes)
    shapes = basis.columns.reshape(-1, 3, basis.columns.shape[1])
    reduced = reduced_dataset(
        mesh,
        (
            project(model.mass, basis),
            project_stiffness(model.stiffness, basis),
            project(model.geometric, basis),
        ),
        shapes[mesh.display_node.values],
        _reduce_slots(structure, mesh),
        {"beam_modes": structure.beam_modes, "slot_modes": structure.slot_modes},
    )
    # single precision: modes are only named by it
    sides = {"side_shape": shapes[side_nodes(model.mesh)].astype(np.float32)}
    return reduced.merge(dataset("rom/reduced", sides))


def side_nodes(beam: Mesh) -> Int[ndarray, " side"]:
    """Corners of elements on the beam's two sides, where every mode's parities can be seen."""
    corners = np.unique(beam.elements[:, [0, 2, 6, 8, 18, 20, 24, 26]])
    across = np.abs(beam.nodes[corners, 1])
    return corners[across > across.max() - 1e-9]


def reduced_dataset(
    mesh: xr.Dataset,
    beam: tuple[ndarray, ndarray, ndarray],
    display_shape: Float[ndarray, "display axis beam_dof"],
    slots: Sequence[tuple[ndarray, ndarray]],
    modes: Mapping[str, int],
) -> xr.Dataset:
    """`reduced.nc` from the reduced matrices, whoever made them.

    beam: mass (kg), stiffness at zero force (N/m) and stiffness per newton of axial force (1/m).
    display_shape: displacement of the display nodes per reduced dof. slots: mass and stiffness of
    each. modes: how many fixed-interface modes were kept, `beam_modes` and `slot_modes`.
    """
    pairs = mesh.pair_node.values
    made = dataset(
        "rom/reduced",
        {
            "pair_position": mesh.node_position.values[pairs[:, 0]],
            "pair_flank": mesh.pair_flank.values,
            "pair_weight": mesh.pair_weight.values,
            "flank_frame": mesh.flank_frame.values,
            "beam_mass": beam[0],
            "beam_stiffness": beam[1],
            "beam_geometric_stiffness": beam[2],
            "display_position": mesh.node_position.values[mesh.display_node.values],
            "display_shape": display_shape,
            "slot_mass": np.stack([mass for mass, _ in slots]),
            "slot_stiffness": np.stack([stiffness for _, stiffness in slots]),
            "slot_pairs": np.arange(len(pairs)).reshape(2, -1),
        },
    )
    about = {key: mesh.attrs[key] for key in ("structure", "description", "with_pad")}
    return made.assign_attrs(about | dict(modes)).assign_coords(
        axis=list("XYZ"), flank=mesh.flank.values, local=["normal", "along Y", "along slope"],
        slot=list(SLOTS),
    )  # fmt: skip


def _reduce_slots(
    structure: Structure, mesh: xr.Dataset
) -> list[tuple[Float[ndarray, "dof dof"], Float[ndarray, "dof dof"]]]:
    """Mass and stiffness of slots Xn and Xp; Xp's are found, Xn's are their mirror image."""
    body, start = body_mesh(mesh, 2)
    materials = materials_of(structure, mesh, 2)
    rule = elasticity.quadrature(body)
    free = np.setdiff1d(np.arange(len(body.nodes)), base_nodes(body))
    number = np.full(len(body.nodes), -1)
    number[free] = np.arange(len(free))
    dofs = contact_dofs(free)
    stiffness = sp.csr_array(elasticity.stiffness(body, rule, materials)[dofs][:, dofs])
    mass = sp.csr_array(elasticity.mass(body, rule, materials)[free][:, free])
    pairs = len(mesh.pair) // 2
    masters = contact_dofs(number[mesh.pair_node.values[pairs:, 1] - start])
    heavy = elasticity.per_axis(mass)
    mirrors = reflections(body.nodes[free], stiffness, heavy)
    basis = craig_bampton(stiffness, heavy, masters, structure.slot_modes, mirrors)
    found = project(mass, basis), project_stiffness(stiffness, basis)
    # Pairs of both ends are numbered alike, so the mirror only turns the contact nodes' X.
    sign = np.ones(len(found[0]))
    sign[: len(masters) : 3] = -1.0
    mirror = np.outer(sign, sign)
    return [tuple(matrix * mirror for matrix in found), found]
