"""Named modes of the prestressed beam, reduced and in full."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.modes import name_modes
from bladeroot.fem.symmetry import reflections, symmetric_eigenpairs
from bladeroot.rom.reduction import (
    Basis,
    BeamModel,
    force_stiffness,
    project,
    project_stiffness,
)

# Below every eigenvalue up to 30 kN: the dead squeeze on the flanks makes Rx unstable, with
# omega^2 = -2 F zc / I_X.
_SHIFT = -((2 * np.pi * 1000.0) ** 2)

Modes = tuple[Float[ndarray, " mode"], list[str]]


@dataclass(frozen=True)
class ReducedBeam:
    """The reduced beam with its basis, so that a mode can be named by its recovered shape.

    `geometric`: all stiffness per newton of axial force.
    """

    model: BeamModel
    basis: Basis
    mass: Float[ndarray, "dof dof"]
    stiffness: Float[ndarray, "dof dof"]
    geometric: Float[ndarray, "dof dof"]


def reduce_beam(model: BeamModel, basis: Basis) -> ReducedBeam:
    """Project the whole beam's matrices."""
    return ReducedBeam(
        model,
        basis,
        project(model.mass, basis),
        project_stiffness(model.stiffness, basis),
        project(model.geometric, basis),
    )


def reduced_modes(reduced: ReducedBeam, force: float, clamped: bool = False) -> Modes:
    """Lowest 12 eigenvalues (rad^2/s^2) and names, free or with all contact nodes fixed."""
    kept = slice(len(reduced.basis.masters) if clamped else 0, None)
    matrix = (reduced.stiffness + force * reduced.geometric)[kept, kept]
    values, shapes = scipy.linalg.eigh(matrix, reduced.mass[kept, kept], subset_by_index=[0, 11])
    return values, _names(reduced.model, values, reduced.basis.columns[:, kept] @ shapes)


def _names(model: BeamModel, values: Float[ndarray, " m"], shapes: Float[ndarray, "d m"]) -> list:
    return name_modes(model.mesh.nodes, model.mass.sum(axis=1), values, shapes)


def full_modes(model: BeamModel, force: float) -> Modes:
    """Lowest 12 eigenvalues (rad^2/s^2) and names of the whole beam, free."""
    matrix = sp.csr_array(model.stiffness + force * force_stiffness(model))
    mass = elasticity.per_axis(model.mass)
    mirrors = reflections(model.mesh.nodes, matrix, mass)
    values, shapes = symmetric_eigenpairs(matrix, mass, 12, _SHIFT, mirrors)
    return values, _names(model, values, shapes)


def eigenvalue(modes: Modes, name: str, where: str) -> float:
    """Eigenvalue of a named mode; ValueError that lists what there is, if it is not there."""
    values, names = modes
    if name not in names:
        raise ValueError(f"{where}: mode {name} not found, only {', '.join(names)}")
    return float(values[names.index(name)])


def hertz(value: float) -> float:
    """Frequency of an eigenvalue; negative when the mode is unstable."""
    return float(np.sign(value) * np.sqrt(abs(value)) / (2 * np.pi))
