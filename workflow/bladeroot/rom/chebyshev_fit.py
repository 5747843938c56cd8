"""Sums of Chebyshev polynomials (`chebyshev`) for functions that can be asked anywhere in a box."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from numpy.polynomial import chebyshev

from bladeroot.rom.chebyshev import Surface

_MOST_COEFFICIENTS = 64  # along one coordinate


def fit(
    function: Callable[[Float[ndarray, "point 3"]], Float[ndarray, "function point"]],
    low: Float[ndarray, " coordinate"],
    high: Float[ndarray, " coordinate"],
    tolerance: float,
) -> Surface:
    """Interpolate at Chebyshev's nodes, as many along a coordinate as lines through the box need.

    tolerance: what the coefficients left out along such a line may add up to, in the function's own
    unit. Raises ValueError if 64 do not suffice.
    """
    count = [_order(function, low, high, axis, tolerance) for axis in range(3)]
    nodes = [_nodes(n) for n in count]
    grid = np.stack(np.meshgrid(*nodes, indexing="ij"), axis=-1).reshape(-1, 3)
    values = function(0.5 * (low + high) + 0.5 * (high - low) * grid)
    c = values.reshape(-1, *count)
    for axis in range(3):
        c = np.moveaxis(np.tensordot(c, _transform(count[axis]), (axis + 1, 0)), -1, axis + 1)
    return Surface(c, low, high)


def _order(function, low: ndarray, high: ndarray, axis: int, tolerance: float) -> int:
    """How many coefficients lines along one coordinate need, through the middle and the corners."""
    if low[axis] == high[axis]:
        return 1
    others = np.stack(np.meshgrid([-1.0, 1.0], [-1.0, 1.0]), axis=-1).reshape(-1, 2)
    others = np.vstack([others, 0.5 * others, np.zeros((1, 2))])
    for count in (16, 32, _MOST_COEFFICIENTS):
        line = np.empty((len(others), count, 3))
        line[:, :, axis] = _nodes(count)
        line[:, :, [k for k in range(3) if k != axis]] = others[:, None]
        values = function((0.5 * (low + high) + 0.5 * (high - low) * line).reshape(-1, 3))
        c = values.reshape(-1, len(others), count) @ _transform(count)
        left = np.abs(c[..., ::-1]).cumsum(axis=-1).max(axis=(0, 1))[::-1]
        enough = np.flatnonzero(left <= tolerance)
        if len(enough) and enough[0] <= count - 2:
            return max(int(enough[0]), 2)
    raise ValueError(
        f"the frequencies are not smooth over the box: {_MOST_COEFFICIENTS} Chebyshev coefficients "
        f"along {('ln kn', 'ln kt', 'the force')[axis]} leave {left[-2]:.1e} of ln f where "
        f"{tolerance:.1e} is asked; narrow the box"
    )


def _transform(count: int) -> Float[ndarray, "node coefficient"]:
    """From values at Chebyshev's nodes to coefficients."""
    matrix = chebyshev.chebvander(_nodes(count), count - 1) * (2.0 / count)
    matrix[:, 0] /= 2.0
    return matrix


def _nodes(count: int) -> Float[ndarray, " node"]:
    return np.cos(np.pi * (np.arange(count) + 0.5) / count)
