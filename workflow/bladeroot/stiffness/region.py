"""Regions of the ln k by the posterior's draws: where they lie densest.

The valley of (ln kn, ln kt) is bent and can end at the model's box, so that ellipses about a mean
hold too little. The region of a share is where the density is above the value that this share of
the draws exceeds. The density is a kernel estimate, which smooths a thin valley to a wider one; the
share is counted among the draws, and stays right.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

SHARES = (0.68, 0.95)


def share_within(
    draws: Float[ndarray, "draw axis"], points: Float[ndarray, "point axis"]
) -> Float[ndarray, " point"]:
    """Share of the region on whose edge each point lies: every larger region holds the point."""
    from scipy.stats import gaussian_kde

    # Weighted draws come several times: a draw's density is that of all others, copies left out.
    draws, copies = np.unique(draws, axis=0, return_counts=True)
    weight = copies / copies.sum()
    kernel = gaussian_kde(draws.T, weights=weight)
    peak = 1.0 / np.sqrt(np.linalg.det(2.0 * np.pi * kernel.covariance))
    own = (kernel(draws.T) - weight * peak) / (1.0 - weight)
    order = np.argsort(own)
    below = np.concatenate([[0.0], np.cumsum(weight[order])])
    return 1.0 - below[np.searchsorted(own[order], kernel(points.T))]
