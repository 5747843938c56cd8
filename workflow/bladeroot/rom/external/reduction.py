"""From the matrices of another program to `reduced.nc`, the same as of the built-in dovetail."""

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.external.bodies import Body, load_bodies
from bladeroot.rom.external.description import Description
from bladeroot.rom.joint import exact_modes, joint_of_reduced
from bladeroot.rom.parametric_build import MODES
from bladeroot.rom.reduction import (
    Basis,
    craig_bampton,
    project,
    project_stiffness,
    reduced_dataset,
)

_NAMING_STIFFNESS = 1.0e9  # stiffness of a flank (N/m) at which the two modes are looked for


def reduce_matrices(description: Description, mesh: xr.Dataset) -> xr.Dataset:
    """Craig-Bampton reduction of given matrices at zero force, contact nodes kept (4.3-4.12).

    `mesh` is what `external_mesh` makes of the same description. Raises ValueError, one line that
    names the file, for wrong matrices (see `load_bodies`), a mass or an inner stiffness that is not
    positive definite, and if the joint has no modes 1B and 2B.
    """
    bodies = load_bodies(description, mesh)
    for body in bodies:
        _check_positive(body.mass, body.where)
    settings = description.data["reduction"]
    pairs = mesh.pair_node.values
    beam, *slots = bodies
    basis = _basis(beam, pairs[:, 0], settings["beam_modes"])
    half = len(pairs) // 2
    first = [int(np.argmax(mesh.node_body.values == which)) for which in (1, 2)]
    reduced_slots = [
        _reduced(slot, _basis(slot, pairs[rows, 1] - start, settings["slot_modes"]))
        for slot, rows, start in zip(slots, (slice(0, half), slice(half, None)), first, strict=True)
    ]
    shown = mesh.display_node.values
    reduced = reduced_dataset(
        mesh,
        (*_reduced(beam, basis), project(beam.geometric, basis)),
        basis.columns[beam.dof[shown, :3]],
        reduced_slots,
        settings,
    )
    _check_modes(reduced, str(description.path))
    return reduced


def _basis(body: Body, contact: ndarray, modes: int) -> Basis:
    """Craig-Bampton basis with the contact nodes as masters."""
    masters = body.dof[contact, :3].ravel()
    try:
        return craig_bampton(body.stiffness, body.mass, masters, modes)
    except ValueError as error:
        raise ValueError(f"the contact nodes held: {error} ({body.where})") from error


def _reduced(
    body: Body, basis: Basis
) -> tuple[Float[ndarray, "dof dof"], Float[ndarray, "dof dof"]]:
    return project(body.mass, basis), project_stiffness(body.stiffness, basis)


def _check_positive(matrix: sp.csr_array, where: str) -> None:
    """Sylvester's law: a symmetric matrix is positive definite if all pivots are positive."""
    try:
        lu = spla.splu(
            matrix.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        pivots = lu.U.diagonal()
        wrong = int((~(pivots > 0)).sum()) if (lu.perm_r == lu.perm_c).all() else len(pivots)
    except RuntimeError:  # exactly singular
        wrong, pivots = 1, np.zeros(1)
    # a pivot that is rounding alone means a motion without energy
    if wrong or pivots.min() < 1e-13 * pivots.max():
        kind = f"{wrong} pivots that are not positive" if wrong else "a singular one"
        raise ValueError(f"expected a positive definite mass, got {kind} ({where})")


def _check_modes(reduced: xr.Dataset, where: str) -> None:
    """The two modes of the measurement must be found among the joint's lowest."""
    point = np.array([np.log(_NAMING_STIFFNESS), np.log(_NAMING_STIFFNESS), 0.0])
    try:
        exact_modes(joint_of_reduced(reduced), point, MODES)
    except ValueError as error:
        raise ValueError(f"{error} ({where})") from error
