"""Structured meshes of 27-node hexahedra: profile blocks in X-Z, extruded along Y.

Plain 8-node hexahedra lock in bending; quadratic ones do not, and one element across a flank by
five along the width puts 3 x 11 = 33 nodes on it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.geometry import Structure, flank_ends, jaw_inner_face, profile_edges
from bladeroot.fem.outline import Edge, cut
from bladeroot.variables import dataset

FLANKS = ("Xn-bottom", "Xn-top", "Xp-bottom", "Xp-top")
SLOTS = ("Xn", "Xp")
# Sign of x and of z on each flank, in the order of FLANKS.
_FLANK_SIGNS = ((-1, -1), (-1, 1), (1, -1), (1, 1))
# Nodes closer than this (m) are one node; an irrational step, so that round numbers such as
# mid-points of tabulated coordinates never fall on a rounding boundary.
_MERGE_DISTANCE = np.pi * 1.0e-8


@dataclass(frozen=True)
class Mesh:
    """Nodes, 27-node elements (local node (i*3 + j)*3 + k along X, Y, Z) and their material.

    `part` indexes the materials the mesh is given to `elasticity` with. Nodes are numbered along
    X first, then Z, then Y, which keeps the matrices' profile narrow.
    """

    nodes: Float[ndarray, "node 3"]
    elements: Int[ndarray, "element 27"]
    part: Int[ndarray, " element"]


Block = tuple[Float[ndarray, "_ _ 2"], int]


def block(
    low: Edge,
    high: Edge,
    elements: tuple[int, int],
    part: int = 0,
    growth: float = 1.0,
) -> Block:
    """A quadrilateral with nodes on straight lines between two edges, (2 nx + 1, 2 nz + 1, 2), m.

    `low` and `high` are the lower and upper edge, each from small to large x; middle nodes lie on
    them, so that an arc is followed. `growth` is the ratio of the last element's height to the
    first's.
    """
    nx, nz = elements
    sizes = growth ** (np.arange(nz) / max(nz - 1, 1))
    corners = np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    t = np.interp(np.arange(2 * nz + 1) / 2.0, np.arange(nz + 1), corners)[None, :, None]
    share = np.linspace(0.0, 1.0, 2 * nx + 1)
    grid = (1 - t) * low.at(share)[:, None] + t * high.at(share)[:, None]
    ring = np.stack([grid[:-2:2, :-2:2], grid[2::2, :-2:2], grid[2::2, 2::2], grid[:-2:2, 2::2]])
    ahead, behind = np.roll(ring, -1, axis=0) - ring, np.roll(ring, 1, axis=0) - ring
    turned = ahead[..., 0] * behind[..., 1] <= ahead[..., 1] * behind[..., 0]
    if turned.any():
        bad = ring[:, *np.argwhere(turned.any(axis=0))[0]]
        around = ", ".join(f"({1e3 * x:g}, {1e3 * z:g})" for x, z in bad)
        raise ValueError(
            "expected a block with its corners in turn and no angle of 180 degrees or more, "
            f"got one turned inside out at {around} mm"
        )
    return grid, part


def mirrored(grid: Block, sign_x: int, sign_z: int) -> Block:
    """A block on another side of the planes x = 0 and z = 0."""
    nodes, part = grid
    return nodes[::sign_x, ::sign_z] * [sign_x, sign_z], part


def extrude(blocks: list[Block], width: float, elements: int) -> Mesh:
    """Join blocks at coincident nodes and extrude them from -width/2 to width/2 along Y."""
    points = np.concatenate([grid.reshape(-1, 2) for grid, _ in blocks])
    _, first, merged = np.unique(
        np.round(points / _MERGE_DISTANCE).astype(np.int64),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    section = points[first]
    quads, parts, start = [], [], 0
    for grid, part in blocks:
        ids = merged.reshape(-1)[start : start + grid.shape[0] * grid.shape[1]]
        ids = ids.reshape(grid.shape[:2])
        start += ids.size
        for i in range(0, ids.shape[0] - 2, 2):
            for k in range(0, ids.shape[1] - 2, 2):
                quads.append(ids[i : i + 3, k : k + 3])
                parts.append(part)
    quad = np.stack(quads)
    levels = 2 * elements + 1
    y = np.linspace(-width / 2, width / 2, levels)
    nodes = np.empty((len(section), levels, 3))
    nodes[:, :, [0, 2]] = section[:, None, :]
    nodes[:, :, 1] = y
    j = 2 * np.arange(elements)[:, None] + np.arange(3)
    # (quad, i, k) and (row, j) -> (quad, row, i, j, k)
    hexes = quad[:, None, :, None, :] * levels + j[None, :, None, :, None]
    return Mesh(
        nodes.reshape(-1, 3),
        hexes.reshape(-1, 27).astype(np.int64),
        np.repeat(np.asarray(parts, dtype=np.int64), elements),
    )


def beam_mesh(structure: Structure, with_pad: bool) -> Mesh:
    """The beam (part 0), with the pad (part 1) glued under it if asked for."""
    density, pad = structure.density, structure.pad
    edges = profile_edges(structure)
    if pad is not None:
        edges = [edge for part in cut(edges, pad.length / 2) for edge in part]
    right = [
        block(_below(edge), edge, (_elements(structure, edge), density.thickness)) for edge in edges
    ]
    if with_pad:
        if pad is None:
            raise ValueError(f"structure {structure.name} has no pad to mesh")
        (start, h), (end, _) = edges[0].start, edges[0].end
        floor = Edge((start, -h - pad.thickness), (end, -h - pad.thickness))
        right.append(block(floor, _below(edges[0]), (_elements(structure, edges[0]), 1), part=1))
    blocks = [mirrored(one, sign, 1) for sign in (-1, 1) for one in right]
    return extrude(blocks, structure.width, density.width)


def _below(edge: Edge) -> Edge:
    """An edge mirrored in z = 0."""
    points = (edge.start, edge.end, edge.centre)
    return Edge(*(None if point is None else (point[0], -point[1]) for point in points))


def _elements(structure: Structure, edge: Edge) -> int:
    """How many elements along an edge of the beam."""
    if edge.start == flank_ends(structure)[0]:
        return 1
    straight = edge.start[1] == edge.end[1] == structure.profile[0][1]
    density = structure.density
    return edge.elements(density.span_size if straight else density.root_size)


def slot_mesh(structure: Structure, side: str) -> Mesh:
    """One slot ("Xn" or "Xp"): two jaws on a base block whose far face is to be fixed.

    Its nodes on the flanks coincide with the beam's.
    """
    slot, density = structure.slot, structure.density
    inner = jaw_inner_face(structure)
    back, ceiling = inner[-1].end
    top, end = ceiling + slot.jaw_depth, back + slot.base_depth
    base = (density.base, density.jaw)
    blocks = []
    for edge in inner:
        high = Edge((edge.start[0], top), (edge.end[0], top))
        size = density.root_size
        count = max(edge.elements(np.inf), round((edge.end[0] - edge.start[0]) / size))
        count = 1 if edge.start == flank_ends(structure)[0] else count
        blocks.append(block(edge, high, (count, density.jaw), growth=8.0))
    floor, roof = (Edge((back, z), (end, z)) for z in (ceiling, top))
    blocks.append(block(floor, roof, base, growth=8.0))
    blocks += [mirrored(one, 1, -1) for one in blocks]
    blocks.append(block(_below(floor), floor, (base[0], 2)))
    if side == "Xn":
        blocks = [mirrored(one, -1, 1) for one in blocks]
    elif side != "Xp":
        raise ValueError(f"side must be one of {SLOTS}, got {side!r}")
    return extrude(blocks, structure.width, density.width)


def flank_frames(structure: Structure) -> Float[ndarray, "4 3 3"]:
    """Local axes (normal out of the beam, along Y, along the slope) of the four flanks, eq. 5.3."""
    (x0, z0), (x1, z1) = flank_ends(structure)
    length = np.hypot(x1 - x0, z1 - z0)
    c, s = (z1 - z0) / length, (x1 - x0) / length
    frames = np.zeros((4, 3, 3))
    for frame, (sx, sz) in zip(frames, _FLANK_SIGNS, strict=True):
        nx, nz = -sx * c, sz * s
        frame[:] = [[nx, 0, nz], [0, 1, 0], [-nz, 0, nx]]
    return frames


def flank_nodes(structure: Structure, mesh: Mesh, flank: int) -> Int[ndarray, " pair"]:
    """Nodes of one flank, ordered from its inner to its outer end, then along Y."""
    sx, sz = _FLANK_SIGNS[flank]
    (x0, z0), (x1, z1) = np.asarray(flank_ends(structure)) * [sx, sz]
    length = np.hypot(x1 - x0, z1 - z0)
    tx, tz = (x1 - x0) / length, (z1 - z0) / length
    dx, dz = mesh.nodes[:, 0] - x0, mesh.nodes[:, 2] - z0
    along, off = dx * tx + dz * tz, dx * tz - dz * tx
    found = np.flatnonzero((abs(off) < 1e-8) & (along > -1e-8) & (along < length + 1e-8))
    order = np.lexsort((mesh.nodes[found, 1], np.round(along[found] / _MERGE_DISTANCE)))
    expected = 3 * (2 * structure.density.width + 1)
    if len(found) != expected:
        raise ValueError(f"flank {FLANKS[flank]}: expected {expected} nodes, found {len(found)}")
    return found[order]


def flank_weights(structure: Structure) -> Float[ndarray, " pair"]:
    """Area (m^2) that each node of a flank stands for: Simpson's rule, exact for quadratic fields.

    The same weights are the consistent nodal loads of a uniform pressure.
    """
    (x0, z0), (x1, z1) = flank_ends(structure)
    n = structure.density.width
    across = np.array([1.0, 4.0, 1.0]) / 6.0
    along = np.zeros(2 * n + 1)
    for k in range(n):
        along[2 * k : 2 * k + 3] += across / n
    return np.hypot(x1 - x0, z1 - z0) * structure.width * np.outer(across, along).ravel()


def display_nodes(structure: Structure, mesh: Mesh) -> Int[ndarray, " display"]:
    """Nodes on the middle line of the straight span's upper face, in order of x."""
    h, end = structure.profile[0][1], structure.profile[1][0]
    x, y, z = mesh.nodes.T
    found = np.flatnonzero((abs(y) < 1e-9) & (abs(z - h) < 1e-9) & (abs(x) < end + 1e-9))
    return found[np.argsort(x[found])]


