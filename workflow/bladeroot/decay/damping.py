"""Natural frequency and loss factor from a decay's instantaneous rate, for two laws of damping.

With Y' = lambda Y, lambda = A'/A + i omega, it is Y''/Y = lambda^2 + lambda'. Then

    hysteretic:  Y'' + omega_n^2 (1 + i eta) Y = 0          (3.7), solved by (3.11)
    viscous:     Y'' + 2 zeta omega_n Y' + omega_n^2 Y = 0

each give two real equations. The two natural frequencies of one decay differ by zeta^2 = eta^2 / 4
(relative, to second order): hysteretic omega_n^2 = omega^2 - (A'/A)^2, viscous omega_n^2 =
omega^2 + (A'/A)^2 where the rate is constant. The loss factor of viscous damping is 2 zeta (3.18).
"""

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

LAWS = ("hysteretic", "viscous")


def natural(
    rate: Complex[ndarray, " point"], change: Complex[ndarray, " point"], damping: str
) -> tuple[Float[ndarray, " point"], Float[ndarray, " point"]]:
    """omega_n in rad/s and the loss factor from lambda (1/s) and its time derivative (1/s^2).

    Both are NaN where omega_n^2 comes out negative: the mode is lost. Raises ValueError for an
    unknown law.
    """
    if damping not in LAWS:
        raise ValueError(f"damping must be {' or '.join(LAWS)}, got {damping!r}")
    acceleration = rate**2 + change
    square, loss = -acceleration.real, -acceleration.imag  # of (3.10): omega_n^2, eta omega_n^2
    if damping == "viscous":
        twice_decline = loss / rate.imag  # 2 zeta omega_n
        square = square - twice_decline * rate.real
        loss = twice_decline * np.sqrt(np.abs(square))
    square = np.where(square > 0.0, square, np.nan)
    return np.sqrt(square), loss / square
