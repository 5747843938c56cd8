"""Quadrature that keeps its accuracy at logarithmic singularities on the end points."""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray


@lru_cache(maxsize=8)
def _double_exponential(count: int) -> tuple[ndarray, ndarray]:
    """Nodes on (0, 1) and weights of the tanh-sinh rule; both end points may be singular."""
    reach = 3.3  # beyond it the weights fall below the rounding of the sum
    u = np.linspace(-reach, reach, count)
    s = 0.5 * np.pi * np.sinh(u)
    node = 1.0 / (1.0 + np.exp(-2.0 * s))
    weight = 0.25 * np.pi * np.cosh(u) / np.cosh(s) ** 2
    weight = weight * (u[1] - u[0])
    return node, weight / weight.sum()


def panel_rule(
    edges: Float[ndarray, "*batch edge"], count: int = 101
) -> tuple[Float[ndarray, "*batch node"], Float[ndarray, "*batch node"]]:
    """Nodes and weights of a tanh-sinh rule on the panels between neighbouring edges.

    Integrands may be logarithmically singular at any edge: the rule never touches one, and its
    error falls about exponentially with `count`, the number of nodes in a panel (Takahasi and
    Mori 1974). A panel of zero width contributes nothing.
    """
    node, weight = _double_exponential(count)
    low, width = edges[..., :-1, None], np.diff(edges, axis=-1)[..., None]
    nodes = low + width * node
    weights = width * weight
    flat = (*edges.shape[:-1], -1)
    return nodes.reshape(flat), weights.reshape(flat)
