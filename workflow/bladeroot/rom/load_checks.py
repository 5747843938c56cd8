"""What a follower load would change: shown beside the dead load's checks, required of nobody."""

from dataclasses import replace

import numpy as np
import pandas as pd
import scipy.linalg
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.follower import load_stiffness, symmetric
from bladeroot.rom.beam_modes import ReducedBeam, eigenvalue, hertz, reduced_modes
from bladeroot.rom.comparison import row
from bladeroot.rom.reduction import force_stiffness, project_force

FORCE = 24.0e3
_MODES = 60  # that the non-symmetric remainder couples
_BENDING = ("1Fy", "1Fz", "2Fy", "3Fy")


def load_checks(mesh: xr.Dataset, reduced: ReducedBeam, table_4_2: pd.DataFrame) -> list[dict]:
    """Rows on the follower load, whatever load the structure has; no limits.

    Frequencies at 24 kN against the dead load's; Table 4.2's slopes, which it does not meet: it
    stiffens no rigid rotation; and what its symmetric part, all that is used, leaves out.
    """
    tangent = load_stiffness(mesh)
    dead = replace(reduced, model=replace(reduced.model, follower=None))
    if reduced.model.follower is not None:
        dead = replace(dead, geometric=project_force(dead.model, reduced.basis))
    even = symmetric(tangent)
    follower = replace(
        reduced,
        model=replace(reduced.model, follower=even),
        geometric=dead.geometric + _projected(even, reduced),
    )
    remainder = _projected(sp.csr_array(tangent - even), reduced)
    straight, turning = reduced_modes(dead, FORCE), reduced_modes(follower, FORCE)
    rows = []
    for mode in _BENDING:
        reference, computed = (
            hertz(eigenvalue(modes, mode, f"{load} load of {FORCE:g} N"))
            for modes, load in ((straight, "dead"), (turning, "follower"))
        )
        rows.append(row("follower against dead load", mode, FORCE, reference, computed, np.nan))
    rows += _slopes(follower, table_4_2)
    whole = _with_remainder(follower, remainder)
    for mode in _BENDING:
        value = eigenvalue(turning, mode, "follower load")
        reference = whole[np.abs(whole - value).argmin()]
        check = "follower load, its symmetric part against all of it"
        rows.append(row(check, mode, FORCE, hertz(reference), hertz(value), np.nan))
    return rows


def _projected(tangent: sp.csr_array, reduced: ReducedBeam) -> Float[ndarray, "dof dof"]:
    """The load's stiffness in the reduced basis; only the flanks' nodes have any."""
    rows = np.flatnonzero(np.diff(tangent.indptr))
    columns = reduced.basis.columns
    return columns[rows].T @ (tangent[rows] @ columns)


def _slopes(follower: ReducedBeam, table: pd.DataFrame) -> list[dict]:
    """Slopes of f^2 over the force; of rigid rotations by their Rayleigh quotient, which is 0."""
    model = follower.model
    rigid = elasticity.rigid_modes(model.mesh.nodes)
    per_newton = np.einsum("di,di->i", rigid, force_stiffness(model) @ rigid)
    inertia = np.einsum("di,di->i", rigid, elasticity.per_axis(model.mass) @ rigid)
    quotients = dict(zip(("Ry", "Rz"), (per_newton / inertia)[4:], strict=True))
    forces = sorted(table.force_N.unique())
    at = [reduced_modes(follower, float(force)) for force in (forces[0], forces[-1])]
    rows = []
    for mode in ("Ry", "Rz", *_BENDING):
        group = table[table["mode"] == mode]
        if group.empty:
            continue
        reference = np.polyfit(group.force_N, group.frequency_Hz**2, 1)[0]
        if mode in quotients:
            slope = quotients[mode]
        else:
            ends = [eigenvalue(modes, mode, "follower load") for modes in at]
            slope = (ends[1] - ends[0]) / (forces[-1] - forces[0])
        computed, quantity = slope / (2 * np.pi) ** 2, "slope of f^2 over force"
        check = "Table 4.2, follower load"
        rows.append(row(check, mode, np.nan, reference, computed, np.nan, quantity, "Hz2/N"))
    return rows


def _with_remainder(
    follower: ReducedBeam, remainder: Float[ndarray, "dof dof"]
) -> Float[ndarray, " mode"]:
    """Eigenvalues (rad^2/s^2, real parts) with the non-symmetric part, in the lowest modes."""
    matrix = follower.stiffness + FORCE * follower.geometric
    values, shapes = scipy.linalg.eigh(
        matrix, follower.mass, subset_by_index=[0, min(_MODES, len(matrix)) - 1]
    )
    coupled = np.diag(values) + FORCE * (shapes.T @ remainder @ shapes)
    return np.linalg.eigvals(coupled).real
