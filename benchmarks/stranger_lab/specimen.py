"""Brick finite elements of a beam that two jaws hold, reduced to a basis of its modes.

Lengths in m, stiffness in N/m, mass in kg, frequencies in Hz; x runs along the beam, z across the
contact.
"""

from functools import cached_property

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as sla

MODULUS, POISSON, DENSITY = 2.05e11, 0.3, 7850.0  # Pa, 1, kg/m^3
JAW_DEPTH = 0.02  # m
ALONG, ROOT_ALONG = 14, 4  # elements of the free length and between the jaws
CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
     [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float
)  # fmt: skip
# kn, kt (N/m) and tension (N) at which modes are taken into the basis
SPREAD = (
    (2e8, 2e8, 0), (1e9, 1e9, 0), (1e9, 1e9, 2e4), (5e9, 1e9, 0),
    (1e9, 5e9, 0), (3e10, 3e10, 2e4), (1e8, 1e9, 0), (1e9, 1e8, 0),
)  # fmt: skip
BASIS = 56


def elasticity() -> np.ndarray:
    """Stresses (Pa) over strains xx, yy, zz, xy, yz, xz."""
    lame = MODULUS * POISSON / (1 + POISSON) / (1 - 2 * POISSON)
    shear = MODULUS / 2 / (1 + POISSON)
    law = np.zeros((6, 6))
    law[:3, :3] = lame
    law[range(6), range(6)] += [2 * shear] * 3 + [shear] * 3
    return law


def strains(slopes: np.ndarray) -> np.ndarray:
    """Strains over displacements, from the shape functions' slopes (1/m)."""
    matrix = np.zeros((6, 3 * len(slopes)))
    for i, (x, y, z) in enumerate(slopes):
        matrix[[0, 3, 5], 3 * i] = x, y, z
        matrix[[1, 3, 4], 3 * i + 1] = y, x, z
        matrix[[2, 4, 5], 3 * i + 2] = z, y, x
    return matrix


