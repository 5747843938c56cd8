"""Static stress of the free beam under dead normal pressure on its four flanks (thesis 4.3).

The loads balance by themselves, so the beam is held at six degrees of freedom that take no force;
the stress does not depend on where.
"""

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Material, Structure
from bladeroot.fem.linear import factor
from bladeroot.fem.mesh import Mesh, body_mesh
from bladeroot.variables import dataset


def materials_of(structure: Structure, mesh: xr.Dataset, body: int) -> list[Material]:
    """Materials that `element_part` of one body refers to."""
    if body > 0:
        return [structure.slot.material]
    return [structure.material] + ([structure.pad.material] if mesh.attrs["with_pad"] else [])


def flank_loads(mesh: xr.Dataset) -> Float[ndarray, "node 3"]:
    """Nodal loads on the beam's flanks per newton of axial force: F / (2 sin theta) each (N/N).

    The normal load of a flank is spread as a uniform pressure; Simpson's weights are its consistent
    nodal loads.
    """
    count = int((mesh.node_body == 0).sum())
    loads = np.zeros((count, 3))
    for flank, frame in enumerate(mesh.flank_frame.values):
        normal = frame[0]
        chosen = mesh.pair_flank.values == flank
        share = mesh.pair_weight.values[chosen] / mesh.pair_weight.values[chosen].sum()
        nodes = mesh.pair_node.values[chosen, 0]
        loads[nodes] -= share[:, None] * normal / (2.0 * abs(normal[0]))
    return loads


def solve_free(
    mesh: Mesh, stiffness: sp.csr_array, loads: Float[ndarray, "node 3"]
) -> tuple[Float[ndarray, "node 3"], Float[ndarray, " support"]]:
    """Displacements (m) of an unsupported body under self-balanced loads, and support reactions.

    Held at six degrees of freedom that exclude rigid motion and no strain, then freed of its mean
    translation and rotation. ValueError if the loads do not balance to 1e-9 of their size.
    """
    rigid = elasticity.rigid_modes(mesh.nodes)
    scale = np.abs(loads).sum() * np.abs(mesh.nodes).max()
    resultant = rigid.T @ loads.ravel()
    if not np.abs(resultant).max() <= 1e-9 * max(scale, np.abs(loads).sum()):
        raise ValueError(f"loads must balance, got force and moment {resultant}")
    held = supports(mesh.nodes)
    free = np.setdiff1d(np.arange(3 * len(mesh.nodes)), held)
    displacement = np.zeros(3 * len(mesh.nodes))
    displacement[free] = factor(stiffness[free][:, free])(loads.ravel()[free])
    reactions = stiffness[held] @ displacement - loads.ravel()[held]
    displacement -= rigid @ np.linalg.lstsq(rigid, displacement, rcond=None)[0]
    return displacement.reshape(-1, 3), reactions


def supports(nodes: Float[ndarray, "node 3"]) -> Int[ndarray, "6"]:
    """Six dofs that exclude rigid motion and prevent no strain: 3, 2 and 1 of three nodes."""
    first = int(np.argmin(nodes @ [1.0, 1.0, 1.0]))
    second = int(np.argmax(np.linalg.norm(nodes - nodes[first], axis=1)))
    line = (nodes[second] - nodes[first]) / np.linalg.norm(nodes[second] - nodes[first])
    off = nodes - nodes[first]
    off = off - np.outer(off @ line, line)
    third = int(np.argmax(np.linalg.norm(off, axis=1)))
    # Of the nine dofs of the three nodes, the six that span the rigid motions best.
    dofs = np.concatenate([3 * k + np.arange(3) for k in (first, second, third)])
    rows = elasticity.rigid_modes(nodes / np.abs(nodes).max())[dofs]
    chosen: list[int] = []
    for _ in range(6):
        chosen.append(int(np.argmax(np.linalg.norm(rows, axis=1))))
        axis = rows[chosen[-1]] / np.linalg.norm(rows[chosen[-1]])
        rows = rows - np.outer(rows @ axis, axis)
    return np.sort(dofs[chosen])


def prestress(structure: Structure, mesh: xr.Dataset) -> xr.Dataset:
    """Displacement and stress of the beam per newton of axial force, with the balance checks.

    The reference load is one newton; every force is a multiple of it (thesis eqs 4.1, 4.2).
    """
    beam, _ = body_mesh(mesh, 0)
    materials = materials_of(structure, mesh, 0)
    rule = elasticity.quadrature(beam)
    stiffness = elasticity.stiffness(beam, rule, materials)
    loads = flank_loads(mesh)
    displacement, reactions = solve_free(beam, stiffness, loads)
    stresses = elasticity.stress(beam, rule, materials, displacement)
    rigid = elasticity.rigid_modes(beam.nodes)
    # Virtual work of a uniform stretch along X: the mean axial stress times the volume.
    volume_stress = np.einsum("eqij,eq->ij", stresses, rule.volumes)
    work = loads.T @ beam.nodes
    made = {
        "load": loads,
        "displacement": displacement,
        "stress": stresses,
        "resultant": rigid.T @ loads.ravel(),
        "reaction": reactions,
        "virial_error": (volume_stress - (work + work.T) / 2) / np.abs(work).max(),
    }
    whole = dataset("fem/prestress", made).assign_attrs(
        structure=structure.name, with_pad=mesh.attrs["with_pad"]
    )
    return whole.assign_coords(axis=list("XYZ"), rigid_motion=["X", "Y", "Z", "Rx", "Ry", "Rz"])
