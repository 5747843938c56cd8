"""Space frames of Timoshenko beams: mass, stiffness and the change of stiffness by tension.

A node has six dofs: displacements along X, Y, Z and rotations about them.
"""

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Section:
    """A rectangular section (m) of an isotropic material: modulus Pa, density kg/m^3."""

    width: float
    depth: float
    modulus: float
    density: float
    poisson: float = 0.3


@dataclass
class Frame:
    """Nodes (m), members between them, and which share of the axial force each member carries."""

    nodes: list = field(default_factory=list)
    members: list = field(default_factory=list)

    def node(self, x: float, y: float, z: float) -> int:
        """Add a node; its number."""
        self.nodes.append((x, y, z))
        return len(self.nodes) - 1

    def member(self, first: int, last: int, section: Section, tension: float = 0.0) -> None:
        """Add a member; `tension` is its force for 1 N of axial force on the whole."""
        self.members.append((first, last, section, tension))


def element(section: Section, length: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, mass and stiffness per newton of tension of a member along its local x.

    Dofs: u v w rx ry rz at either end. Cubic bending with shear (Przemieniecki's Phi), consistent
    translational mass with a rotary part, string stiffness with the rotations of the cubic.
    """
    b, h, e = section.width, section.depth, section.modulus
    area, shear = b * h, e / (2 * (1 + section.poisson))
    inertia_y, inertia_z = b * h**3 / 12, h * b**3 / 12
    polar = inertia_y + inertia_z
    torsion = min(b, h) ** 3 * max(b, h) * (1 / 3 - 0.21 * min(b, h) / max(b, h))
    k, m, g = np.zeros((12, 12)), np.zeros((12, 12)), np.zeros((12, 12))
    pull, shared = np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
    mass = section.density * area * length
    for dof, stiff, heavy in (
        (0, e * area / length, mass),
        (3, shear * torsion / length, section.density * polar * length),
    ):
        place = np.ix_([dof, dof + 6], [dof, dof + 6])
        k[place] += stiff * pull
        m[place] += heavy * shared
    for dofs, inertia, sign in (((1, 5, 7, 11), inertia_z, 1.0), ((2, 4, 8, 10), inertia_y, -1.0)):
        turn = np.array([1, sign, 1, sign])
        place, mirror = np.ix_(dofs, dofs), np.outer(turn, turn)
        phi = 12 * e * inertia / (shear * area * 5 / 6 * length**2)
        k[place] += mirror * _bending(e * inertia, length, phi)
        m[place] += mirror * (
            mass / 420 * _consistent(length)
            + section.density * inertia / (30 * length) * _string(length)
        )
        g[place] += mirror * _string(length) / (30 * length)
    return k, m, g


def _bending(stiffness: float, a: float, phi: float) -> np.ndarray:
    near, far = (4 + phi) * a**2, (2 - phi) * a**2
    return (
        stiffness
        / (a**3 * (1 + phi))
        * np.array(
            [
                [12, 6 * a, -12, 6 * a],
                [6 * a, near, -6 * a, far],
                [-12, -6 * a, 12, -6 * a],
                [6 * a, far, -6 * a, near],
            ]
        )
    )


def _consistent(a: float) -> np.ndarray:
    return np.array(
        [
            [156, 22 * a, 54, -13 * a],
            [22 * a, 4 * a**2, 13 * a, -3 * a**2],
            [54, 13 * a, 156, -22 * a],
            [-13 * a, -3 * a**2, -22 * a, 4 * a**2],
        ]
    )


def _string(a: float) -> np.ndarray:
    return np.array(
        [
            [36, 3 * a, -36, 3 * a],
            [3 * a, 4 * a**2, -3 * a, -(a**2)],
            [-36, -3 * a, 36, -3 * a],
            [3 * a, -(a**2), -3 * a, 4 * a**2],
        ]
    )


def matrices(frame: Frame) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, mass, stiffness per newton of axial force: (6 nodes, 6 nodes) each."""
    size = 6 * len(frame.nodes)
    total = np.zeros((3, size, size))
    place = np.array(frame.nodes)
    for first, last, section, tension in frame.members:
        along = place[last] - place[first]
        length = np.linalg.norm(along)
        turn = np.kron(np.eye(4), _axes(along / length))
        dofs = np.r_[6 * first : 6 * first + 6, 6 * last : 6 * last + 6]
        for whole, part, scale in zip(
            total, element(section, length), (1, 1, tension), strict=True
        ):
            whole[np.ix_(dofs, dofs)] += scale * turn.T @ part @ turn
    return total[0], total[1], total[2]


def _axes(x: np.ndarray) -> np.ndarray:
    """Rows: local x, the local y nearest to the global Y (X for a member along Y), and z."""
    guide = np.array([0.0, 1.0, 0.0]) if abs(x[1]) < 0.9 else np.array([-1.0, 0.0, 0.0])
    y = guide - (guide @ x) * x
    y /= np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)])
