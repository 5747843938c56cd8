"""What must hold for given matrices, whatever the structure: `checks.nc` of kind `matrices`."""

import numpy as np
import xarray as xr

from bladeroot.rom.comparison import checks_dataset, row
from bladeroot.rom.external.bodies import Body, load_bodies, rigid_energy, rigid_motions
from bladeroot.rom.external.description import Description

# Largest relative residual; the load's own form on the flanks is not known, hence the last.
LIMITS = {"mass": 1.0e-6, "rigid motion": 1.0e-6, "load": 0.05}
_MOTIONS = ("X", "Y", "Z", "Rx", "Ry", "Rz")


def external_checks(description: Description, mesh: xr.Dataset) -> xr.Dataset:
    """Mass, rigid motions and load of given matrices, one row a comparison.

    A mass is the same along X, Y and Z (no limit for a body with nodes that are fixed in one
    direction); a free beam moves rigidly without strain, which fails where node positions and
    matrices do not belong together (no limit for a beam with fixed nodes); rigid rotations under
    dead load on the flanks stiffen by the load's virial, which fails where the geometric stiffness
    is not that of one newton of axial force.
    """
    bodies = load_bodies(description, mesh)
    rows = [one for body in bodies for one in _mass(body)]
    rows += _rigid(bodies[0])
    rows += _load(bodies[0], mesh)
    return checks_dataset(rows, mesh.attrs["structure"], mesh.attrs["description"])


def _mass(body: Body) -> list[dict]:
    moves = rigid_motions(body)[:, :3]
    found = np.einsum("di,di->i", moves, body.mass @ moves)
    axes = (body.dof[:, :3] >= 0).sum(axis=1)
    limit = np.nan if ((axes == 1) | (axes == 2)).any() else LIMITS["mass"]
    check = "mass is alike along X, Y and Z"
    return [
        row(check, f"{body.name}, {name}", np.nan, found[0], mass, limit, "mass", "kg")
        for name, mass in zip("YZ", found[1:], strict=True)
    ]


def _rigid(beam: Body) -> list[dict]:
    limit = LIMITS["rigid motion"] if (beam.dof[:, :3] >= 0).all() else np.nan
    about = ("relative energy", "1", 1.0)
    return [
        row("rigid motion of the free beam", name, np.nan, 0.0, energy, limit, *about)
        for name, energy in zip(_MOTIONS, rigid_energy(beam), strict=True)
    ]


def _load(beam: Body, mesh: xr.Dataset) -> list[dict]:
    """Rotation R without strain stores tr(W W^T V), W its skew matrix and V the load's virial."""
    flank, area = mesh.pair_flank.values, mesh.pair_weight.values
    share = area / np.bincount(flank, area)[flank]
    normal = mesh.flank_frame.values[flank, 0]
    force = -share[:, None] * normal / (2.0 * np.abs(normal[:, :1]))
    position = beam.nodes[mesh.pair_node.values[:, 0]]
    virial = np.einsum("pi,pj->ij", position - beam.nodes.mean(axis=0), force)
    motions = rigid_motions(beam)
    found = np.einsum("di,di->i", motions, beam.geometric @ motions)
    rows = []
    for k, name in enumerate(_MOTIONS[3:]):
        spin = np.cross(np.eye(3)[k], np.eye(3)).T
        exact = np.trace(spin.T @ spin @ virial)
        about = (LIMITS["load"], "rotational stiffness per force", "m", abs(exact))
        check = "rigid rotation under the load of 1 N"
        rows.append(row(check, name, np.nan, exact, found[3 + k], *about))
    return rows