def brick(size: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness and mass of a brick of edges `size`, and its geometric stiffness at 1 Pa along x.

    Wilson and Taylor's incompatible modes, condensed.
    """
    half, law = np.array(size) / 2, elasticity()
    k, k_inner, k_both = np.zeros((24, 24)), np.zeros((9, 9)), np.zeros((24, 9))
    mass, geometric = np.zeros((24, 24)), np.zeros((24, 24))
    for point in CORNERS / np.sqrt(3):
        factors = 1 + CORNERS * point
        shape = factors.prod(1) / 8
        others = [factors[:, [j for j in range(3) if j != axis]].prod(1) for axis in range(3)]
        slopes = CORNERS / 8 * np.transpose(others) / half
        b, inner = strains(slopes), strains(np.diag(-2 * point) / half)
        volume = half.prod()
        k += b.T @ law @ b * volume
        k_both += b.T @ law @ inner * volume
        k_inner += inner.T @ law @ inner * volume
        mass += DENSITY * np.kron(np.outer(shape, shape), np.eye(3)) * volume
        geometric += np.kron(np.outer(slopes[:, 0], slopes[:, 0]), np.eye(3)) * volume
    return k - k_both @ la.solve(k_inner, k_both.T), mass, geometric


def grid(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of a box (m) and the eight nodes of each brick."""
    places = np.meshgrid(x, y, z, indexing="ij")
    number = np.arange(places[0].size).reshape(places[0].shape)
    low, high = slice(None, -1), slice(1, None)
    turn = [(low, low), (high, low), (high, high), (low, high)]
    bricks = [number[i, j, k].ravel() for k in (low, high) for i, j in turn]
    return np.stack([one.ravel() for one in places], axis=1), np.stack(bricks, axis=1)


def assemble(nodes: np.ndarray, bricks: np.ndarray, stress=None) -> list[sp.csr_matrix]:
    """Stiffness, mass, and geometric stiffness under `stress` (Pa, of a brick's centre)."""
    parts: list[list[np.ndarray]] = [[], [], []]
    known: dict[tuple, tuple] = {}
    for one in bricks:
        size = tuple(np.round(nodes[one[6]] - nodes[one[0]], 9))
        if size not in known:
            known[size] = brick(size)
        scale = stress(nodes[one].mean(0)) if stress else 0.0
        for part, matrix, factor in zip(parts, known[size], (1, 1, scale), strict=True):
            part.append(factor * matrix)
    dofs = (3 * bricks[:, :, None] + np.arange(3)).reshape(len(bricks), 24)
    rows, columns = np.repeat(dofs, 24, axis=1).ravel(), np.tile(dofs, 24).ravel()
    shape = (3 * len(nodes),) * 2
    return [sp.csr_matrix((np.ravel(part), (rows, columns)), shape) for part in parts]


class Beam:
    """The specimen: matrices of beam and jaws, contact pairs, and modes by name."""

    def __init__(self, length: float, thickness: float, width: float, root: float):
        """Free length, thickness, width and clamped length (m)."""
        x = np.r_[np.linspace(-root, 0, ROOT_ALONG + 1), np.linspace(0, length, ALONG + 1)[1:]]
        y, face = np.linspace(-width / 2, width / 2, 3), thickness / 2
        self.nodes, bricks = grid(x, y, np.array([-face, face]))
        self.stiffness, self.mass, self.geometric = assemble(
            self.nodes, bricks, lambda at: float(at[0] > 0) / (width * thickness)
        )
        root_x = x[: ROOT_ALONG + 1]
        below, bricks = grid(root_x, y, np.linspace(-face - JAW_DEPTH, -face, 3))
        above, _ = grid(root_x, y, np.linspace(face, face + JAW_DEPTH, 3))
        self.jaw_nodes = np.r_[below, above]
        self.jaw_stiffness, self.jaw_mass, _ = assemble(
            self.jaw_nodes, np.r_[bricks, bricks + len(below)]
        )
        outer = np.abs(np.abs(self.jaw_nodes[:, 2]) - face - JAW_DEPTH) < 1e-9
        self.held = np.flatnonzero(outer)
        self.pairs = self._pairs(root_x, y, face)
        self._reduce()
        self._name()

    def _pairs(self, x, y, face) -> list[tuple[int, int, float, int]]:
        """Node of the beam, node of a jaw, area (m^2) and side of each contact pair."""
        along, across = np.gradient(x), np.gradient(y)
        along[[0, -1]] /= 2
        across[[0, -1]] /= 2
        pairs = []
        for side in (-1, 1):
            for i, j in np.ndindex(len(x), len(y)):
                place = np.array([x[i], y[j], side * face])
                first, second = (
                    int(np.argmin(np.abs(nodes - place).sum(1)))
                    for nodes in (self.nodes, self.jaw_nodes)
                )
                pairs.append((first, second, along[i] * across[j], side))
        return pairs

    @property
    def dofs(self) -> int:
        """Degrees of freedom of beam and jaws, held ones included."""
        return 3 * (len(self.nodes) + len(self.jaw_nodes))

    def _contact(self) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Stiffness of the contact for kn = 1 N/m and for kt = 1 N/m, shared by area."""
        first, second, area, _ = (np.array(one) for one in zip(*self.pairs, strict=True))
        area, rows = area / area.sum(), np.arange(3 * len(area))
        left = (3 * first[:, None] + np.arange(3)).ravel()
        right = 3 * len(self.nodes) + (3 * second[:, None] + np.arange(3)).ravel()
        shape = (len(rows), self.dofs)
        apart = sp.csr_matrix((np.ones(len(rows)), (rows, left)), shape) - sp.csr_matrix(
            (np.ones(len(rows)), (rows, right)), shape
        )
        normal, tangential = np.outer(area, [0, 0, 1]).ravel(), np.outer(area, [1, 1, 0]).ravel()
        return tuple(apart.T @ sp.diags(one) @ apart for one in (normal, tangential))

    def whole(self, of_beam, of_jaws=None) -> sp.csc_matrix:
        """A matrix of the free dofs of beam and jaws."""
        if of_jaws is None:
            of_jaws = sp.csr_matrix((3 * len(self.jaw_nodes),) * 2)
        return sp.block_diag([of_beam, of_jaws]).tocsr()[self.keep][:, self.keep].tocsc()

    def _reduce(self) -> None:
        """A basis of modes, taken over a spread of contact stiffness and tension."""
        held = 3 * len(self.nodes) + (3 * self.held[:, None] + np.arange(3)).ravel()
        self.keep = np.setdiff1d(np.arange(self.dofs), held)
        k = self.whole(self.stiffness, self.jaw_stiffness)
        m = self.whole(self.mass, self.jaw_mass)
        g = self.whole(self.geometric)
        kn, kt = (one[self.keep][:, self.keep].tocsc() for one in self._contact())
        start = np.random.default_rng(0).normal(size=len(self.keep))
        modes = [
            sla.eigsh(k + n * kn + t * kt + load * g, 8, m, sigma=0, v0=start)[1]
            for n, t, load in SPREAD
        ]
        self.basis = la.svd(np.hstack(modes), full_matrices=False)[0][:, :BASIS]
        self.reduced = [self.basis.T @ (one @ self.basis) for one in (k, m, g, kn, kt)]

    def displacements(self, reduced: np.ndarray) -> np.ndarray:
        """Displacements of the beam's nodes (rows) of a vector in the basis."""
        full = np.zeros(self.dofs)
        full[self.keep] = self.basis @ reduced
        return full[: 3 * len(self.nodes)].reshape(-1, 3)

    def modes(self, kn, kt, tension, modulus=1.0, count=10, more_k=0.0, more_m=0.0):
        """Frequencies (Hz) and reduced shapes; `modulus` over the nominal one."""
        k, m, g, normal, tangential = self.reduced
        k = modulus * k + kn * normal + kt * tangential + tension * g + more_k
        squares, shapes = la.eigh(k, m + more_m, subset_by_index=[0, count - 1])
        return np.sqrt(squares) / (2 * np.pi), shapes

    def _name(self) -> None:
        """Modes at 1 GN/m by their motion: flap (z), edge (y), torsion, axial."""
        _, shapes = self.modes(1e9, 1e9, 0.0, count=8)
        self.shapes: dict[str, np.ndarray] = {}
        counts: dict[str, int] = {}
        left, right = self.nodes[:, 1] < -1e-6, self.nodes[:, 1] > 1e-6
        for shape in shapes.T:
            u = self.displacements(shape)
            along, edge, flap = (u**2).sum(0)
            apart = np.sum((u[left, 2] - u[right, 2]) ** 2)
            together = np.sum((u[left, 2] + u[right, 2]) ** 2) + 1e-30
            kind = "edge" if edge > along else "axial"
            if flap > max(edge, along):
                kind = "flap"
            if apart > together and flap > edge:
                kind = "tors"
            counts[kind] = counts.get(kind, 0) + 1
            self.shapes[f"{kind}{counts[kind]}"] = shape

    def frequencies(self, names, kn, kt, tension, modulus=1.0, more_k=0.0, more_m=0.0):
        """Frequencies (Hz) of named modes, followed by their shapes."""
        found, shapes = self.modes(kn, kt, tension, modulus, 10, more_k, more_m)
        named = np.array([self.shapes[name] for name in names])
        return found[np.abs(named @ self.reduced[1] @ shapes).argmax(1)]

    def slopes(self, names, kn, kt, tension, modulus=1.0, step=0.02):
        """d ln f / d ln kn and d ln f / d ln kt of named modes, by differences."""
        plain = self.frequencies(names, kn, kt, tension, modulus)
        normal = self.frequencies(names, kn * (1 + step), kt, tension, modulus)
        tangential = self.frequencies(names, kn, kt * (1 + step), tension, modulus)
        return tuple(np.log(one / plain) / np.log1p(step) for one in (normal, tangential))

    @cached_property
    def tip_mass(self) -> np.ndarray:
        """Reduced mass matrix of 1 kg at the tip, which follows the mean of the tip's nodes."""
        tip = np.flatnonzero(self.nodes[:, 0] > 0.99 * self.nodes[:, 0].max())
        total = np.zeros((BASIS, BASIS))
        for axis in range(3):
            mean = np.zeros(self.dofs)
            mean[3 * tip + axis] = 1 / len(tip)
            reduced = self.basis.T @ mean[self.keep]
            total += np.outer(reduced, reduced)
        return total

    def slice_stiffness(self, at: float) -> np.ndarray:
        """Reduced stiffness of the slice of bricks at `at` of the free length."""
        x = np.unique(np.round(self.nodes[:, 0], 9))
        first = int(np.argmin(np.abs(x - at * x.max())))
        chosen = np.flatnonzero(np.isin(np.round(self.nodes[:, 0], 9), x[first : first + 2]))
        _, local = grid(np.arange(2.0), np.arange(3.0), np.arange(2.0))
        stiffness, *_ = assemble(self.nodes, chosen[local])
        return self.basis.T @ (self.whole(stiffness) @ self.basis)
