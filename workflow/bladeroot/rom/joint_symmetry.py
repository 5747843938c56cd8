"""Reflections of beam and slots, found from their reduced matrices.

What a reflection does to the contact nodes is known from their places. What it does to a
fixed-interface mode is not written anywhere, but the mode's inertia on the contact nodes tells it.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem.modes import mirror_nodes
from bladeroot.fem.symmetry import Reflection, Sector, keeps, sectors

_IMAGE_CORRELATION = 1.0 - 1e-6  # least, of a mode's inertia with its mirror image's


@dataclass(frozen=True)
class JointSector:
    """Matrices in one sector: mass, stiffness, geometric, then of each contact stiffness."""

    part: Sector
    matrices: tuple[Float[ndarray, "own own"], ...]


def joint_sectors(
    assembly: xr.Dataset, *matrices: Float[ndarray, "dof dof"]
) -> tuple[JointSector, ...]:
    """The sectors of a joint, the mass being the first of its matrices; one sector without any.

    Contact whose places are not known has no reflections.
    """
    axes = range(3) if "pair_position" in assembly else ()
    found = [_reflection(assembly, matrices[0], axis) for axis in axes]
    mirrors = [one for one in found if one and all(keeps(one, matrix) for matrix in matrices)]
    return tuple(
        JointSector(part, tuple(part.columns.T @ (matrix @ part.columns) for matrix in matrices))
        for part in sectors(mirrors, len(matrices[0]))
        if len(part.first)
    )


def _reflection(
    assembly: xr.Dataset, mass: Float[ndarray, "dof dof"], axis: int
) -> Reflection | None:
    """The reflection in the plane normal to an axis; None where contact or modes have no image."""
    pair = mirror_nodes(assembly["pair_position"].values, axis)
    if np.any(pair < 0):
        return None
    image, sign = np.arange(len(mass)), np.ones(len(mass))
    for dof in (assembly["beam_dof"].values, assembly["slot_dof"].values):
        image[dof] = dof[pair]
        sign[dof[:, axis]] = -1.0
    contact = np.unique([assembly["beam_dof"].values, assembly["slot_dof"].values])
    modes = np.setdiff1d(np.arange(len(mass)), contact)
    inertia = mass[np.ix_(contact, modes)]
    place = np.searchsorted(contact, image[contact])
    turned = np.empty_like(inertia)
    turned[place] = sign[contact, None] * inertia
    size = np.linalg.norm(inertia, axis=0)
    if len(modes) and not size.min() > 0.0:
        return None
    alike = (turned / size).T @ (inertia / size)
    if len(modes):
        other = np.abs(alike).argmax(axis=1)
        likeness = alike[np.arange(len(modes)), other]
        if np.abs(likeness).min() < _IMAGE_CORRELATION or len(np.unique(other)) < len(modes):
            return None
        image[modes], sign[modes] = modes[other], np.sign(likeness)
    return Reflection(image, sign)
