"""The structure's beam against what must hold whatever its geometry: exact identities.

And against itself: the reduced beam beside the full one.
"""

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Structure, flank_ends
from bladeroot.fem.mesh import Mesh, build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.rom.beam_modes import (
    Modes,
    ReducedBeam,
    eigenvalue,
    full_modes,
    hertz,
    reduced_beam,
    reduced_modes,
)
from bladeroot.rom.comparison import row
from bladeroot.rom.reduction import BeamModel, beam_model, force_stiffness, reduce_structure

# Largest relative residual that is allowed.
LIMITS = {
    "rigid rotation": 1.0e-9,
    "rotation mode at 1 kN": 1.0e-3,
    "reduced against full": 0.0005,
}
# Forces (N) at which the reduced beam meets the full one: none, for which its basis was made, and
# the largest, farthest from it.
_FORCES = (0.0, 30.0e3)


def checked_beam(
    structure: Structure, mesh: xr.Dataset, stress: xr.Dataset, reduced: xr.Dataset
) -> tuple[ReducedBeam, Modes, list[dict]]:
    """The beam with its pad, its modes without a force, and a row (`comparison`) an identity.

    `mesh`, `stress`, its prestress, and `reduced` are of its loaded case; without the pad they are
    made anew.
    """
    if mesh.attrs["with_pad"] != (structure.pad is not None):
        mesh = build_mesh(structure, with_pad=True)
        stress = prestress(structure, mesh)
        reduced = reduce_structure(structure, mesh, stress)
    model = beam_model(structure, mesh, stress)
    beam = reduced_beam(model, reduced)
    full = {force: full_modes(model, force) for force in _FORCES}
    return beam, full[0.0], [*_rotations(structure, model, beam), *_reduction(full, beam)]


def _rotations(structure: Structure, model: BeamModel, reduced: ReducedBeam) -> list[dict]:
    """Rigid rotations under dead load: omega^2(Ry) = F (Lc - 2 zc) / I_Y, (Rz) = F Lc / I_Z.

    Lc and zc are the flank centroids' distance and half-height. Once as a Rayleigh quotient, where
    the identity is exact (with omega^2(Rx) = -2 F zc / I_X), once as modes at 1 kN, which bend a
    little.
    """
    (x0, z0), (x1, z1) = flank_ends(structure)
    length, height = x0 + x1, (z0 + z1) / 2
    inertia = _inertia(model.mesh, model.mass)
    stiff = {"Rx": -2 * height, "Ry": length - 2 * height, "Rz": length}
    rigid = elasticity.rigid_modes(model.mesh.nodes)[:, 3:]
    twist = np.einsum("di,di->i", rigid, force_stiffness(model) @ rigid)
    force = 1.0e3
    modes = reduced_modes(reduced, force)
    quantity, unit = "omega^2 over force", "rad2/(s2 N)"
    rows = []
    for k, (mode, arm) in enumerate(stiff.items()):
        exact = arm / inertia[k]
        quotient = twist[k] / inertia[k]
        check = "rigid rotation"
        rows.append(row(check, mode, np.nan, exact, quotient, LIMITS[check], quantity, unit))
        check = "rotation mode at 1 kN"
        value = eigenvalue(modes, mode, f"free at {force:g} N") / force
        rows.append(row(check, mode, force, exact, value, LIMITS[check], quantity, unit))
    return rows


def _inertia(mesh: Mesh, mass: sp.csr_array) -> Float[ndarray, "3"]:
    """Moments of inertia (kg m^2) about the axes through the centre of mass."""
    total = mass.sum()
    centred = mesh.nodes - (mass @ mesh.nodes).sum(axis=0) / total
    square = np.einsum("na,na->a", centred, mass @ centred)
    return square.sum() - square


def _reduction(full: Mapping[float, Modes], reduced: ReducedBeam) -> list[dict]:
    """Elastic modes 7 to 12 of the free beam, reduced against full."""
    rows = []
    for force, (values, names) in full.items():
        smaller = reduced_modes(reduced, force)
        for value, name in list(zip(values, names, strict=True))[6:]:
            computed = hertz(eigenvalue(smaller, name, f"reduced at {force:g} N"))
            check = "reduced against full"
            rows.append(row(check, name, force, hertz(value), computed, LIMITS[check]))
    return rows
