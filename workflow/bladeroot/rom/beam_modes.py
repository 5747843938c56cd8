"""Named modes of the prestressed beam, reduced and in full."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.modes import name_modes
from bladeroot.fem.symmetry import reflections, symmetric_eigenpairs
from bladeroot.rom.reduction import BeamModel, force_stiffness, side_nodes

# Below every eigenvalue up to 30 kN: the dead squeeze on the flanks makes Rx unstable, with
# omega^2 = -2 F zc / I_X.
_SHIFT = -((2 * np.pi * 1000.0) ** 2)

Modes = tuple[Float[ndarray, " mode"], list[str]]


@dataclass(frozen=True)
class ReducedBeam:
    """The reduced beam with the motion of some nodes, by which its modes are named.

    `geometric`: all stiffness per newton of axial force. nodes (m), weights (kg): of the nodes that
    `shape` moves, a row a node's axis. masters: how many dofs are those of contact nodes.
    """

    mass: Float[ndarray, "dof dof"]
    stiffness: Float[ndarray, "dof dof"]
    geometric: Float[ndarray, "dof dof"]
    nodes: Float[ndarray, "side 3"]
    weights: Float[ndarray, " side"]
    shape: Float[ndarray, "row dof"]
    masters: int


def reduced_beam(model: BeamModel, reduced: xr.Dataset) -> ReducedBeam:
    """The beam of `reduced.nc`, which is made of this model."""
    seen = side_nodes(model.mesh)
    return ReducedBeam(
        reduced.beam_mass.values,
        reduced.beam_stiffness.values,
        reduced.beam_geometric_stiffness.values,
        model.mesh.nodes[seen],
        model.mass.sum(axis=1)[seen],
        reduced.side_shape.values.reshape(3 * len(seen), -1),
        3 * reduced.sizes["pair"],
    )


def reduced_modes(reduced: ReducedBeam, force: float, clamped: bool = False) -> Modes:
    """Lowest 12 eigenvalues (rad^2/s^2) and names, free or with all contact nodes fixed."""
    kept = slice(reduced.masters if clamped else 0, None)
    matrix = (reduced.stiffness + force * reduced.geometric)[kept, kept]
    values, shapes = scipy.linalg.eigh(matrix, reduced.mass[kept, kept], subset_by_index=[0, 11])
    seen = reduced.shape[:, kept] @ shapes
    return values, name_modes(reduced.nodes, reduced.weights, values, seen)


def full_modes(model: BeamModel, force: float) -> Modes:
    """Lowest 12 eigenvalues (rad^2/s^2) and names of the whole beam, free."""
    matrix = sp.csr_array(model.stiffness + force * force_stiffness(model))
    mass = elasticity.per_axis(model.mass)
    mirrors = reflections(model.mesh.nodes, matrix, mass)
    values, shapes = symmetric_eigenpairs(matrix, mass, 12, _SHIFT, mirrors)
    return values, name_modes(model.mesh.nodes, model.mass.sum(axis=1), values, shapes)


def eigenvalue(modes: Modes, name: str, where: str) -> float:
    """Eigenvalue of a named mode; ValueError that lists what there is, if it is not there."""
    values, names = modes
    if name not in names:
        raise ValueError(f"{where}: mode {name} not found, only {', '.join(names)}")
    return float(values[names.index(name)])


def hertz(value: float) -> float:
    """Frequency of an eigenvalue; negative when the mode is unstable."""
    return float(np.sign(value) * np.sqrt(abs(value)) / (2 * np.pi))
