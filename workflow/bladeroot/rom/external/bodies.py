"""Mass and stiffness of each body from its files, in SI units, checked before any long work."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.elasticity import rigid_modes
from bladeroot.rom.external.description import BODIES, Description, matrices_of
from bladeroot.rom.external.matrix_file import read_matrix

# Largest deviation of the stiffness from a straight line over the force, over its whole change.
_NONLINEARITY = 0.05
# Energy of a rigid motion, over that of the diagonal alone, below which a body is free.
_FREE_ENERGY = 1.0e-7


@dataclass(frozen=True)
class Body:
    """Matrices of one body without its fixed equations, in kg, N/m and (per newton) 1/m.

    `dof` is the row of each of its nodes and axes (three displacements, three rotations), -1 where
    there is none or it is fixed. `turn` is what a rotation by 1 rad is in the rows of rotations.
    """

    name: str
    mass: sp.csr_array
    stiffness: sp.csr_array
    geometric: sp.csr_array | None
    nodes: Float[ndarray, "node 3"]
    dof: Int[ndarray, "node 6"]
    turn: float
    where: str


def load_bodies(description: Description, mesh: xr.Dataset) -> list[Body]:
    """Beam, slot Xn and slot Xp. `mesh` is what `external_mesh` makes of the same description.

    Raises ValueError, a line a fault that names the file, for matrices that are not of one size, a
    mass with a diagonal that is not positive, bodies that are connected, and a slot that is not
    held.
    """
    read = of_each(description.models, lambda name: model_matrices(description, name))
    models = dict(zip(description.models, read, strict=True))
    for name, (mass, _, _) in models.items():
        mine = [description.model_of(body) == (name, False) for body in BODIES]
        expected = int(np.isin(mesh.equation_body, np.flatnonzero(mine)).sum())
        if mass.shape[0] != expected:
            model = description.models[name]
            raise ValueError(
                f"expected {expected} rows, as {model.get('mapping', model['nodes'])} says, got "
                f"{mass.shape[0]} ({description.folder / model['mass']})"
            )
    bodies = [_body(description, models, mesh, k) for k in range(3)]
    if "whole" in models:
        _check_apart(description, models["whole"], mesh)
    for body in bodies[1:]:
        _check_held(body)
    return bodies


def of_each(names: Iterable[str], read: Callable[[str], Any]) -> list:
    """What `read` makes of each name; ValueError with the faults of all, a line each."""
    made, faults = [], []
    for name in names:
        try:
            made.append(read(name))
        except ValueError as error:
            faults.append(str(error))
    if faults:
        raise ValueError("\n".join(dict.fromkeys(faults)))
    return made


def model_matrices(
    description: Description, name: str
) -> tuple[sp.csr_array, sp.csr_array, sp.csr_array | None]:
    """Mass, stiffness at zero force and its change per newton, in SI units."""
    model = description.models[name]
    mass = description.mass * read_matrix(description.folder, model["mass"])
    if (negative := np.flatnonzero(mass.diagonal() < 0.0)).size:
        raise ValueError(
            f"expected a mass without negative entries on the diagonal, got one in row "
            f"{negative[0] + 1} ({description.folder / model['mass']})"
        )
    per_length = description.force / description.length
    if "stiffness_at" in model:
        matrices = [
            read_matrix(description.folder, one["stiffness"]) for one in model["stiffness_at"]
        ]
        _check_sizes(description, name, [mass, *matrices])
        forces = np.array([one["force_N"] for one in model["stiffness_at"]], dtype=float)
        where = f"{description.path}, {name}/stiffness_at"
        return mass, *_line([per_length * matrix for matrix in matrices], forces, where)
    stiffness = per_length * read_matrix(description.folder, model["stiffness"])
    geometric = None
    if "geometric_stiffness" in model:
        geometric = (
            read_matrix(description.folder, model["geometric_stiffness"]) / description.length
        )
    _check_sizes(
        description, name, [mass, stiffness, *([geometric] if geometric is not None else [])]
    )
    return mass, stiffness, geometric


def _check_sizes(description: Description, name: str, matrices: list[sp.csr_array]) -> None:
    references = matrices_of(description.models[name])
    for reference, matrix in zip(references, matrices, strict=True):
        if matrix.shape != matrices[0].shape:
            raise ValueError(
                f"expected matrices of one size, got {matrices[0].shape[0]} rows in "
                f"{references[0]} and {matrix.shape[0]} in {reference} "
                f"({description.path}, {name})"
            )


def _line(
    matrices: list[sp.csr_array], forces: Float[ndarray, " force"], where: str
) -> tuple[sp.csr_array, sp.csr_array]:
    """The straight line K0 + F Kg nearest to stiffnesses at several forces (N), eq. 4.1."""
    weights = np.linalg.pinv(np.column_stack([np.ones(len(forces)), forces]))
    zero, slope = (
        sp.csr_array(sum(w * matrix for w, matrix in zip(row, matrices, strict=True)))
        for row in weights
    )
    change = np.ptp(forces) * abs(slope).max()
    off = max(abs(m - zero - f * slope).max() for m, f in zip(matrices, forces, strict=True))
    if not off <= _NONLINEARITY * change:
        raise ValueError(
            "expected a stiffness that changes linearly with force, got a deviation of "
            f"{100 * off / max(change, 1e-300):.3g} % of its change ({where})"
        )
    return zero, slope


def _body(description: Description, models: dict, mesh: xr.Dataset, which: int) -> Body:
    name = BODIES[which]
    source, mirrored = description.model_of(name)
    mass, stiffness, geometric = models[source]
    file = str(description.folder / description.models[source]["mass"])
    chosen = np.flatnonzero((mesh.equation_body == which) & (mesh.equation_fixed == 0))
    rows = mesh.equation_row.values[chosen]
    axis = mesh.equation_axis.values[chosen]
    first = int(np.argmax(mesh.node_body.values == which))
    nodes = mesh.node_position.values[mesh.node_body.values == which]
    node = mesh.equation_node.values[chosen] - first
    dof = np.full((len(nodes), 6), -1)
    dof[node, axis] = np.arange(len(rows))
    diagonal = mass.diagonal()[rows]
    if not (diagonal > 0).all():
        bad = int(np.argmin(diagonal > 0))
        raise ValueError(
            f"expected a positive definite mass, got {diagonal[bad]:g} on the diagonal in row "
            f"{rows[bad] + 1} (node {mesh.node_id.values[node[bad] + first]}) ({file})"
        )
    # A mirror in X turns displacements along X, and rotations about Y and Z.
    sign = np.where(np.isin(axis, (0, 4, 5)), -1.0, 1.0) if mirrored else np.ones(len(rows))
    mirror = sp.diags_array(sign)

    def part(matrix: sp.csr_array | None) -> sp.csr_array | None:
        return None if matrix is None else sp.csr_array(mirror @ matrix[rows][:, rows] @ mirror)

    parts = part(mass), part(stiffness), part(geometric) if which == 0 else None
    # One factor has brought displacements and rotations to SI, so rotations are in 1/length.
    return Body(name, *parts, nodes, dof, description.length, f"{description.path}, {source}")


def _check_apart(description: Description, model: tuple, mesh: xr.Dataset) -> None:
    """No entry of mass or stiffness may connect two bodies: contact springs come later."""
    body = np.empty(mesh.sizes["equation"], dtype=np.int64)
    body[mesh.equation_row.values] = mesh.equation_body.values
    for matrix, key in zip(model[:2], ("mass", "stiffness"), strict=True):
        entries = sp.coo_array(matrix)
        row, column = entries.coords
        between = np.flatnonzero(body[row] != body[column])
        if len(between):
            k = between[0]
            raise ValueError(
                "expected no contact springs or shared nodes between beam and slots, got "
                f"{entries.data[k]:.6g} between {BODIES[body[row[k]]]} and "
                f"{BODIES[body[column[k]]]} in row {row[k] + 1}, column {column[k] + 1} of the "
                f"{key} ({description.path}, whole)"
            )


def rigid_motions(body: Body) -> Float[ndarray, "dof 6"]:
    """Translations along and rotations about X, Y, Z through the nodes' centre, columns."""
    moves = np.zeros((*body.dof.shape, 6))
    moves[:, :3] = rigid_modes(body.nodes - body.nodes.mean(axis=0)).reshape(-1, 3, 6)
    moves[:, [3, 4, 5], [3, 4, 5]] = body.turn
    motions = np.zeros((body.mass.shape[0], 6))
    motions[body.dof[body.dof >= 0]] = moves[body.dof >= 0]
    return motions


def rigid_energy(body: Body) -> Float[ndarray, "6"]:
    """Strain energy of each rigid motion relative to that of uncoupled springs: 0 if it is free."""
    motions = rigid_motions(body)
    diagonal = np.einsum("di,d,di->i", motions, body.stiffness.diagonal(), motions)
    return np.einsum("di,di->i", motions, body.stiffness @ motions) / diagonal


def _check_held(body: Body) -> None:
    """A slot must be held: no rigid motion without energy."""
    motions = rigid_motions(body)
    motions = motions / np.linalg.norm(motions, axis=0)
    energy = motions.T @ (body.stiffness @ motions)
    diagonal = motions.T @ (body.stiffness.diagonal()[:, None] * motions)
    if not np.linalg.eigvalsh(energy)[0] >= _FREE_ENERGY * np.trace(diagonal) / 6:
        raise ValueError(
            f"expected a slot that is held, got one that moves freely: fixed nodes are missing, or "
            f"positions and matrices do not belong together ({body.where})"
        )
