"""Roots of the frequency map: the stiffness that gives two measured frequencies (eq. 5.8)."""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.surface import all_frequencies

_ROOT_TOLERANCE = 1e-9  # relative, of each frequency; ten times finer than the map itself
_SAME_ROOT = 1e-4  # of ln k: two roots nearer than this are one


def newton(
    surface: Surface,
    target: Float[ndarray, "point mode"],
    start: Float[ndarray, "point 2"],
    log_box: tuple[float, float],
) -> tuple[Float[ndarray, "point 2"], Bool[ndarray, " point"]]:
    """Newton's method in (ln kn, ln kt) for many targets at once, kept inside the box.

    Returns the last points and which of them are roots. A step is at most a factor e; a
    point that the box holds back is no root.
    """
    x = np.clip(start, *log_box)
    for _ in range(40):
        f, jacobian = all_frequencies(surface, x)
        relative = (target - f) / target
        if np.all(np.abs(relative) < _ROOT_TOLERANCE):
            break
        step = _solve_pairs(jacobian / target[:, :, None], relative)
        step *= np.minimum(1.0, 1.0 / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, None]
        x = np.clip(x + step, *log_box)
    f, _ = all_frequencies(surface, x)
    return x, np.all(np.abs(f / target - 1.0) < _ROOT_TOLERANCE, axis=1)


def _solve_pairs(matrix: Float[ndarray, "point 2 2"], right: Float[ndarray, "point 2"]) -> ndarray:
    """Cramer's rule; a vanishing determinant gives a long step, which the caller shortens."""
    (a, b), (c, d) = matrix.transpose(1, 2, 0)
    determinant = a * d - b * c
    size = 1e-14 * (np.abs(a * d) + np.abs(b * c)) + 1e-300
    determinant = np.where(np.abs(determinant) < size, size, determinant)
    u = (d * right[:, 0] - b * right[:, 1]) / determinant
    v = (a * right[:, 1] - c * right[:, 0]) / determinant
    return np.stack([u, v], axis=1)


def all_roots(
    surface: Surface,
    target: Float[ndarray, " mode"],
    drawn: Float[ndarray, "mode kn kt"],
    log_axis: Float[ndarray, " k"],
) -> Float[ndarray, "root 2"]:
    """All (ln kn, ln kt) in the box that give the target, by rising kn.

    Newton starts in every cell of the drawn map in which both frequencies pass their targets,
    and on a coarse net over the box for cells that hold two roots.
    """
    above = drawn > target[:, None, None]
    corners = np.stack(
        [
            above[:, i : i + above.shape[1] - 1, j : j + above.shape[2] - 1]
            for i in (0, 1)
            for j in (0, 1)
        ]
    )
    crossed = np.all(corners.any(axis=0) & ~corners.all(axis=0), axis=0)
    middle = 0.5 * (log_axis[1:] + log_axis[:-1])
    cells = middle[np.argwhere(crossed)]
    coarse = np.linspace(log_axis[0], log_axis[-1], 7)[1:-1]
    net = np.stack(np.meshgrid(coarse, coarse), axis=-1).reshape(-1, 2)
    starts = np.vstack([cells, net])
    targets = np.broadcast_to(target, (len(starts), len(target)))
    ends, good = newton(surface, targets, starts, (log_axis[0], log_axis[-1]))
    roots: list[ndarray] = []
    for end in ends[good]:
        if all(np.abs(end - root).max() > _SAME_ROOT for root in roots):
            roots.append(end)
    return np.array(sorted(roots, key=tuple)).reshape(-1, 2)


def nearest_point(
    surface: Surface,
    target: Float[ndarray, " mode"],
    std: Float[ndarray, " mode"],
    drawn: Float[ndarray, "mode kn kt"],
    log_axis: Float[ndarray, " k"],
) -> Float[ndarray, " 2"]:
    """Point of the box whose frequencies miss the target least, in units of `std` (Hz)."""
    from scipy.optimize import least_squares  # late: most maps have roots

    miss = np.sum(((drawn - target[:, None, None]) / std[:, None, None]) ** 2, axis=0)
    start = log_axis[list(np.unravel_index(np.argmin(miss), miss.shape))]
    inside = np.clip(start, log_axis[0] + 1e-9, log_axis[-1] - 1e-9)

    def residual(x: ndarray) -> ndarray:
        return (all_frequencies(surface, x[None])[0][0] - target) / std

    def slope(x: ndarray) -> ndarray:
        return all_frequencies(surface, x[None])[1][0] / std[:, None]

    bounds = (np.full(2, log_axis[0]), np.full(2, log_axis[-1]))
    found = least_squares(residual, inside, slope, bounds, xtol=1e-12, ftol=1e-14, gtol=1e-12)
    return found.x
