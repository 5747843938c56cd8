"""Sparse symmetric solves: one factor, any number of right-hand sides."""

from collections.abc import Callable

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from jaxtyping import Float
from numpy import ndarray

# SuperLU solves a block of columns faster than one by one, but its work space grows with them.
_SOLVED_COLUMNS = 128
_SINGULAR_GROWTH = 1e12  # of a random vector by a singular inverse, the diagonal scaled to 1
# Block Lanczos for the lowest modes.
_DENSE_DOFS = 8  # for each mode, up to which a dense solution is faster
_BLOCK_COLUMNS = 10
_MOST_VECTORS = 12  # for each mode, before giving up
_CONVERGED = 1e-9  # relative residual of a shape; its eigenvalue errs by the square
_PASSES = 3  # of orthogonalisation, which serve columns of any condition
_PRODUCT_ROUNDING = 1e-13  # of the largest inner product
_INDEFINITE = (
    "expected a positive definite stiffness of {} dofs, got one that moves against a load: a sign, "
    "or mass and stiffness exchanged"
)


def factor(matrix: sp.csr_array) -> Callable[[ndarray], ndarray]:
    """Factor a symmetric, well-conditioned matrix; the result solves for one or many columns.

    Symmetric mode keeps pivots on the diagonal: half the fill of the general ordering. ValueError
    if the matrix is singular, or is but for rounding, and if a random load finds it not positive.
    """
    try:
        lu = spla.splu(
            matrix.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        raise ValueError(_singular(matrix)) from None
    scale = np.sqrt(np.abs(matrix.diagonal()))  # so that units and stiff springs do not count
    probe = np.random.default_rng(0).standard_normal(matrix.shape[0])
    answer = scale * lu.solve(scale * probe)
    if not np.linalg.norm(answer) < _SINGULAR_GROWTH * np.linalg.norm(probe):
        raise ValueError(_singular(matrix))
    if not probe @ answer > 0.0:
        raise ValueError(_INDEFINITE.format(matrix.shape[0]))

    def solve(right: ndarray) -> ndarray:
        if right.ndim == 1:
            return lu.solve(right)
        blocks = range(0, right.shape[1], _SOLVED_COLUMNS)
        return np.hstack(
            [lu.solve(np.ascontiguousarray(right[:, k : k + _SOLVED_COLUMNS])) for k in blocks]
        )

    return solve


def _singular(matrix: sp.csr_array) -> str:
    empty = np.flatnonzero(matrix.diagonal() == 0)
    where = f"; dof {empty[0]} has none on the diagonal" if len(empty) else ""
    return (
        f"expected a stiffness that holds all {matrix.shape[0]} dofs, got a singular one: "
        f"a part moves freely or has no stiffness{where}"
    )


def lowest_eigenpairs(
    stiffness: sp.csr_array | Float[ndarray, "dof dof"],
    mass: sp.csr_array | Float[ndarray, "dof dof"],
    count: int,
    shift: float = 0.0,
    solve: Callable[[ndarray], ndarray] | None = None,
) -> tuple[Float[ndarray, " mode"], Float[ndarray, "dof mode"]]:
    """The lowest `count` eigenvalues (rad^2/s^2) and mass-normalised shapes, ascending.

    `shift` must lie below the spectrum, and off it when the structure is free; `solve` may give a
    factor of stiffness - shift * mass that already exists. Block Lanczos on the inverse, with full
    orthogonalisation: a block of columns costs a factor little more than one. Starts from fixed
    vectors, so that the same input gives the same shapes. ValueError if it does not converge.
    """
    size = stiffness.shape[0]
    if size <= _DENSE_DOFS * count:
        weight, dense = (p.toarray() if sp.issparse(p) else p for p in (mass, stiffness))
        # of the inverse, too: the largest stiffness would set the rounding of the lowest modes
        try:
            inverse, shapes = scipy.linalg.eigh(weight, dense - shift * weight)
        except np.linalg.LinAlgError:
            raise ValueError(_INDEFINITE.format(size)) from None
        inverse, shapes = inverse[::-1][:count], shapes[:, ::-1][:, :count]
        return shift + 1.0 / inverse, _signed(shapes / np.sqrt(inverse))
    solve = factor(sp.csr_array(stiffness - shift * mass)) if solve is None else solve
    block = np.random.default_rng(0).standard_normal((size, min(count, _BLOCK_COLUMNS)))
    block = solve(mass @ block)  # dofs without mass follow the others
    basis, weighted = np.empty((size, 0)), np.empty((size, 0))
    projected = np.empty((0, 0))
    while basis.shape[1] <= min(_MOST_VECTORS * count + 4 * _BLOCK_COLUMNS, size) - block.shape[1]:
        for _ in range(_PASSES):
            block -= basis @ (weighted.T @ block)  # rounding lets known directions in again
            weight = mass @ block
            root = _inverse_root(block.T @ weight)
            block, weight = block @ root, weight @ root
        basis, weighted = np.hstack([basis, block]), np.hstack([weighted, weight])
        known = len(projected)
        block = solve(weighted[:, known:])
        column = weighted.T @ block
        projected = np.block([[projected, column[:known]], [column[:known].T, column[known:]]])
        projected = 0.5 * (projected + projected.T)
        block -= basis @ column
        product = block.T @ (mass @ block)
        if len(projected) < 2 * count:
            continue
        inverse, combination = np.linalg.eigh(projected)
        inverse, combination = inverse[::-1][:count], combination[:, ::-1][:, :count]
        last = combination[known:]
        residual = np.sqrt(np.abs(np.einsum("im,ij,jm->m", last, product, last)))
        if np.all(residual < _CONVERGED * np.abs(inverse)):
            return shift + 1.0 / inverse, _signed(basis @ combination)
    raise ValueError(
        f"the lowest {count} modes of {size} dofs did not converge with {basis.shape[1]} vectors"
    )


def _inverse_root(product: Float[ndarray, "k k"]) -> Float[ndarray, "k k"]:
    """What makes columns with these inner products orthonormal, but for directions of rounding.

    Inner products square the columns' condition: a direction that is lost in their rounding grows
    by a bounded factor, and the next pass sees it (shifted Cholesky QR, Fukaya et al. 2020).
    """
    values, vectors = np.linalg.eigh(product)
    return vectors / np.sqrt(np.maximum(values, _PRODUCT_ROUNDING * values[-1]))


def _signed(shapes: Float[ndarray, "dof mode"]) -> Float[ndarray, "dof mode"]:
    """Shapes whose largest component is positive."""
    largest = shapes[np.argmax(abs(shapes), axis=0), np.arange(shapes.shape[1])]
    return shapes * np.sign(largest)
