"""Single-harmonic closed forms of Jenkins's element (eq. 3.19, appendix D) and what follows.

Under x(t) = x cos(wt) the friction force is replaced by its first harmonic, (k + i h) x. These
are the limits that the numerical methods must meet, and a fast model of amplitude curves.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

Array = Float[ndarray, "..."] | float  # numpy turns arrays of no dimension into floats


def equivalent_stiffness(
    amplitude: Array, stiffness: Array, limit: Array | float
) -> tuple[Array, Array]:
    """Real and imaginary part, k and h (N/m), of a slider's first-harmonic stiffness (eq. 3.19).

    amplitude: of the motion, m, not negative. stiffness: of the spring, N/m. limit: friction
    force, N. The arrays broadcast.
    """
    x, k, most = np.broadcast_arrays(
        *(np.asarray(one, float) for one in (amplitude, stiffness, limit))
    )
    stuck = np.ones(x.shape)
    stretch = k * x
    share = np.divide(most, stretch, out=stuck, where=stretch > most)  # x_cr / x
    angle = np.arccos(1.0 - 2.0 * share)
    real = k * (angle - 0.5 * np.sin(2.0 * angle)) / np.pi
    return real, k * 4.0 / np.pi * share * (1.0 - share)


def one_dof(
    amplitude: Array, mass: float, stiffness: float, tangential: float, limit: float
) -> tuple[Array, Array]:
    """Frequency (Hz) and loss factor against amplitude (m) of a mass on a spring and a slider.

    Units: kg, N/m, N/m, N (section 3.4). The loss factor is the dissipated energy of a cycle over
    2 pi times the equivalent spring's, as in eq. 3.7.
    """
    real, imaginary = equivalent_stiffness(amplitude, tangential, limit)
    whole = stiffness + real
    return np.sqrt(whole / mass) / (2.0 * np.pi), imaginary / whole


def fixed_shape(
    amplitude: Float[ndarray, " amplitude"],
    stick_frequency: float,
    motion: Float[ndarray, " slider"],
    stiffness: Float[ndarray, " slider"],
    limit: Float[ndarray, " slider"],
) -> tuple[Float[ndarray, " amplitude"], Float[ndarray, " amplitude"]]:
    """Frequency (Hz) and friction's loss factor of a mode that keeps its stuck shape.

    amplitude: of the modal coordinate (unit modal mass), m kg^1/2. motion: each slider's slip per
    modal coordinate while stuck, kg^-1/2. An upper bound of the frequency: a free shape gives way
    where sliders slip.
    """
    size = np.abs(motion)
    real, imaginary = equivalent_stiffness(amplitude[:, None] * size, stiffness, limit)
    value = (2.0 * np.pi * stick_frequency) ** 2 - (stiffness - real) @ size**2
    return np.sqrt(value) / (2.0 * np.pi), imaginary @ size**2 / value
