"""The joint of given matrices with all their degrees of freedom."""

import numpy as np
import scipy.sparse as sp
import xarray as xr

from bladeroot.rom.external.bodies import Body
from bladeroot.rom.full import FullJoint, with_contact


def full_joint_of(bodies: list[Body], mesh: xr.Dataset) -> FullJoint:
    """Beam and slots (see `load_bodies`) with contact springs between the pairs of `mesh`."""
    beam, *slots = bodies
    starts = np.cumsum([0, *(body.mass.shape[0] for body in bodies)])
    number = [
        np.where(body.dof[:, :3] >= 0, body.dof[:, :3] + start, -1).ravel()
        for body, start in zip(bodies, starts, strict=False)
    ]
    empty = [sp.csr_array(slot.mass.shape) for slot in slots]
    parts = (
        [body.mass for body in bodies],
        [body.stiffness for body in bodies],
        [beam.geometric, *empty],
    )
    whole = (sp.csr_array(sp.block_diag(part, format="csr")) for part in parts)
    return with_contact(mesh, np.concatenate(number), *whole)
