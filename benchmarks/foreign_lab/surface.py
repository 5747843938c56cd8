"""Frequencies of a joint over (ln kn, ln kt, F) as Chebyshev sums, and what a mode moves there."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

# Points along ln kn, ln kt, F. With 3 along F a beam that tension stiffens by a quarter was off by
# 0.2 %, a law of the load of its own.
ORDERS = (7, 9, 7)


@dataclass(frozen=True)
class Surface:
    """ln f of one mode; `slip`, `open`: rms slip and gap of the flanks per metre at the laser.

    `stretch`: change of omega^2 times modal mass per newton; `modal_mass` in kg at the laser.
    """

    coefficients: np.ndarray
    low: np.ndarray
    high: np.ndarray
    slip: float
    open: float
    modal_mass: float

    def ln_frequency(self, ln_kn, ln_kt, force) -> np.ndarray:
        """ln(f / Hz); outside the box the value at its edge."""
        return chebyshev.chebval3d(*self._scaled(ln_kn, ln_kt, force), self.coefficients)

    def slope(self, axis: int, ln_kn, ln_kt, force) -> np.ndarray:
        """Derivative of ln f by ln kn (0), ln kt (1) or F (2)."""
        scale = 2.0 / (self.high[axis] - self.low[axis])
        part = chebyshev.chebder(self.coefficients, axis=axis) * scale
        return chebyshev.chebval3d(*self._scaled(ln_kn, ln_kt, force), part)

    def _scaled(self, *point) -> list[np.ndarray]:
        wide = np.broadcast_arrays(*(np.asarray(part, dtype=float) for part in point))
        return [
            np.clip(2.0 * (part - low) / (high - low) - 1.0, -1.0, 1.0)
            for part, low, high in zip(wide, self.low, self.high, strict=True)
        ]


def grid(low: np.ndarray, high: np.ndarray) -> list[np.ndarray]:
    """Chebyshev points of each coordinate."""
    return [
        a + (b - a) * (1 + np.cos(np.pi * (np.arange(n) + 0.5) / n)) / 2
        for a, b, n in zip(low, high, ORDERS, strict=True)
    ]


def fit(values: np.ndarray) -> np.ndarray:
    """Coefficients from values at the points of `grid` (kn, kt, force)."""
    for axis, n in enumerate(values.shape):
        basis = chebyshev.chebvander(np.cos(np.pi * (np.arange(n) + 0.5) / n), n - 1)
        values = np.moveaxis(np.tensordot(np.linalg.inv(basis), values, (1, axis)), 0, axis)
    return values


def sample(ln_frequency: Callable, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Coefficients (mode, ...) of a function of a point that gives ln f of all modes."""
    kn, kt, force = grid(low, high)
    values = np.array([[[ln_frequency(a, b, f) for f in force] for b in kt] for a in kn])
    return np.stack([fit(values[..., mode]) for mode in range(values.shape[-1])])
