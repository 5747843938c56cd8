"""The eight-node brick with incompatible modes, as CalculiX's C3D8I has it.

Three parabolas an element, 1 - xi^2, 1 - eta^2, 1 - zeta^2, take the bending that eight nodes
cannot follow (Wilson). CalculiX keeps them as unknowns that carry mass, and takes their gradients
by the Jacobian at the element's centre, without the ratio of determinants that would let skewed
elements pass the patch test. 2 x 2 x 2 Gauss points. It shares nothing with the library's element.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from bladeroot.fem.geometry import Material

# The corners of a hexahedron in CalculiX's order.
CORNERS = np.array([(i, j, k) for k in (-1, 1) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


@dataclass(frozen=True)
class Bricks:
    """Elements at their Gauss points: volumes, gradients and values of 8 shapes and 3 modes.

    unknowns: (element, 11), the element's nodes and, numbered after all nodes, its modes. hooke:
    (element, 3, 3, 3, 3) in Pa; density: kg/m^3.
    """

    unknowns: np.ndarray
    volumes: np.ndarray
    values: np.ndarray
    gradients: np.ndarray
    hooke: np.ndarray
    density: np.ndarray


def bricks(nodes: np.ndarray, elements: np.ndarray, materials: list[Material]) -> Bricks:
    """Elements on nodes (n, 3) in m, their corners in CalculiX's order; one material an element."""
    points = CORNERS / np.sqrt(3.0)
    shapes = (1 + points[:, None] * CORNERS).prod(axis=2) / 8
    local, middle = _slopes(points), _slopes(np.zeros((1, 3)))[0]
    jacobian = np.einsum("eai,qaj->eqij", nodes[elements], local)
    centre = np.einsum("eai,aj->eij", nodes[elements], middle)
    inner = np.einsum("eqij,qaj->eqai", np.linalg.inv(jacobian).swapaxes(2, 3), local)
    parabolas = -2 * points[:, :, None] * np.eye(3)
    modes = np.einsum("eij,qaj->eqai", np.linalg.inv(centre).swapaxes(1, 2), parabolas)
    extra = len(nodes) + np.arange(3 * len(elements)).reshape(-1, 3)
    return Bricks(
        np.concatenate([elements, extra], axis=1),
        np.linalg.det(jacobian),
        np.concatenate([shapes, 1 - points**2], axis=1),
        np.concatenate([inner, modes], axis=2),
        np.stack([isotropic(material) for material in materials]),
        np.array([material.density for material in materials]),
    )


def stiffness(mesh: Bricks) -> sp.csr_array:
    """Elastic stiffness (N/m), (3 unknown, 3 unknown)."""
    flat = np.zeros((*mesh.volumes.shape, 3, 3))
    return _gather(mesh, strained(mesh.gradients, mesh.volumes, mesh.hooke, flat))


def mass(mesh: Bricks) -> sp.csr_array:
    """Mass (kg), (3 unknown, 3 unknown)."""
    local = np.einsum("e,eq,qa,qb->eab", mesh.density, mesh.volumes, mesh.values, mesh.values)
    return _gather(mesh, np.einsum("eab,ij->eaibj", local, np.eye(3)))


def prestressed(mesh: Bricks, moves: np.ndarray) -> tuple[sp.csr_array, sp.csr_array]:
    """What static displacements (unknown, 3) in m leave behind, (3 unknown, 3 unknown) in N/m.

    The geometric stiffness of their stress, and the elastic stiffness of the strained shape.
    """
    g = mesh.gradients
    slope = np.einsum("eqaj,eai->eqij", g, moves[mesh.unknowns])
    stress = np.einsum("eijkl,eqkl->eqij", mesh.hooke, slope, optimize=True)
    local = np.einsum("eq,eqij,eqai,eqbj->eab", mesh.volumes, stress, g, g, optimize=True)
    geometric = _gather(mesh, np.einsum("eab,ij->eaibj", local, np.eye(3)))
    return geometric, _gather(mesh, strained(g, mesh.volumes, mesh.hooke, slope))


def strained(
    gradients: np.ndarray, volumes: np.ndarray, hooke: np.ndarray, slope: np.ndarray
) -> np.ndarray:
    """Elastic element matrices (e, a, 3, b, 3), N/m, about a state of displacement gradient.

    gradients: (e, q, a, 3); slope: (e, q, 3, 3). Strain is Green's, so its variation is that of the
    displacement's gradient, turned and stretched by F = 1 + slope (initial displacement stiffness).
    """
    count = gradients.shape[2]
    local = np.zeros((len(gradients), count, 3, count, 3))
    for q in range(gradients.shape[1]):
        f, g = slope[:, q] + np.eye(3), gradients[:, q]
        law = np.einsum("e,emi,eijkl,enk->emjnl", volumes[:, q], f, hooke, f, optimize=True)
        local += np.einsum("eaj,emjnl,ebl->eambn", g, law, g, optimize=True)
    return local


def _slopes(points: np.ndarray) -> np.ndarray:
    """Derivatives of the eight shapes by the local coordinates, (point, 8, 3)."""
    factors = 1 + points[:, None] * CORNERS
    others = [factors[:, :, [1, 2]], factors[:, :, [0, 2]], factors[:, :, [0, 1]]]
    return np.stack([o.prod(axis=2) for o in others], axis=2) * CORNERS / 8


def isotropic(material: Material) -> np.ndarray:
    """Hooke's law as a tensor (3, 3, 3, 3), Pa."""
    e, v = material.young, material.poisson
    one = np.eye(3)
    second = e / (2 * (1 + v))
    twist = np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one)
    return e * v / ((1 + v) * (1 - 2 * v)) * np.einsum("ij,kl->ijkl", one, one) + second * twist


def gather(local: np.ndarray, dofs: np.ndarray) -> sp.csr_array:
    """Sum element matrices (e, a, 3, b, 3) into one, at their dofs (e, 3 a)."""
    width = dofs.shape[1]
    local = local.reshape(-1, width, width)
    local = (local + local.swapaxes(1, 2)) / 2
    rows, columns = np.repeat(dofs, width, axis=1), np.tile(dofs, (1, width))
    size = int(dofs.max()) + 1
    return sp.csr_array((local.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))


def _gather(mesh: Bricks, local: np.ndarray) -> sp.csr_array:
    return gather(local, (3 * mesh.unknowns[:, :, None] + np.arange(3)).reshape(-1, 33))
