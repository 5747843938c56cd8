"""Smooth functions of (ln kn, ln kt, F) as sums of Chebyshev polynomials, with derivatives.

A function that is smooth over the box is represented to rounding by a few dozen coefficients a
coordinate, and is then evaluated, with its gradient, in about a microsecond a point.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray
from numpy.polynomial import chebyshev

_CHUNK_POINTS = 8192  # that are evaluated at a time: bounds the memory


@dataclass(frozen=True)
class Surface:
    """Coefficients of several functions over one box; `low` and `high` are its corners."""

    coefficients: Float[ndarray, "function i j l"]
    low: Float[ndarray, " coordinate"]
    high: Float[ndarray, " coordinate"]


def at_force(surface: Surface, force: float) -> Surface:
    """The surface at one axial force (N); its force axis is one node wide."""
    x = _inside(surface, np.array([[*surface.low[:2], force]]))[0, 2:]
    c = surface.coefficients @ chebyshev.chebvander(x, surface.coefficients.shape[3] - 1)[0]
    ends = (np.append(end[:2], force) for end in (surface.low, surface.high))
    return Surface(c[..., None], *ends)


def trimmed(surface: Surface, tolerance: float = 1e-5) -> Surface:
    """The surface without trailing coefficients that change no function by more than this.

    An inference asks for ten thousand points and does not see a hundred-thousandth.
    """
    c = surface.coefficients
    for axis in (1, 2, 3):
        size = np.abs(c).sum(axis=tuple(k for k in range(1, 4) if k != axis)).max(axis=0)
        tail = size[::-1].cumsum()[::-1]
        c = np.take(c, np.arange(max(2, int((tail > tolerance / 3.0).sum()))), axis=axis)
    return Surface(c, surface.low, surface.high)


def evaluate(
    surface: Surface,
    points: Float[ndarray, "point 3"],
    order: int = 0,
    function: Int[ndarray, " point"] | None = None,
) -> list[Float[ndarray, "point ..."]]:
    """Values, with order 1 gradients by the coordinates, with order 2 second derivatives too, at
    many points, of all functions, or of the one that is asked for at each.

    Raises ValueError for a point outside the box.
    """
    x = _inside(surface, points)
    chunks = [slice(k, k + _CHUNK_POINTS) for k in range(0, max(len(x), 1), _CHUNK_POINTS)]
    parts = [
        _evaluate(surface, x[one], order, None if function is None else function[one])
        for one in chunks
    ]
    return [np.concatenate(part) for part in zip(*parts, strict=True)]


def _evaluate(
    surface: Surface, x: Float[ndarray, "point 3"], order: int, function: ndarray | None
) -> list[ndarray]:
    functions, *count = surface.coefficients.shape
    width = surface.high - surface.low
    basis = _derivatives(x, max(count), 2.0 / np.where(width > 0.0, width, np.inf), order)
    by_i, by_j, by_l = (basis[:, :, axis, :n] for axis, n in enumerate(count))
    flat = surface.coefficients.transpose(1, 0, 2, 3).reshape(count[0], -1)
    first = (by_i @ flat).reshape(order + 1, len(x), functions, *count[1:])
    if function is not None:
        first = first[:, np.arange(len(x)), function, None]
    along = {
        (i, k): np.einsum("pfjl,pl->pfj", first[i], by_l[k])
        for i in range(order + 1)
        for k in range(order + 1 - i)
    }

    def derivative(*axes: int) -> ndarray:
        i, j, k = (axes.count(axis) for axis in range(3))
        return np.einsum("pfj,pj->pf", along[i, k], by_j[j])

    results = [derivative()]
    if order > 0:
        results.append(np.stack([derivative(a) for a in range(3)], axis=-1))
    if order > 1:
        rows = [np.stack([derivative(a, b) for b in range(3)], axis=-1) for a in range(3)]
        results.append(np.stack(rows, axis=-2))
    return results if function is None else [part[:, 0] for part in results]


def _derivatives(
    x: Float[ndarray, "point 3"], count: int, scale: Float[ndarray, "3"], order: int
) -> Float[ndarray, "derivative point 3 coefficient"]:
    """Chebyshev polynomials and their derivatives by the unscaled coordinates."""
    results = [chebyshev.chebvander(x, count - 1)]
    for _ in range(order):
        rows = results[-1].reshape(-1, count) @ _differentiation(count)
        results.append(scale[:, None] * rows.reshape(results[-1].shape))
    return np.array(results)


@cache
def _differentiation(count: int) -> Float[ndarray, "coefficient coefficient"]:
    """Column k holds T_k's derivative in terms of the T's."""
    lower = chebyshev.chebder(np.eye(count))[: count - 1]
    return np.vstack([lower, np.zeros((1, count))])


def _inside(surface: Surface, points: Float[ndarray, "point 3"]) -> Float[ndarray, "point 3"]:
    """Points on the box [-1, 1]^3."""
    width = surface.high - surface.low
    slack = 1e-9 * np.maximum(width, 1.0)
    outside = (points < surface.low - slack) | (points > surface.high + slack)
    if outside.any():
        point, axis = np.argwhere(outside)[0]
        name, value = ("ln kn", "ln kt", "axial force")[axis], points[point, axis]
        raise ValueError(
            f"{name} must lie between {surface.low[axis]:.6g} and {surface.high[axis]:.6g}, "
            f"got {value:.6g}: outside the parametric model"
        )
    middle = 0.5 * (surface.low + surface.high)
    return np.clip((points - middle) * 2.0 / np.where(width > 0.0, width, np.inf), -1.0, 1.0)
