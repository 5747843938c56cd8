"""How the stuck system answers the forces that slipping contacts fail to carry.

At a master amplitude A the named mode's coordinate is A cos(theta); extended periodic motion
(Krack 2015) lets a negative damping proportional to mass, decay = 2 zeta omega^2, keep it going.
The master's own equation then gives omega^2 and the decay, and all other motion follows from the
forces. Quasi-static motion is the same with one coefficient and no decay.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.nonlinear.aft import layout
from bladeroot.nonlinear.system import System


@dataclass(frozen=True)
class Response:
    """Motion under given missing forces at a master amplitude.

    motion: contact motion, m. modal: coordinates of the modes, m kg^1/2. value: omega^2, decay:
    2 zeta omega^2, 1/s^2. gain: modal coordinates by modal forces, s^2. by_value, by_decay:
    derivative of the modal coordinates.
    """

    motion: Float[ndarray, "contact 3 coefficient"]
    modal: Float[ndarray, "mode coefficient"]
    value: float
    decay: float
    gain: Float[ndarray, "mode coefficient coefficient"]
    by_value: Float[ndarray, "mode coefficient"]
    by_decay: Float[ndarray, "mode coefficient"]


@dataclass(frozen=True)
class Balance:
    """Which coefficients a motion has; quasi-static motion (`dynamic` False) has one."""

    harmonics: tuple[int, ...]
    dynamic: bool

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return len(layout(self.harmonics)) if self.dynamic else 1

    @property
    def first(self) -> int:
        """The coefficient of cos(theta)."""
        return layout(self.harmonics).index((1, 1)) if self.dynamic else 0


QUASI_STATIC = Balance((1,), False)


def harmonic(harmonics: Sequence[int]) -> Balance:
    """Periodic motion of the given harmonics; 0 is the mean."""
    return Balance(tuple(harmonics), True)


def respond(
    system: System,
    balance: Balance,
    amplitude: float,
    missing: Float[ndarray, "contact 3 coefficient"],
) -> Response:
    """The answer to missing forces (N): linear contact force less the law's, on each contact."""
    modal_force = np.einsum("c,cam,cah->mh", system.count, system.shape, missing)
    first = balance.first
    value = float(system.values[0] - modal_force[0, first] / amplitude)
    decay = 0.0
    if balance.dynamic:
        material = system.loss[0] * system.values[0]
        decay = float(material + modal_force[0, first + 1] / amplitude)
    gain, by_value, by_decay = _gains(system, balance, value, decay)
    modal = np.einsum("mgh,mh->mg", gain, modal_force)
    modal[0, first] += amplitude
    return Response(
        _motion(system, modal, missing),
        modal,
        value,
        decay,
        gain,
        np.einsum("mgh,mh->mg", by_value, modal_force),
        np.einsum("mgh,mh->mg", by_decay, modal_force),
    )


def _motion(system: System, modal: ndarray, missing: ndarray) -> ndarray:
    return system.shape @ modal + np.einsum("caeb,ebh->cah", system.flexibility, missing)


def laser_motion(
    system: System,
    modal: Float[ndarray, "mode coefficient"],
    missing: Float[ndarray, "contact 3 coefficient"],
) -> Float[ndarray, " coefficient"]:
    """Coefficients of the motion at the laser, m."""
    return system.laser @ modal + np.einsum("ca,cah->h", system.laser_flexibility, missing)


def respond_change(
    system: System,
    balance: Balance,
    amplitude: float,
    response: Response,
    change: Float[ndarray, "contact 3 coefficient"],
    rise: float = 0.0,
) -> Response:
    """Derivative of the response when the missing forces change and the master amplitude rises.

    Only motion, modal coordinates, value and decay of the result are such derivatives.
    """
    modal_force = np.einsum("c,cam,cah->mh", system.count, system.shape, change)
    first = balance.first
    lower = system.values[0] - response.value
    value = float((lower * rise - modal_force[0, first]) / amplitude)
    decay = 0.0
    if balance.dynamic:
        more = response.decay - system.loss[0] * system.values[0]
        decay = float((modal_force[0, first + 1] - more * rise) / amplitude)
    modal = np.einsum("mgh,mh->mg", response.gain, modal_force)
    modal += value * response.by_value + decay * response.by_decay
    modal[0, first] += rise
    return replace(
        response, motion=_motion(system, modal, change), modal=modal, value=value, decay=decay
    )


def response_matrix(
    system: System,
    balance: Balance,
    amplitude: float,
    response: Response,
    active: Int[ndarray, " place"],
) -> Float[ndarray, "row row"]:
    """The same derivative as a matrix over chosen places (contact times axis, flat).

    Rows are places by coefficients.
    """
    shape = system.shape.reshape(-1, len(system.values))[active]
    loaded = shape * np.repeat(system.count, 3)[active, None]
    size, count = balance.size, len(active)
    flat = system.flexibility.reshape(len(system.count) * 3, -1)[np.ix_(active, active)]
    matrix = np.zeros((count, size, count, size))
    for g in range(size):
        for h in range(size):
            gain = response.gain[:, g, h]
            if g == h:
                matrix[:, g, :, h] = flat
            if gain.any():
                matrix[:, g, :, h] += (shape * gain) @ loaded.T
    first = balance.first
    by_value, by_decay = shape @ response.by_value, shape @ response.by_decay
    matrix[:, :, :, first] -= by_value[:, :, None] * loaded[:, 0] / amplitude
    if balance.dynamic:
        matrix[:, :, :, first + 1] += by_decay[:, :, None] * loaded[:, 0] / amplitude
    return matrix.reshape(count * size, count * size)


def _gains(
    system: System, balance: Balance, value: float, decay: float
) -> tuple[ndarray, ndarray, ndarray]:
    """Modal coordinate per modal force, and its derivatives by omega^2 and by the decay.

    A complex gain p + iq acts on x_c - i x_s: motion is the real part of that times e^(ih theta).
    A stuck contact has its part of the other modes' material loss. What it fails to carry, it fails
    to damp: without its loss on the missing force, modes of stuck contacts would damp flanks that
    slide as if they still pressed springs between them.
    """
    modes, size = len(system.values), balance.size
    gain, by_value, by_decay = np.zeros((3, modes, size, size))
    if not balance.dynamic:
        gain[1:, 0, 0] = 1.0 / (system.values[1:] - value)
        by_value[1:, 0, 0] = gain[1:, 0, 0] ** 2
        return gain, by_value, by_decay
    order = np.array([h for h, trig in layout(balance.harmonics) if trig])
    place = np.array([i for i, (_, trig) in enumerate(layout(balance.harmonics)) if trig])
    for h, i in zip(order, place, strict=True):
        if h == 0:
            gain[:, i, i] = 1.0 / system.values
            continue
        loss = system.loss * system.values - h * decay
        given = 1 if h == 1 else 0  # the master's first harmonic is given
        inverse = np.zeros(modes, dtype=complex)
        inverse[given:] = 1.0 / (system.values - h**2 * value + 1j * loss)[given:]
        missing = 1.0 + 1j * system.loss
        for matrix, number in (
            (gain, missing * inverse),
            (by_value, missing * h**2 * inverse**2),
            (by_decay, missing * 1j * h * inverse**2),
        ):
            matrix[:, i, i] = matrix[:, i + 1, i + 1] = number.real
            matrix[:, i, i + 1], matrix[:, i + 1, i] = number.imag, -number.imag
    return gain, by_value, by_decay
