"""How an eigenvalue moves with the shape of the structure, without solving it again.

With the mesh's layout kept, the modes' nodal values, the static displacement u and an adjoint w
are carried to a neighbouring geometry as they are; to first order the eigenvalue follows

    L(p) = phi'(K + F Kg(u) + springs - lambda M) phi + F w'(f - K u),  K w = d(phi'Kg phi)/du,

because phi, u and w are stationary points of L. A neighbour costs integrals, no factor.
"""

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import Structure
from bladeroot.fem.linear import factor
from bladeroot.fem.mesh import body_mesh, build_mesh
from bladeroot.fem.prestress import flank_loads, materials_of, supports
from bladeroot.reproduction.cases import Mode, Model


def adjoints(model: Model, modes: Sequence[Mode]) -> Float[ndarray, "mode node 3"]:
    """Displacement w of the beam for each mode: what its eigenvalue feels of the static stress.

    Zero for modes without axial force. One factor for all.
    """
    beam, _ = body_mesh(model.mesh, 0)
    count = len(beam.nodes)
    result = np.zeros((len(modes), count, 3))
    loaded = [k for k, mode in enumerate(modes) if mode.case.force]
    if not loaded:
        return result
    rule = elasticity.quadrature(beam)
    first, second = elasticity.lame(beam, materials_of(model.structure, model.mesh, 0))
    right = np.empty((3 * count, len(loaded)))
    for column, k in enumerate(loaded):
        slope = _slopes(beam.elements, rule, modes[k].shape[:count])
        product = np.einsum("eqij,eqik->eqjk", slope, slope)
        trace = np.einsum("eqjj->eq", product) * first[:, None]
        stress = trace[:, :, None, None] * np.eye(3) + 2 * second[:, None, None, None] * product
        local = np.einsum("eqak,eqjk,eq->eaj", rule.gradients, stress, rule.volumes, optimize=True)
        force = np.zeros((count, 3))
        np.add.at(force, beam.elements, local)
        right[:, column] = force.ravel()
    # The beam is free and these loads balance: any six supports hold it without straining it.
    free = np.setdiff1d(np.arange(3 * count), supports(beam.nodes))
    solve = factor(sp.csr_array(model.full.stiffness[free][:, free]))
    for column, k in enumerate(loaded):
        result[k].reshape(-1)[free] = solve(right[free, column])
    return result


def lagrangian(
    structure: Structure,
    pad: bool,
    modes: Sequence[Mode],
    displacement: Float[ndarray, "beam_node 3"],
    adjoint: Float[ndarray, "mode beam_node 3"],
) -> Float[ndarray, " mode"]:
    """L of each mode, carried to `structure` from a structure whose mesh has the same layout.

    `displacement` is static, per newton. Differences of L between neighbours are those of the
    eigenvalues (rad^2/s^2). ValueError if the layout differs.
    """
    mesh = build_mesh(structure, with_pad=pad)
    nodes = {mode.shape.shape[0] for mode in modes}
    if nodes - {mesh.sizes["node"]}:
        raise ValueError(
            f"expected a mesh of {nodes} nodes, got {mesh.sizes['node']}: a dimension moved so far "
            "that the mesh has another number of elements"
        )
    result = np.array([_springs(mesh, mode) for mode in modes])
    loads = flank_loads(mesh)
    for body in range(3):
        chosen = [k for k, mode in enumerate(modes) if body == 0 or mode.case.slots]
        if not chosen:
            continue
        part, start = body_mesh(mesh, body)
        materials = materials_of(structure, mesh, body)
        rule = elasticity.quadrature(part)
        first, second = elasticity.lame(part, materials)
        density = np.array([one.density for one in materials])[part.part]
        static = elasticity.stress(part, rule, materials, displacement) if body == 0 else None
        for k in chosen:
            mode = modes[k]
            shape = mode.shape[start : start + len(part.nodes)]
            slope = _slopes(part.elements, rule, shape)
            strain = (slope + slope.swapaxes(2, 3)) / 2
            volume = np.einsum("eqii->eq", strain)
            elastic = first[:, None] * volume**2
            elastic += 2 * second[:, None] * np.einsum("eqij,eqij->eq", strain, strain)
            moved = np.einsum("qa,eai->eqi", rule.shapes, shape[part.elements], optimize=True)
            kinetic = density[:, None] * np.einsum("eqi,eqi->eq", moved, moved)
            density_of_l = elastic - mode.value * kinetic
            if body == 0 and mode.case.force:
                geometric = np.einsum("eqjk,eqij,eqik->eq", static, slope, slope, optimize=True)
                cross = np.einsum("eqij,eqij->eq", static, _slopes(part.elements, rule, adjoint[k]))
                density_of_l += mode.case.force * (geometric - cross)
                result[k] += mode.case.force * np.sum(loads * adjoint[k])
            result[k] += np.sum(density_of_l * rule.volumes)
    return result


def _slopes(
    elements: ndarray, rule: elasticity.Quadrature, field: Float[ndarray, "node 3"]
) -> Float[ndarray, "element point 3 3"]:
    """Gradient of a displacement field, component then direction."""
    return np.einsum("eai,eqaj->eqij", field[elements], rule.gradients, optimize=True)


def _springs(mesh: xr.Dataset, mode: Mode) -> float:
    """Twice the energy of the contact springs."""
    flank, area = mesh.pair_flank.values, mesh.pair_weight.values
    share = area / np.bincount(flank, area)[flank]
    beam, slot = mesh.pair_node.values.T
    gap = mode.shape[beam] - mode.shape[slot]
    local = np.einsum("pla,pa->pl", mesh.flank_frame.values[flank], gap)
    stiff = np.array([mode.case.kn, mode.case.kt, mode.case.kt])
    return float(share @ (local**2 @ stiff))
