"""The eigenproblems behind the thesis's tables, of the whole finite-element model.

A case is the beam with or without pad, under an axial force, with springs on its flanks: none (a
free beam), to the ground (flanks fixed, with springs far stiffer than the beam) or to the slots.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem.geometry import Structure
from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.fem.mesh import body_mesh, build_mesh
from bladeroot.fem.modes import name_modes
from bladeroot.fem.prestress import prestress
from bladeroot.rom.full import FullJoint, full_joint, full_modes

# N/m a flank: a thousand times what the beam's own root offers, and well conditioned still.
RIGID = 1.0e13
_MODES = 12
# Below every eigenvalue up to 30 kN, where dead pressure on the flanks makes Rx unstable.
_SHIFT = -((2 * np.pi * 1000.0) ** 2)


@dataclass(frozen=True)
class Case:
    """Pad on or off, axial force (N), flank stiffness (N/m) to the slots or else to the ground."""

    pad: bool
    force: float = 0.0
    kn: float = 0.0
    kt: float = 0.0
    slots: bool = False


@dataclass(frozen=True)
class Mode:
    """One mode of a case: eigenvalue (rad^2/s^2) and mass-normalised shape.

    The shape has a row for each node of the mesh's bodies; zero where the case has no slots.
    """

    case: Case
    value: float
    shape: Float[ndarray, "node 3"]


@dataclass(frozen=True)
class Model:
    """A structure's mesh, stress per newton and matrices, with or without the pad."""

    structure: Structure
    mesh: xr.Dataset
    prestress: xr.Dataset
    full: FullJoint


def build_model(structure: Structure, pad: bool) -> Model:
    """Mesh, static stress and matrices of one structure."""
    mesh = build_mesh(structure, with_pad=pad)
    stressed = prestress(structure, mesh)
    return Model(structure, mesh, stressed, full_joint(structure, mesh, stressed))


def solve_modes(model: Model, wanted: Sequence[tuple[Case, str]]) -> dict[tuple[Case, str], Mode]:
    """The named modes of the cases; ValueError if one is not among the lowest of its case."""
    found: dict[tuple[Case, str], Mode] = {}
    joints: dict[int, list[Case]] = {}
    for case in dict.fromkeys(case for case, _ in wanted):
        if case.slots:  # contact of like stiffness shares one factor
            joints.setdefault(round(np.log10(case.kn)), []).append(case)
        else:
            found |= _beam_modes(model, case, [name for one, name in wanted if one == case])
    for cases in joints.values():
        names = list(dict.fromkeys(name for case, name in wanted if case in cases))
        found |= _joint_modes(model, cases, names)
    return found


def _beam_modes(model: Model, case: Case, names: Sequence[str]) -> dict[tuple[Case, str], Mode]:
    beam, _ = body_mesh(model.mesh, 0)
    mine = slice(0, 3 * len(beam.nodes))
    full = model.full
    matrix = full.stiffness + case.force * full.geometric
    matrix = sp.csr_array((matrix + case.kn * full.normal + case.kt * full.tangential)[mine, mine])
    mass = sp.csr_array(full.mass[mine, mine])
    values, shapes = lowest_eigenpairs(matrix, mass, _MODES, _SHIFT)
    weights = np.asarray(mass.sum(axis=1)).reshape(-1, 3)[:, 0]
    called = name_modes(beam.nodes, weights, values, shapes)
    missing = [name for name in names if name not in called]
    if missing:
        raise ValueError(f"no mode {missing[0]} among the lowest {_MODES} ({', '.join(called)})")
    result = {}
    for name in names:
        shape = np.zeros((model.mesh.sizes["node"], 3))
        shape.reshape(-1)[mine] = shapes[:, called.index(name)]
        result[case, name] = Mode(case, float(values[called.index(name)]), shape)
    return result


def _joint_modes(
    model: Model, cases: Sequence[Case], names: Sequence[str]
) -> dict[tuple[Case, str], Mode]:
    points = [(case.kn, case.kt, case.force) for case in cases]
    number = model.full.number
    moving = number >= 0
    result = {}
    for case, (values, shapes) in zip(cases, full_modes(model.full, points, names), strict=True):
        for name, value, column in zip(names, values, shapes.T, strict=True):
            shape = np.zeros((model.mesh.sizes["node"], 3))
            shape.reshape(-1)[moving] = column[number[moving]]
            result[case, name] = Mode(case, float(value), shape)
    return result
