"""Sparse symmetric solves: one factor, any number of right-hand sides."""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from jaxtyping import Float
from numpy import ndarray

# SuperLU solves a block of columns faster than one by one, but its work space grows with them.
_COLUMNS = 128


def factor(matrix: sp.csr_array) -> Callable[[ndarray], ndarray]:
    """Factor a symmetric, well-conditioned matrix; the result solves for one or many columns.

    Symmetric mode keeps pivots on the diagonal: half the fill of the general ordering.
    """
    lu = spla.splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )

    def solve(right: ndarray) -> ndarray:
        if right.ndim == 1:
            return lu.solve(right)
        blocks = range(0, right.shape[1], _COLUMNS)
        return np.hstack(
            [lu.solve(np.ascontiguousarray(right[:, k : k + _COLUMNS])) for k in blocks]
        )

    return solve


def lowest_eigenpairs(
    stiffness: sp.csr_array,
    mass: sp.csr_array,
    count: int,
    shift: float = 0.0,
    solve: Callable[[ndarray], ndarray] | None = None,
) -> tuple[Float[ndarray, " mode"], Float[ndarray, "dof mode"]]:
    """The `count` eigenvalues (rad^2/s^2) nearest `shift` and mass-normalised shapes, ascending.

    `shift` should lie below the spectrum wanted, and off it when the structure is free; `solve` may
    give a factor of stiffness - shift * mass that already exists. Starts from a fixed vector, so
    that the same input gives the same shapes.
    """
    solve = factor(sp.csr_array(stiffness - shift * mass)) if solve is None else solve
    size = stiffness.shape[0]
    start = np.random.default_rng(0).standard_normal(size)
    inverse = spla.LinearOperator((size, size), matvec=solve, dtype=float)
    values, shapes = spla.eigsh(stiffness, count, mass, sigma=shift, OPinv=inverse, v0=start)
    order = np.argsort(values)
    values, shapes = values[order], shapes[:, order]
    largest = shapes[np.argmax(abs(shapes), axis=0), np.arange(count)]
    return values, shapes * np.sign(largest)
