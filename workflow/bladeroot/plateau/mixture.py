"""A probability that is a sum of normal parts, and its intervals."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.special import ndtr

NORMAL = {68: (0.158655, 0.841345), 95: (0.025, 0.975)}  # ends of the central intervals, in %


@dataclass(frozen=True)
class Mixture:
    """A probability that is a sum of normal parts."""

    weight: Float[ndarray, " part"]
    mean: Float[ndarray, " part"]
    variance: Float[ndarray, " part"]

    def quantiles(self, share: tuple[float, ...]) -> Float[ndarray, " share"]:
        """Where so much of the probability lies below."""
        some = self.weight > 1e-6 * self.weight.max()
        weight, std = self.weight[some], np.sqrt(self.variance[some])
        mean, weight = self.mean[some], weight / weight.sum()
        low = np.full(len(share), (mean - 4.0 * std).min())
        high = np.full(len(share), (mean + 4.0 * std).max())
        # by bisection, to 1e-5 of the smallest standard deviation or what a number can tell
        for _ in range(min(int(np.log2((high[0] - low[0]) / std.min()) + 17.0), 60)):
            at = 0.5 * (low + high)
            above = ndtr((at[:, None] - mean) / std) @ weight >= share
            low, high = np.where(above, low, at), np.where(above, at, high)
        return 0.5 * (low + high)

    def middle(self) -> tuple[float, float]:
        """Median, and a standard error that serves for both of its intervals.

        Between the one that holds 68 % and 1/1.96 of what holds 95 %. The variance would hang on
        parts of hardly any weight that are far away.
        """
        q = self.quantiles((*NORMAL[95], *NORMAL[68], 0.5))
        return float(q[4]), float(np.sqrt(0.5 * (q[3] - q[2]) * (q[1] - q[0]) / 3.92))