def base_nodes(mesh: Mesh) -> Int[ndarray, " base"]:
    """Nodes of the slot's far face, the largest |x|."""
    distance = abs(mesh.nodes[:, 0])
    return np.flatnonzero(distance > distance.max() - 1e-8)


def build_mesh(structure: Structure, with_pad: bool | None = None) -> xr.Dataset:
    """Mesh of the beam and both slots as one Dataset.

    `with_pad` None follows the structure's loaded case. Bodies are 0 beam, 1 slot Xn, 2 slot Xp;
    parts are 0 the body's own material, 1 the pad. Nodes of different bodies are distinct, also
    where they coincide (thesis 4.2).
    """
    with_pad = structure.with_pad if with_pad is None else with_pad
    try:
        beam = beam_mesh(structure, with_pad)
        bodies = [beam, *(slot_mesh(structure, side) for side in SLOTS)]
    except ValueError as error:
        raise ValueError(f"structure {structure.name}: {error}") from None
    starts = np.cumsum([0, *(len(body.nodes) for body in bodies)])
    pairs = [flank_nodes(structure, beam, k) for k in range(4)]
    partners = [
        flank_nodes(structure, bodies[1 + k // 2], k) + starts[1 + k // 2] for k in range(4)
    ]
    nodes = np.concatenate([body.nodes for body in bodies])
    gap = abs(nodes[np.concatenate(pairs)] - nodes[np.concatenate(partners)]).max()
    if not gap <= 1e-8:
        raise ValueError(f"contact nodes of beam and slots must coincide, largest gap {gap:.1e} m")
    made = {
        "node_position": nodes,
        "element_nodes": np.concatenate(
            [body.elements + s for body, s in zip(bodies, starts[:-1], strict=True)]
        ),
        "element_part": np.concatenate([body.part for body in bodies]),
        "element_body": np.repeat(np.arange(3), [len(body.elements) for body in bodies]),
        "node_body": np.repeat(np.arange(3), np.diff(starts)),
        "pair_node": np.stack([np.concatenate(pairs), np.concatenate(partners)], axis=1),
        "pair_flank": np.repeat(np.arange(4), len(pairs[0])),
        "pair_weight": np.tile(flank_weights(structure), 4),
        "flank_frame": flank_frames(structure),
        "display_node": display_nodes(structure, beam),
    }
    return mesh_dataset(made, structure.name, structure.description, with_pad)


def mesh_dataset(
    values: Mapping[str, ndarray], structure: str, description: str, with_pad: bool = False
) -> xr.Dataset:
    """`mesh.nc`, whoever made the mesh."""
    made = dataset("fem/mesh", values)
    made = made.assign_coords(axis=list("XYZ"), flank=list(FLANKS), pair_side=["beam", "slot"])
    about = {"structure": structure, "description": description, "with_pad": int(with_pad)}
    return made.assign_attrs(about)


def body_mesh(mesh: xr.Dataset, body: int) -> tuple[Mesh, int]:
    """One body of a mesh Dataset (0 beam, 1 slot Xn, 2 slot Xp) and its first node's number."""
    mine = np.flatnonzero(mesh.node_body.values == body)
    chosen = mesh.element_body.values == body
    elements = mesh.element_nodes.values[chosen] - mine[0]
    return Mesh(mesh.node_position.values[mine], elements, mesh.element_part.values[chosen]), int(
        mine[0]
    )
