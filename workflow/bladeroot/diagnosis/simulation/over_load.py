"""Values of a table between its loads, and what the table leaves unsaid there."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.interpolate import BSpline, make_interp_spline

# Of what a spline misses at a load that is left out, the part that it may miss midway between two:
# cubics err with the fourth power of their knots' distance, and tables are not that smooth. With it
# goes such a part, over the square of the number of loads, of what it differs by from straight
# lines: of few loads one may be left out by chance without harm.
LEFT_OUT, BENT = 0.125, 2.0


@dataclass(frozen=True)
class OverLoad:
    """Values over the load: a spline that goes straight on beyond the ends.

    Cubic where there are four loads, in the load or its logarithm: by that which misses less at
    loads that are left out. missed: by how much it does at each.
    """

    loads: Float[ndarray, " load"]
    values: Float[ndarray, " load"]

    @cached_property
    def _best(self) -> tuple[bool, ndarray]:
        """Whether the logarithm is taken, and what is missed then."""
        inner = range(1, self.loads.size - 1)
        tried = []
        for log in (False, True) if self.loads.min() > 0.0 else (False,):
            missed = np.zeros(self.loads.size)
            for k in inner:
                rest = OverLoad(np.delete(self.loads, k), np.delete(self.values, k))
                there = rest._spline(log)(rest._place(self.loads[[k]], log))
                missed[k] = abs(float(there[0]) - self.values[k])
            if inner:
                missed[[0, -1]] = missed.max()
            tried.append((log, missed))
        return min(tried, key=lambda one: float(np.sum(one[1] ** 2)))

    @property
    def missed(self) -> Float[ndarray, " load"]:
        """Of each value by a spline through the others."""
        return self._best[1]

    @staticmethod
    def _place(load: ndarray, log: bool) -> ndarray:
        return np.log(load) if log else load

    def _spline(self, log: bool) -> BSpline:
        return make_interp_spline(
            self._place(self.loads, log), self.values, k=min(3, self.loads.size - 1)
        )

    @cached_property
    def _made(self) -> tuple[BSpline, BSpline | None]:
        spline = self._spline(self._best[0])
        return spline, spline.derivative() if self.loads.size > 1 else None

    def __call__(self, load: Float[ndarray, " record"]) -> tuple[ndarray, ndarray]:
        """Values, and their slopes by the load."""
        spline, rate = self._made
        if rate is None:
            return np.full(load.size, self.values[0]), np.zeros(load.size)
        log = self._best[0]
        inside = np.clip(load, self.loads[0], self.loads[-1])
        place = self._place(inside, log)
        slope = rate(place) / inside if log else rate(place)
        return spline(place) + slope * (load - inside), slope

    def error(self, load: Float[ndarray, " record"]) -> tuple[ndarray, ndarray]:
        """Standard error of values between the loads, none at them; and between which two."""
        if self.loads.size < 2:
            return np.zeros(load.size), np.zeros(load.size, dtype=int)
        right = np.clip(np.searchsorted(self.loads, load), 1, self.loads.size - 1)
        low, high = self.loads[right - 1], self.loads[right]
        part = np.clip((load - low) / (high - low), 0.0, 1.0)
        missed = np.maximum(self.missed[right - 1], self.missed[right])
        straight = np.interp(load, self.loads, self.values)
        bent = self(np.clip(load, self.loads[0], self.loads[-1]))[0] - straight
        misses = LEFT_OUT * 4.0 * part * (1.0 - part) * missed
        return np.hypot(misses, BENT / self.loads.size**2 * bent), right
