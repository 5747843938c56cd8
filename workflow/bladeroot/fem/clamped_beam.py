"""The clamped beam under axial force of appendix B: Euler-Bernoulli, both ends built in."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy.optimize import brentq


def wave_number(mode: int) -> float:
    """lambda_n, the `mode`-th root of cos(lambda) cosh(lambda) = 1 (B-17); `mode` counts from 1."""
    if mode < 1:
        raise ValueError(f"mode must be 1 or more, got {mode}")
    centre = (mode + 0.5) * np.pi
    # cos - 1/cosh has the same roots and does not overflow
    return float(
        brentq(lambda x: np.cos(x) - 1.0 / np.cosh(x), centre - 0.5, centre + 0.5, xtol=1e-14)
    )


def stiffening_factor(mode: int) -> float:
    """Ratio of the integrals of X'^2 and X^2 over a unit length in B-12.

    In closed form for the clamped shape: s lambda (s lambda - 2) with the shape's constant
    s = (cosh - cos)/(sinh - sin), the inverse of the factor in B-18.
    """
    root = wave_number(mode)
    shape = (np.cosh(root) - np.cos(root)) / (np.sinh(root) - np.sin(root))
    return float(shape * root * (shape * root - 2.0))


def beam_frequency(
    axial_force: Float[ndarray, " force"] | float,
    mode: int,
    length: float,
    bending_stiffness: float,
    mass_per_length: float,
) -> Float[ndarray, " force"] | float:
    """Natural frequency (Hz) under an axial force (N), positive in tension (B-12, B-17).

    omega^2 = (lambda/L)^4 EI/mu + N/(mu L^2) times `stiffening_factor`: a Rayleigh quotient with
    the unloaded beam's shape, and so an upper bound that is exact at N = 0. length: m.
    bending_stiffness: EI, N m^2. mass_per_length: mu, kg/m.
    """
    unloaded = (wave_number(mode) / length) ** 4 * bending_stiffness / mass_per_length
    added = stiffening_factor(mode) / (mass_per_length * length**2)
    return np.sqrt(unloaded + np.asarray(axial_force) * added) / (2.0 * np.pi)
