"""Damping by the air that the beam moves."""

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points


def drag(points: Points, values: np.ndarray) -> CurveEffect:
    """The loss factor grows by beta A, whatever the force; frequency stays."""
    beta, ratio = values
    size = np.where(points.mode > 0, ratio, 1.0) * points.amplitude
    by_ratio = np.where(points.mode > 0, beta * points.amplitude, 0.0)
    return CurveEffect(
        np.zeros_like(size), beta * size, np.zeros((len(size), 2)),
        np.stack([size, by_ratio], axis=1),
    )  # fmt: skip


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
            "other modes over the first: the same drag by another shape", log=True,
        ),
    ),
    splitter="the same decays in thinner air, or with the beam's broad side covered",
    curve=drag,
)  # fmt: skip
