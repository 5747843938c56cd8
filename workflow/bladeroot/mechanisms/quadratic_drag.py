"""Damping by the air that the beam moves."""

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points
from bladeroot.mechanisms.over_amplitude import of_loss

REFERENCE_AMPLITUDE = 1e-5  # m, where `beta` is a loss factor over an amplitude in all forms


def quadratic(points: Points, values: np.ndarray) -> CurveEffect:
    """The loss factor grows by beta A, whatever the force; frequency stays."""
    return of_loss(points, values[:2], points.amplitude)


def power(points: Points, values: np.ndarray) -> CurveEffect:
    """By a power of A between that of a viscous layer and of a separated flow that grows."""
    x = np.log(points.amplitude / REFERENCE_AMPLITUDE)
    course = REFERENCE_AMPLITUDE * np.exp(values[2] * x)
    return of_loss(points, values[:2], course, course * x)


def onset(points: Points, values: np.ndarray) -> CurveEffect:
    """By beta A beyond an amplitude at which the flow parts from the edges, by A^2 below."""
    at = values[2]
    whole = np.hypot(points.amplitude, at)
    return of_loss(points, values[:2], whole - at, at / whole - 1.0)


MECHANISM = Mechanism(
    id="quadratic-drag",
    kind="amplitude",
    sentence="a drag that grows with the square of the velocity: damping in proportion to A",
    parameters=(
        Parameter(
            "beta", "1/m", 50.0, 1.5, 1e-2, 1e6,
            "8/(3 pi) times drag over modal mass: the same at all forces", log=True,
        ),
        Parameter(
            "ratio", "1", 1.0, 1.0, 1e-3, 1e3,
            "another mode over the first: the same drag by another shape", log=True, ratio=True,
        ),
    ),
    splitter="the same decays in thinner air, or with the {beam}'s broad side covered",
    curve=quadratic,
    form="quadratic",
).also(
    "power",
    Parameter(
        "power", "1", 1.0, 0.3, 0.3, 3.0, "of the amplitude: drag falls with Reynolds' number, and "
        "grows with the stroke over the width", log=True,
    ),
    curve=power,
).also(
    "onset",
    Parameter("onset", "m", 5e-6, 1.2, 1e-8, 1e-2, "stroke at which the flow parts", log=True),
    curve=onset,
)  # fmt: skip
