"""Reflections that leave a body's matrices as they are, and the smaller problems that they leave.

A displacement is a sum of parts that are each even or odd under every reflection. The matrices do
not couple these sectors, so that each is solved by itself: with three reflections eight problems
of an eighth of the size, whose factors have far less fill.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.linear import factor, lowest_eigenpairs
from bladeroot.fem.modes import mirror_nodes

Matrix = sp.csr_array | Float[ndarray, "_ _"]  # sectors differ in size

_EXTRA_MODES = 2  # modes of a sector beyond its even share that are sought at first


@dataclass(frozen=True)
class Reflection:
    """Dof `image[d]` of the reflected displacement is `sign[d]` times dof d of the displacement."""

    image: Int[ndarray, " dof"]
    sign: Float[ndarray, " dof"]


def reflections(nodes: Float[ndarray, "node axis"], *matrices: sp.csr_array) -> list[Reflection]:
    """Reflections in planes normal to X, Y, Z that map the nodes on each other and keep matrices.

    Found by the nodes' positions, then tried on each matrix (dof, dof) with a random displacement.
    A fourth coordinate, which no reflection turns, tells nodes in one place apart.
    """
    found = []
    for axis in range(3):
        mirror = mirror_nodes(nodes, axis)
        if np.any(mirror < 0):
            continue
        sign = np.ones((len(nodes), 3))
        sign[:, axis] = -1.0
        one = Reflection((3 * mirror[:, None] + np.arange(3)).ravel(), sign.ravel())
        if all(keeps(one, matrix) for matrix in matrices):
            found.append(one)
    return found


def keeps(one: Reflection, matrix: Matrix) -> bool:
    """Whether a reflection leaves a matrix (dof, dof) as it is, but for rounding."""
    trial = np.random.default_rng(0).standard_normal(matrix.shape[0])
    force = matrix @ trial
    away = matrix @ _reflected(one, trial) - _reflected(one, force)
    return bool(np.abs(away).max() <= 1e-9 * np.abs(force).max())


def _reflected(one: Reflection, column: Float[ndarray, " dof"]) -> Float[ndarray, " dof"]:
    result = np.empty_like(column)
    result[one.image] = one.sign * column
    return result


def that_keep(mirrors: Sequence[Reflection], dofs: Int[ndarray, " own"]) -> list[Reflection]:
    """The reflections that map some of the dofs on each other."""
    return [one for one in mirrors if np.isin(one.image[dofs], dofs).all()]


def among(mirrors: Sequence[Reflection], dofs: Int[ndarray, " own"]) -> list[Reflection]:
    """Reflections of a body that keep some of its dofs, as reflections of these alone."""
    if not mirrors:
        return []
    place = np.full(len(mirrors[0].image), -1)
    place[dofs] = np.arange(len(dofs))
    return [Reflection(place[one.image[dofs]], one.sign[dofs]) for one in mirrors]


@dataclass(frozen=True)
class Sector:
    """Displacements of one parity under each reflection.

    columns: orthonormal. first: a dof of each set of images, one a column; root: of the sets' size.
    """

    columns: sp.csr_array
    first: Int[ndarray, " own"]
    root: Float[ndarray, " own"]

    def within(self, matrix: sp.csr_array) -> sp.csr_array:
        """columns^T A columns of a matrix A that the reflections keep."""
        return self.between(matrix, self)

    def between(self, matrix: sp.csr_array, other: "Sector") -> sp.csr_array:
        """The same of a block that couples these dofs with others, of a sector of equal parity."""
        rows = sp.csr_array(matrix[self.first] @ other.columns)
        return sp.csr_array(sp.diags_array(self.root) @ rows)


def sectors(mirrors: Sequence[Reflection], size: int) -> list[Sector]:
    """The sectors of so many dofs, ordered by parity; one may be empty. Without reflections all."""
    least = np.arange(size)
    for one in mirrors:
        least = np.minimum(least, least[one.image])
    turns = [sp.csr_array((m.sign, (m.image, np.arange(size))), (size, size)) for m in mirrors]
    made = []
    for parity in product((1.0, -1.0), repeat=len(mirrors)):
        project = sp.eye_array(size, format="csr")
        for sign, turn in zip(parity, turns, strict=True):
            project = 0.5 * (project + sign * (turn @ project))
        share = project.diagonal()
        first = np.flatnonzero((least == np.arange(size)) & (share > 0.0))
        root = 1.0 / np.sqrt(share[first])
        columns = sp.csr_array(sp.csc_array(project)[:, first] @ sp.diags_array(root))
        columns.eliminate_zeros()
        made.append(Sector(columns, first, root))
    return made


def symmetric_eigenpairs(
    stiffness: sp.csr_array,
    mass: sp.csr_array,
    count: int,
    shift: float = 0.0,
    mirrors: Sequence[Reflection] = (),
) -> tuple[Float[ndarray, " mode"], Float[ndarray, "dof mode"]]:
    """`lowest_eigenpairs` of matrices that reflections keep; each shape is of one parity."""
    parts = sectors(mirrors, stiffness.shape[0])
    within = [(one.within(stiffness), one.within(mass)) for one in parts]
    solves = [factor(sp.csr_array(k - shift * m)) if k.shape[0] else None for k, m in within]
    values, found = sector_eigenpairs(within, solves, count, shift)
    return values, whole_shapes(parts, found)


def sector_eigenpairs(
    within: Sequence[tuple[Matrix, Matrix]],
    solves: Sequence,
    count: int,
    shift: float = 0.0,
) -> tuple[Float[ndarray, " mode"], list[tuple[int, Float[ndarray, " _"]]]]:
    """The lowest of all sectors' eigenpairs, ascending, each with its sector and its shape there.

    within: stiffness and mass of each sector; solves: by its factor of stiffness - shift * mass.
    """
    asked = [min(count // len(within) + _EXTRA_MODES, count, k.shape[0]) for k, _ in within]
    done: list[tuple[ndarray, ndarray]] = [(np.empty(0), np.empty((0, 0)))] * len(within)
    waiting = [place for place, most in enumerate(asked) if most]
    while waiting:
        for place in waiting:
            done[place] = lowest_eigenpairs(*within[place], asked[place], shift, solves[place])
        values = np.concatenate([pairs[0] for pairs in done])
        last = np.sort(values)[:count][-1]
        # a sector all of whose modes are among the lowest may have more of them
        waiting = [
            place
            for place, (own, _) in enumerate(done)
            if len(own) < count
            and len(own) < within[place][0].shape[0]
            and (len(values) < count or own[-1] <= last)
        ]
        for place in waiting:
            asked[place] = min(2 * asked[place], count, within[place][0].shape[0])
    pairs = [
        (value, place, shape)
        for place, (own, shapes) in enumerate(done)
        for value, shape in zip(own, shapes.T, strict=True)
    ]
    pairs.sort(key=lambda pair: pair[:2])
    return np.array([pair[0] for pair in pairs[:count]]), [pair[1:] for pair in pairs[:count]]


def whole_shapes(
    parts: Sequence[Sector], found: Sequence[tuple[int, Float[ndarray, " _"]]]
) -> Float[ndarray, "dof mode"]:
    """Shapes of sectors as displacements of all dofs."""
    return np.column_stack([parts[place].columns @ shape for place, shape in found])
