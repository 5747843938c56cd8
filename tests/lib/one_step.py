"""One time step of a damped mode, r'' + 2 zeta omega r' + omega^2 r = g, as a matrix.

Every method that is linear in the state and in the load at both ends of the step is such a matrix:
Newmark's average acceleration (3.15, 3.16), and the exact solution for a load that varies linearly.
With it goes the exact quadratic form of what the damper takes in the step.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

_GAUSS = 12  # points of the quadrature of the damper's work within a step


@dataclass(frozen=True)
class OneStep:
    """`matrix` gives (r, r') at the end from (r, r', g) at the start and g at the end.

    `loss` is the damper's work in the step as a quadratic form of the same four. omega (rad/s) and
    dt (s) are those that it was made for.
    """

    omega: Float[ndarray, " mode"]
    matrix: Float[ndarray, "mode 2 4"]
    loss: Float[ndarray, "mode 4 4"]
    dt: float


def newmark(omega: Float[ndarray, " mode"], zeta: Float[ndarray, " mode"], dt: float) -> OneStep:
    """Average acceleration, gamma 1/2 and beta 1/4 (section 3.3.2).

    Stable at any step and without damping of its own; periods are too long by (omega dt)^2 / 12.
    """
    omega, zeta = np.broadcast_arrays(np.asarray(omega, float), np.asarray(zeta, float))
    damper, spring = 2.0 * zeta * omega, omega**2
    # The new r' solves r'_1 = r'_0 + dt (a_0 + a_1)/2, with r_1 = r_0 + dt (r'_0 + r'_1)/2 in a_1.
    lead = 1.0 + 0.5 * dt * damper + 0.25 * dt**2 * spring
    matrix = np.zeros((omega.size, 2, 4))
    matrix[:, 1, 0] = -dt * spring / lead
    matrix[:, 1, 1] = (2.0 - lead) / lead
    matrix[:, 1, 2] = matrix[:, 1, 3] = 0.5 * dt / lead
    matrix[:, 0] = 0.5 * dt * matrix[:, 1]
    matrix[:, 0, 0] += 1.0
    matrix[:, 0, 1] += 0.5 * dt
    mean = 0.5 * matrix[:, 1]
    mean[:, 1] += 0.5
    return OneStep(omega, matrix, dt * damper[:, None, None] * _squares(mean), dt)


def exact(omega: Float[ndarray, " mode"], zeta: Float[ndarray, " mode"], dt: float) -> OneStep:
    """Exact for a load that varies linearly over the step (Duhamel's integral): no period error.

    Raises ValueError for a mode that is not underdamped.
    """
    omega, zeta = np.broadcast_arrays(np.asarray(omega, float), np.asarray(zeta, float))
    if not np.all((omega > 0.0) & (zeta < 1.0)):
        raise ValueError("modes must be underdamped with omega > 0")
    place, weight = np.polynomial.legendre.leggauss(_GAUSS)
    loss = np.zeros((omega.size, 4, 4))
    for at, part in zip(0.5 * (1.0 + place), 0.5 * weight, strict=True):
        loss += part * dt * _squares(_response(omega, zeta, dt, at * dt)[:, 1])
    loss *= (2.0 * zeta * omega)[:, None, None]
    return OneStep(omega, _response(omega, zeta, dt, dt), loss, dt)


def hysteretic(
    omega: Float[ndarray, " mode"], loss_factor: Float[ndarray, " mode"]
) -> tuple[Float[ndarray, " mode"], Float[ndarray, " mode"]]:
    """omega and zeta of the damper whose free decay is that of omega^2 (1 + i eta) (eq. 3.7)."""
    pole = omega * np.sqrt(1.0 + 1j * np.asarray(loss_factor))
    return np.abs(pole), pole.imag / np.abs(pole)


def _squares(row: Float[ndarray, "mode 4"]) -> Float[ndarray, "mode 4 4"]:
    return row[:, :, None] * row[:, None, :]


def _response(omega: ndarray, zeta: ndarray, dt: float, time: float) -> Float[ndarray, "mode 2 4"]:
    """(r, r') at a time within the step: the slow answer to the ramp and a damped sine about it."""
    damped, decay = omega * np.sqrt(1.0 - zeta**2), zeta * omega
    grow = np.exp(-decay * time)
    sine, cosine = grow * np.sin(damped * time) / damped, grow * np.cos(damped * time)
    free = np.empty((omega.size, 2, 2))
    free[:, 0, 0], free[:, 0, 1] = cosine + decay * sine, sine
    free[:, 1, 0], free[:, 1, 1] = -(omega**2) * sine, cosine - decay * sine
    spring = omega**2
    start, end = _slow(spring, decay, 0.0, dt), _slow(spring, decay, time / dt, dt)
    return np.concatenate([free, end - free @ start], axis=2)


def _slow(spring: ndarray, decay: ndarray, part: float, dt: float) -> Float[ndarray, "mode 2 2"]:
    """r and r' on the straight line that obeys the equation, by the load at both ends."""
    slope = np.array([-1.0, 1.0]) / dt
    load = np.array([1.0 - part, part])
    place = (load - (2.0 * decay / spring)[:, None] * slope) / spring[:, None]
    return np.stack([place, slope / spring[:, None]], axis=1)
