"""Load stiffness of a pressure that stays normal to the flanks as they move: the follower load.

A dead load keeps its direction; the thesis's Table 4.2 shows that it used one. A pressure turns
with its surface, so that a rigid rotation is not stiffened at all.
"""

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float
from numpy import ndarray


def load_stiffness(mesh: xr.Dataset) -> sp.csr_array:
    """Load stiffness of the beam per newton of axial force (1/m), (3 node, 3 node).

    The force of pressure p on n dA = x,s x x,t ds dt is -p times its integral with the shapes; this
    is minus its derivative by the displacement. It is not symmetric: the remainder,
    (K - K^T)/2, is a line integral along the flanks' edges, where a pressure that ends is not
    conservative. K plus the geometric stiffness takes no force in a rigid rotation.
    """
    count = int((mesh.node_body == 0).sum())
    faces, normals, pressures = _faces(mesh)
    x, w = np.polynomial.legendre.leggauss(3)
    shape = np.stack([x * (x - 1) / 2, 1 - x**2, x * (x + 1) / 2], axis=1)
    slope = np.stack([x - 0.5, -2 * x, x + 0.5], axis=1)

    def tensor(a: ndarray, b: ndarray) -> Float[ndarray, "9 9"]:
        return np.einsum("pi,qj->pqij", a, b).reshape(9, 9)

    value, by_s, by_t = tensor(shape, shape), tensor(slope, shape), tensor(shape, slope)
    weight = np.outer(w, w).ravel()
    position = mesh.node_position.values[faces]
    along_s = np.einsum("qa,fai->fqi", by_s, position)
    along_t = np.einsum("qa,fai->fqi", by_t, position)
    outward = np.einsum("fqi,fi->f", np.cross(along_s, along_t), normals)
    strength = pressures * np.sign(outward)
    # u,s x x,t + x,s x u,t = u_b x (N_b,s x,t - N_b,t x,s)
    turn = np.einsum("qb,fqk->fqbk", by_s, along_t) - np.einsum("qb,fqk->fqbk", by_t, along_s)
    cross = np.zeros((3, 3, 3))
    cross[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0
    cross[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = -1.0
    local = np.einsum(
        "f,q,qa,fqbk,ijk->faibj", strength, weight, value, turn, cross, optimize=True
    ).reshape(-1, 27, 27)
    dofs = (3 * faces[:, :, None] + np.arange(3)).reshape(-1, 27)
    rows, columns = np.repeat(dofs, 27, axis=1), np.tile(dofs, (1, 27))
    return sp.csr_array(
        (local.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * count, 3 * count)
    )


def symmetric(matrix: sp.csr_array) -> sp.csr_array:
    """The symmetric part of a matrix."""
    return sp.csr_array((matrix + matrix.T) / 2)


def _faces(
    mesh: xr.Dataset,
) -> tuple[ndarray, Float[ndarray, "face 3"], Float[ndarray, " face"]]:
    """Element faces on the flanks: their nodes (face, 9), outward normals, pressures per newton."""
    faces, normals, pressures = [], [], []
    for flank, frame in enumerate(mesh.flank_frame.values):
        chosen = mesh.pair_flank.values == flank
        grid = mesh.pair_node.values[chosen, 0].reshape(3, -1)
        pressure = 1.0 / (2.0 * abs(frame[0, 0]) * mesh.pair_weight.values[chosen].sum())
        for start in range(0, grid.shape[1] - 2, 2):
            faces.append(grid[:, start : start + 3].ravel())
            normals.append(frame[0])
            pressures.append(pressure)
    return np.array(faces), np.array(normals), np.array(pressures)
