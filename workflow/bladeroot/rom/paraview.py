"""Mesh and mode shapes as arrays that ParaView draws: triquadratic hexahedra, or nodes alone."""

import numpy as np
import scipy.sparse as sp
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.linear import lowest_eigenpairs
from bladeroot.rom.full import FullJoint

# Where VTK's nodes of a triquadratic hexahedron lie along the element's X, Y, Z: 8 corners, 12
# edges, 6 faces, the centre.
VTK_NODES = np.array(
    [
        *[(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)],
        *[(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)],
        *[(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)],
        *[(0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2)],
        (1, 1, 1),
    ]
)
# Below every eigenvalue of the loaded free beam up to 30 kN.
_SHIFT = -((2 * np.pi * 1000.0) ** 2)
_BEAM_MODES = 12  # six rigid motions among them
_JOINT_MODES = 8


def points_and_cells(
    mesh: xr.Dataset,
) -> tuple[Float[ndarray, "node 3"], dict[str, Int[ndarray, "cell k"]], dict[str, list[ndarray]]]:
    """Nodes (m), cells by type and the body of each cell; a mesh without elements gives its nodes.

    `hexahedron27` is VTK_TRIQUADRATIC_HEXAHEDRON.
    """
    points = mesh.node_position.values
    if "element_nodes" not in mesh:
        cells = {"vertex": np.arange(len(points))[:, None]}
        return points, cells, {"body": [mesh.node_body.values]}
    order = VTK_NODES @ [9, 3, 1]
    cells = {"hexahedron27": mesh.element_nodes.values[:, order]}
    return points, cells, {"body": [mesh.element_body.values], "part": [mesh.element_part.values]}


def mode_shapes(
    full: FullJoint, mesh: xr.Dataset, force: float, kn: float, kt: float
) -> dict[str, Float[ndarray, "node 3"]]:
    """Shapes by name, largest displacement 1: the loaded beam alone, then the joint.

    `force` is axial, N; `kn` and `kt` are totals of a flank, N/m. The name has the frequency, below
    zero where the load makes a rigid motion unstable; the free beam's six rigid motions are the
    first of its shapes.
    """
    loaded = sp.csr_array(full.stiffness + force * full.geometric)
    nodes = int((mesh.node_body == 0).sum())
    beam = np.unique(full.number[: 3 * nodes])
    beam = beam[beam >= 0]
    parts = [sp.csr_array(matrix[beam][:, beam]) for matrix in (loaded, full.mass)]
    alone, shapes = lowest_eigenpairs(*parts, _BEAM_MODES, _SHIFT)
    spread = np.zeros((full.mass.shape[0], _BEAM_MODES))
    spread[beam] = shapes
    springs = sp.csr_array(loaded + kn * full.normal + kt * full.tangential)
    joined, joint = lowest_eigenpairs(springs, full.mass, _JOINT_MODES)
    return {
        **_named(f"beam at {force:g} N", alone, spread, full.number),
        **_named(f"joint at {force:g} N", joined, joint, full.number),
    }


def _named(
    what: str, values: Float[ndarray, " m"], shapes: Float[ndarray, "dof m"], number: ndarray
) -> dict[str, Float[ndarray, "node 3"]]:
    hertz = np.sign(values) * np.sqrt(np.abs(values)) / (2 * np.pi)
    moves = np.where((number >= 0)[:, None], shapes[number], 0.0).reshape(-1, 3, len(values))
    moves = moves / np.linalg.norm(moves, axis=1).max(axis=0)
    return {
        f"{what}, {k:02d}: {frequency:.1f} Hz": np.ascontiguousarray(moves[:, :, k - 1])
        for k, frequency in enumerate(hertz, 1)
    }
