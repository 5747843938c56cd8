"""What changed matrices do to the stick frequencies of records."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.structure.chebyshev import Surface
from bladeroot.structure.ritz import Ritz, solve


class Structures:
    """Change of ln f by changed matrices, from the modes' shapes at the unchanged ones.

    Rayleigh's quotient: the frequency is stationary in the shape. Shapes are kept until kn or kt
    have moved by some per cent.
    """

    def __init__(self, records: Records, ritz: Sequence[Ritz], surface: Surface) -> None:
        """Projected problems by mode, and the surface whose box their points must lie in."""
        self.records, self.ritz, self.surface = records, ritz, surface
        self.forces, self.where = np.unique(records.force, return_inverse=True)
        self.at: ndarray | None = None
        self.shapes: list = []

    def __call__(
        self, one: Mechanism, values: ndarray, ln_kn: float, ln_kt: float
    ) -> tuple[Float[ndarray, " record"], Float[ndarray, "record parameter"]]:
        """Change of ln f of each record, and its derivative by the mechanism's parameters."""
        now = np.array([ln_kn, ln_kt])
        if self.at is None or np.abs(now - self.at).max() > 0.05:
            low, high = self.surface.low, self.surface.high
            points = np.stack(
                [np.full(self.forces.size, ln_kn), np.full(self.forces.size, ln_kt), self.forces],
                axis=1,
            )
            points = np.clip(points, low, high)
            self.at, self.shapes = now, [solve(one, points) for one in self.ritz]
        n = self.records.force.size
        change, slopes = np.zeros(n), np.zeros((n, values.size))
        for mode, (ritz, pairs) in enumerate(zip(self.ritz, self.shapes, strict=True)):
            mine = self.records.mode == mode
            whole, parts = one.structure(ritz, values)
            kept = slice(0, ritz.own)

            def share(matrix: ndarray, y: ndarray = pairs.shape, kept: slice = kept) -> ndarray:
                return ((y @ matrix[kept, kept]) * y).sum(axis=1)

            stiff = np.maximum(1.0 + share(whole.stiffness) / pairs.value, 0.05)
            mass = np.maximum(1.0 + share(whole.mass), 0.05)
            value = 0.5 * (np.log(stiff) - np.log(mass))
            change[mine] = value[self.where[mine]]
            for k, part in enumerate(parts):
                slope = 0.5 * (
                    share(part.stiffness) / pairs.value / stiff - share(part.mass) / mass
                )
                slopes[mine, k] = slope[self.where[mine]]
        return change, slopes
