"""Mass, stiffness and geometric stiffness by batched contractions over all elements at once.

Mass and geometric stiffness act alike on each axis, so they are kept as node-by-node matrices;
`per_axis` spreads them to three degrees of freedom a node (3*node + axis).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.geometry import Material
from bladeroot.fem.mesh import Mesh


@dataclass(frozen=True)
class Quadrature:
    """3 x 3 x 3 Gauss points of every element: shapes, physical gradients, volumes.

    Exact for mass and stiffness of straight blocks, of order h^5 on tapered ones.
    """

    shapes: Float[ndarray, "point 27"]
    gradients: Float[ndarray, "element point 27 3"]
    volumes: Float[ndarray, "element point"]


def quadrature(mesh: Mesh) -> Quadrature:
    """Gauss rule on a mesh; ValueError if an element is turned inside out."""
    x, w = np.polynomial.legendre.leggauss(3)
    shape = np.stack([x * (x - 1) / 2, 1 - x**2, x * (x + 1) / 2], axis=1)
    slope = np.stack([x - 0.5, -2 * x, x + 0.5], axis=1)

    def tensor(a: ndarray, b: ndarray, c: ndarray) -> ndarray:
        return np.einsum("pi,qj,rk->pqrijk", a, b, c).reshape(27, 27)

    shapes = tensor(shape, shape, shape)
    local = np.stack(
        [tensor(slope, shape, shape), tensor(shape, slope, shape), tensor(shape, shape, slope)],
        axis=-1,
    )
    weights = np.einsum("p,q,r->pqr", w, w, w).ravel()
    jacobian = np.einsum("eai,qaj->eqij", mesh.nodes[mesh.elements], local, optimize=True)
    determinant = np.linalg.det(jacobian)
    if not determinant.min() > 0:
        bad = int(np.argwhere(~(determinant > 0))[0, 0])
        centre = mesh.nodes[mesh.elements[bad]].mean(axis=0)
        raise ValueError(f"element {bad} at {centre} m is turned inside out")
    gradients = np.einsum("qaj,eqji->eqai", local, np.linalg.inv(jacobian), optimize=True)
    return Quadrature(shapes, gradients, determinant * weights)


def lame(
    mesh: Mesh, materials: Sequence[Material]
) -> tuple[Float[ndarray, " element"], Float[ndarray, " element"]]:
    """Lame's two constants (Pa) of each element."""
    e = np.array([m.young for m in materials])[mesh.part]
    v = np.array([m.poisson for m in materials])[mesh.part]
    return e * v / ((1 + v) * (1 - 2 * v)), e / (2 * (1 + v))


def stiffness(mesh: Mesh, rule: Quadrature, materials: Sequence[Material]) -> sp.csr_array:
    """Elastic stiffness K0 (N/m), (3 node, 3 node)."""
    first, second = lame(mesh, materials)
    count = len(mesh.elements)
    # One matrix of gradient products gives all three terms of isotropic elasticity.
    flat = rule.gradients.reshape(count, 27, 81)
    products = np.matmul((flat * rule.volumes[..., None]).transpose(0, 2, 1), flat)
    products = products.reshape(count, 27, 3, 27, 3)
    products = products.transpose(0, 1, 3, 2, 4)  # element, node a, node b, axis i, axis j
    local = first[:, None, None, None, None] * products
    local += second[:, None, None, None, None] * products.swapaxes(3, 4)
    trace = second[:, None, None] * np.einsum("eabii->eab", products)
    for i in range(3):
        local[..., i, i] += trace
    return _gather(local, mesh.elements, len(mesh.nodes))


def mass(mesh: Mesh, rule: Quadrature, materials: Sequence[Material]) -> sp.csr_array:
    """Consistent mass of one axis (kg), (node, node)."""
    density = np.array([m.density for m in materials])[mesh.part]
    weights = density[:, None] * rule.volumes
    local = np.matmul((weights[:, :, None] * rule.shapes).transpose(0, 2, 1), rule.shapes)
    return _gather(local[..., None, None], mesh.elements, len(mesh.nodes))


def stress(
    mesh: Mesh,
    rule: Quadrature,
    materials: Sequence[Material],
    displacement: Float[ndarray, "node 3"],
) -> Float[ndarray, "element point 3 3"]:
    """Cauchy stress (Pa) at the Gauss points for small displacements (m)."""
    first, second = lame(mesh, materials)
    slope = np.einsum("eai,eqaj->eqij", displacement[mesh.elements], rule.gradients, optimize=True)
    strain = (slope + slope.transpose(0, 1, 3, 2)) / 2
    volume = np.einsum("eqii->eq", strain)
    spherical = (first[:, None] * volume)[:, :, None, None] * np.eye(3)
    return spherical + 2 * second[:, None, None, None] * strain


def geometric_stiffness(
    mesh: Mesh, rule: Quadrature, stresses: Float[ndarray, "element point 3 3"]
) -> sp.csr_array:
    """Geometric stiffness of one axis (N/m), (node, node), from the full stress tensor.

    Eq. 4.2; dead loads, no follower stiffness.
    """
    count = len(mesh.elements)
    scaled = np.matmul(rule.gradients, stresses * rule.volumes[:, :, None, None])
    local = np.matmul(
        scaled.transpose(0, 2, 1, 3).reshape(count, 27, 81),
        rule.gradients.transpose(0, 1, 3, 2).reshape(count, 81, 27),
    )
    return _gather(local[..., None, None], mesh.elements, len(mesh.nodes))


def per_axis(matrix: sp.csr_array) -> sp.csr_array:
    """The same node-by-node matrix on each of the three axes, (3 node, 3 node)."""
    return sp.csr_array(sp.kron(matrix, sp.eye_array(3), format="csr"))


def rigid_modes(nodes: Float[ndarray, "node 3"]) -> Float[ndarray, "dof 6"]:
    """Translations along and rotations about X, Y, Z through the origin, columns (3 node)."""
    modes = np.zeros((len(nodes), 3, 6))
    x, y, z = nodes.T
    modes[:, [0, 1, 2], [0, 1, 2]] = 1.0
    modes[:, 1, 3], modes[:, 2, 3] = -z, y
    modes[:, 0, 4], modes[:, 2, 4] = z, -x
    modes[:, 0, 5], modes[:, 1, 5] = -y, x
    return modes.reshape(-1, 6)


def _gather(
    local: Float[ndarray, "element n n b b"], index: Int[ndarray, "element n"], size: int
) -> sp.csr_array:
    """Sum element matrices of b x b node blocks into one sparse matrix."""
    b = local.shape[-1]
    local = (local + local.transpose(0, 2, 1, 4, 3)) / 2  # symmetric to the last bit
    keys = (index[:, :, None] * size + index[:, None, :]).ravel()
    # The node pattern is found once; sorting b*b times as many scalar entries would take longer
    # than everything else in the assembly.
    pattern, place = np.unique(keys, return_inverse=True)
    flat = local.reshape(-1, b * b)
    data = np.stack(
        [np.bincount(place, flat[:, k], minlength=len(pattern)) for k in range(b * b)], axis=1
    )
    starts = np.searchsorted(pattern, np.arange(size + 1) * size)
    blocks = sp.bsr_array(
        (data.reshape(-1, b, b), pattern % size, starts), shape=(b * size, b * size)
    )
    return sp.csr_array(blocks.tocsr())
