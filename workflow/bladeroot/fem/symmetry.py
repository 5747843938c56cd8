"""Reflections that leave a body's stiffness as it is, so that one solution serves several loads."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.fem.modes import mirror_nodes


@dataclass(frozen=True)
class Reflection:
    """Dof `image[d]` of the reflected displacement is `sign[d]` times dof d of the displacement."""

    image: Int[ndarray, " dof"]
    sign: Float[ndarray, " dof"]


def reflections(nodes: Float[ndarray, "node 3"], stiffness: sp.csr_array) -> list[Reflection]:
    """Reflections in planes normal to X, Y, Z that map the nodes on each other and keep K.

    Found by the nodes' positions, then tried on the matrix with a random displacement.
    """
    trial = np.random.default_rng(0).standard_normal(3 * len(nodes))
    force = stiffness @ trial
    found = []
    for axis in range(3):
        mirror = mirror_nodes(nodes, axis)
        if np.any(mirror < 0):
            continue
        sign = np.ones((len(nodes), 3))
        sign[:, axis] = -1.0
        one = Reflection((3 * mirror[:, None] + np.arange(3)).ravel(), sign.ravel())
        moved = stiffness @ _reflected(one, trial)
        if np.abs(moved - _reflected(one, force)).max() < 1e-9 * np.abs(force).max():
            found.append(one)
    return found


def _reflected(one: Reflection, columns: Float[ndarray, "dof ..."]) -> Float[ndarray, "dof ..."]:
    result = np.empty_like(columns)
    result[one.image] = (one.sign * columns.T).T
    return result


def solve_columns(
    solve: Callable[[Int[ndarray, " load"]], Float[ndarray, "dof load"]],
    dofs: Int[ndarray, " load"],
    mirrors: Sequence[Reflection],
) -> Float[ndarray, "dof load"]:
    """One displacement for each dof of `dofs`, by solving for one dof of each set of images.

    `solve` gives the displacements of some of the dofs, each belonging to its dof's unit motion.
    """
    size = len(mirrors[0].image) if mirrors else 0
    place = np.full(max(size, dofs.max() + 1), -1)
    place[dofs] = np.arange(len(dofs))
    mirrors = [one for one in mirrors if np.all(place[one.image[dofs]] >= 0)]
    least = np.arange(len(dofs))
    for one in mirrors:  # after each reflection the least of the images under all so far
        least = np.minimum(least, least[place[one.image[dofs]]])
    first = np.flatnonzero(least == np.arange(len(dofs)))
    solved = solve(dofs[first])
    result = np.empty((len(solved), len(dofs)))
    result[:, first] = solved
    known = first
    for one in mirrors:
        image = place[one.image[dofs[known]]]
        new = ~np.isin(image, known)
        result[:, image[new]] = one.sign[dofs[known[new]]] * _reflected(one, result[:, known[new]])
        known = np.concatenate([known, image[new]])
    return result
