"""A beam that stiffens by the stretch of its axis."""

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points


def hardening(points: Points, values: np.ndarray) -> CurveEffect:
    """Restoring force x + alpha x^3 (3/8 alpha A^2 of ln f); the other modes' times a ratio.

    A stiffness without loss of its own takes its part of the loss factor down.
    """
    alpha, ratio = values
    other = points.mode > 0
    square = 0.375 * points.amplitude**2
    size = np.where(other, ratio, 1.0) * square
    slope = np.stack([size, np.where(other, alpha * square, 0.0)], axis=1)
    share = -2.0 * points.loss
    return CurveEffect(alpha * size, share * alpha * size, slope, share[:, None] * slope)


MECHANISM = Mechanism(
    id="geometric-hardening",
    kind="amplitude",
    sentence="the axis of the beam is stretched by its deflection: frequency rises with A squared",
    parameters=(
        Parameter(
            "alpha", "1/m2", 3e6, 1.5, 1e3, 1e10,
            "a beam held at both ends: about 1/h^2, 1e4, to far more at a laser near a node",
            log=True,
        ),
        Parameter(
            "ratio", "1", 0.5, 1.0, 1e-3, 1e3,
            "other modes over the first: the same stretch by another shape", log=True,
        ),
    ),
    splitter="higher harmonics of the velocity; the same amplitudes at another axial force",
    curve=hardening,
)  # fmt: skip
