"""A probability that is a sum of normal parts, and its intervals."""

from dataclasses import dataclass
from math import erfc
from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.compiled import njit

NORMAL = {68: (0.158655, 0.841345), 95: (0.025, 0.975)}  # ends of the central intervals, in %
SQRT2 = np.sqrt(2.0)


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
        return _quantiles(weight / weight.sum(), self.mean[some], std, np.array(share))

    def middle(self) -> tuple[float, float]:
        """Median, and a standard error that serves for both of its intervals.

        Between the one that holds 68 % and 1/1.96 of what holds 95 %. The variance would hang on
        parts of hardly any weight that are far away.
        """
        q = self.quantiles((*NORMAL[95], *NORMAL[68], 0.5))
        return float(q[4]), float(np.sqrt(0.5 * (q[3] - q[2]) * (q[1] - q[0]) / 3.92))


@njit(cache=True)
@no_type_check
def _quantiles(
    weight: Float[ndarray, " part"],
    mean: Float[ndarray, " part"],
    std: Float[ndarray, " part"],
    share: Float[ndarray, " share"],
) -> Float[ndarray, " share"]:
    """By bisection, to 1e-5 of the smallest standard deviation."""
    found = np.empty(share.size)
    least, most = np.inf, -np.inf
    for part in range(mean.size):
        least = min(least, mean[part] - 4.0 * std[part])
        most = max(most, mean[part] + 4.0 * std[part])
    for k in range(share.size):
        low, high = least, most
        while high - low > 1e-5 * std.min():
            at = 0.5 * (low + high)
            if at in (low, high):
                break
            below = 0.0
            for part in range(weight.size):
                below += 0.5 * weight[part] * erfc((mean[part] - at) / (std[part] * SQRT2))
            low, high = (at, high) if below < share[k] else (low, at)
        found[k] = 0.5 * (low + high)
    return found
