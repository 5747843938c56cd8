"""Two half beams in a bolted lap joint, free: each is halved in height over the overlap.

Frame: X along the beam with the origin in the joint's middle, Y its width, Z its height. The first
half beam is the upper one in the overlap and lies at negative x; the second is the first, turned
half about Y. A bolt presses the surfaces together within the cone that spreads from its head (VDI
2230, Roetscher): there the surfaces touch, and the contact's stiffness follows the pressure.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem import elasticity
from bladeroot.fem.geometry import GPA, Material
from bladeroot.fem.mesh import Mesh, block, extrude, mirrored
from bladeroot.fem.outline import MM, Edge
from bladeroot.fem.prestress import solve_free

_SAME_PLACE = 1e-8  # m, within which coordinates are the same


@dataclass(frozen=True)
class LapJoint:
    """Half of the whole length, of the overlap and of the height; m, kg. bolts: x and interface."""

    name: str
    half: float
    overlap: float
    height: float
    width: float
    material: Material
    bolts: tuple[tuple[float, str], ...]
    head: float
    cone: float
    bolt_mass: float
    elements: tuple[int, int, int, int]


@dataclass(frozen=True)
class Half:
    """A meshed half beam: stiffness N/m, mass kg by dof, geometric 1/m per newton in each bolt."""

    mesh: Mesh
    stiffness: sp.csr_array
    mass: sp.csr_array
    geometric: sp.csr_array


def lap_joint_of(data: Mapping[str, Any], where: str) -> LapJoint:
    """A structure file's content in SI units. ValueError for a shape that cannot be."""
    beam, bolts, mesh, steel = data["beam"], data["bolts"], data["mesh"], data["material"]
    half, overlap = 0.5 * MM * beam["length_mm"], 0.5 * MM * beam["overlap_mm"]
    height = 0.5 * MM * beam["height_mm"]
    if not overlap < half:
        raise ValueError(f"beam.overlap_mm must be shorter than beam.length_mm ({where})")
    head = 0.5 * MM * bolts["head_diameter_mm"]
    cone = head + height * np.tan(np.radians(bolts["cone_degrees"]))
    places = tuple((MM * one["x_mm"], one["interface"]) for one in bolts["at"])
    for x, interface in places:
        if not abs(x) + head <= overlap:
            raise ValueError(f"a bolt's head at {x / MM:g} mm must lie on the overlap ({where})")
        if interface not in data["interfaces"]:
            raise ValueError(f"bolts.at: interface {interface} is not among interfaces ({where})")
    span = max(1, round((half - overlap) / (MM * mesh["span_element_mm"])))
    return LapJoint(
        data["name"], half, overlap, height, MM * beam["width_mm"],
        Material(GPA * steel["young_modulus_GPa"], steel["density_kg_m3"], steel["poisson_ratio"]),
        places, head, float(cone), bolts["mass_kg"],
        (span, mesh["overlap_elements"], mesh["width_elements"], mesh["thickness_elements"]),
    )  # fmt: skip


def half_beam(joint: LapJoint, which: int) -> Half:
    """The first (0) or second (1) half beam under one newton in each bolt.

    A bolt is a string in tension from its head to the joint's plane: it turns with the beam, so
    that no rigid motion stores energy.
    """
    mesh, side = _mesh(joint, which), (1.0, -1.0)[which]
    rule, materials = elasticity.quadrature(mesh), [joint.material]
    stiffness = elasticity.stiffness(mesh, rule, materials)
    mass = elasticity.mass(mesh, rule, materials)
    loads, heads = np.zeros_like(mesh.nodes), np.zeros(len(mesh.nodes))
    strings = sp.csr_array((len(mesh.nodes),) * 2)
    for x, _ in joint.bolts:
        string = np.zeros(len(mesh.nodes))
        nodes, share = patch(joint, mesh, 0.0, x, joint.cone)
        string[nodes] -= share
        nodes, share = patch(joint, mesh, side * joint.height, x, joint.head)
        string[nodes] += share
        heads[nodes] += 0.5 * joint.bolt_mass * share
        loads[:, 2] -= side * string
        row = sp.csr_array(string[None])
        strings = strings + row.T @ row / joint.height
    displacement, _ = solve_free(mesh, stiffness, loads)
    stresses = elasticity.stress(mesh, rule, materials, displacement)
    geometric = elasticity.geometric_stiffness(mesh, rule, stresses)
    mass = sp.csr_array(mass + sp.diags_array(heads))
    geometric = elasticity.per_axis(geometric) + sp.kron(strings, np.diag([1.0, 1.0, 0.0]))
    return Half(mesh, stiffness, elasticity.per_axis(mass), sp.csr_array(geometric))


def patch(
    joint: LapJoint, mesh: Mesh, z: float, x: float, radius: float
) -> tuple[Int[ndarray, " node"], Float[ndarray, " node"]]:
    """Nodes of a level surface that a bolt at x presses, and their shares of its force.

    The pressure falls from the axis to nothing at `radius`; shares are put right so that the force
    acts along the axis, whatever the mesh. ValueError if the patch has too few nodes.
    """
    nodes = mesh.nodes
    across = 2 * joint.elements[2]
    size = np.array([2.0 * joint.overlap / (2 * joint.elements[1]), joint.width / across])
    inside = (abs(nodes[:, 2] - z) < _SAME_PLACE) & (abs(nodes[:, 0]) < joint.overlap + _SAME_PLACE)
    off = nodes[:, :2] - [x, 0.0]
    # a head smaller than the mesh still presses the nodes around its axis
    reach = max(radius, 1.01 * float(np.linalg.norm(size)))
    found = np.flatnonzero(inside & (np.linalg.norm(off, axis=1) < reach))
    place = np.round((nodes[found, :2] + [joint.overlap, joint.width / 2.0]) / size).astype(int)
    ends = np.array([2 * joint.elements[1], across])
    simpson = np.where(place % 2 == 1, 4.0, np.where((place == 0) | (place == ends), 1.0, 2.0))
    share = simpson.prod(axis=1) * (1.0 - (np.linalg.norm(off[found], axis=1) / reach) ** 2)
    rows = np.column_stack([np.ones(len(found)), off[found]])
    if np.linalg.matrix_rank(rows) < 3:
        raise ValueError(f"structure {joint.name}: too coarse a mesh at the bolt at {1e3 * x:g} mm")
    weighted = rows * share[:, None]
    return found, weighted @ np.linalg.solve(rows.T @ weighted, [1.0, 0.0, 0.0])


def line_nodes(joint: LapJoint, mesh: Mesh, which: int) -> Int[ndarray, " node"]:
    """Nodes of the upper face's middle line in order of x, each point once over both half beams."""
    x, y, z = mesh.nodes.T
    mine = x > joint.overlap + _SAME_PLACE if which else x < joint.overlap + _SAME_PLACE
    found = np.flatnonzero(mine & (abs(y) < _SAME_PLACE) & (abs(z - joint.height) < _SAME_PLACE))
    return found[np.argsort(x[found])]


def _mesh(joint: LapJoint, which: int) -> Mesh:
    span, along, across, thick = joint.elements
    a, h = joint.overlap, joint.height
    shank = block(_level(-joint.half, -a, -h), _level(-joint.half, -a, h), (span, 2 * thick))
    lap = block(_level(-a, a, 0.0), _level(-a, a, h), (along, thick))
    blocks = [shank, lap]
    if which:
        blocks = [mirrored(one, -1, -1) for one in blocks]
    return extrude(blocks, joint.width, across)


def _level(start: float, end: float, z: float) -> Edge:
    return Edge((start, z), (end, z))
