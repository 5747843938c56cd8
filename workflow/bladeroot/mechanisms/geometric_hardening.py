"""A beam that stiffens by the stretch of its axis, or by what it comes to touch."""

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points
from bladeroot.mechanisms.over_amplitude import OWN_LOSS, of_spring

# Part of a stop's stiffness that is felt at an amplitude of twice its gap.
_PART_AT_TWICE = 2.0 / 3.0 - np.sqrt(3.0) / (2.0 * np.pi)
# Normal distribution of ln gap about the law's, of a standard deviation of 0.25.
_LN_GAP = 0.25 * np.linspace(-2.5, 2.5, 21)
_GAP_WEIGHTS = np.exp(-0.5 * (_LN_GAP / 0.25) ** 2) / np.exp(-0.5 * (_LN_GAP / 0.25) ** 2).sum()


def cubic(points: Points, values: np.ndarray) -> CurveEffect:
    """Restoring force x + alpha x^3 (3/8 alpha A^2 of ln f); the other modes' times a ratio."""
    return of_spring(points, values[:3], 0.375 * points.amplitude**2)


def large(points: Points, values: np.ndarray) -> CurveEffect:
    """The same where the stretch gives way at large amplitudes: A^2 / (1 + (A / bend)^2)."""
    square = points.amplitude**2
    left = 1.0 / (1.0 + square / values[3] ** 2)
    return of_spring(
        points, values[:3], 0.375 * square * left,
        0.75 * square**2 * left**2 / values[3] ** 3,
    )  # fmt: skip


def stop(points: Points, values: np.ndarray) -> CurveEffect:
    """A stiffness behind gaps to both sides, by its first harmonic; as much as alpha at A = 2 gap.

    Gaps are spread, as no two faces are parallel; the other modes' amplitude of touch times a
    ratio.
    """
    other = points.mode > 0
    gap = values[3] * np.where(other, values[4], 1.0)
    s = np.minimum(gap[:, None] * np.exp(_LN_GAP) / points.amplitude[:, None], 1.0)
    touching = (1.0 - 2.0 / np.pi * (np.arcsin(s) + s * np.sqrt(1.0 - s**2))) @ _GAP_WEIGHTS
    by_ln = (-4.0 / np.pi * s * np.sqrt(1.0 - s**2)) @ _GAP_WEIGHTS
    scale = 1.5 * values[3] ** 2 / _PART_AT_TWICE
    return of_spring(
        points, values[:3], scale * touching,
        scale * (2.0 * touching + by_ln) / values[3],
        scale * by_ln * other / values[4],
    )  # fmt: skip


MECHANISM = Mechanism(
    id="geometric-hardening",
    kind="amplitude",
    sentence="the axis of the {beam} is stretched by its deflection: "
    "frequency rises with A squared",
    parameters=(
        Parameter(
            "alpha", "1/m2", 3e6, 1.5, 1e3, 1e10,
            "a beam held at both ends: about 1/h^2, 1e4, to far more at a laser near a node",
            log=True,
        ),
        Parameter(
            "ratio", "1", 0.5, 1.0, 1e-3, 1e3,
            "another mode over the first: the same stretch by another shape", log=True,
            ratio=True,
        ),
        OWN_LOSS,
    ),
    splitter="higher harmonics of the velocity; the same amplitudes at another {load}",
    curve=cubic,
    form="cubic",
).also(
    "large amplitudes",
    Parameter("bend", "m", 2e-5, 1.2, 1e-8, 1e-1, "amplitude where it gives way", log=True),
    curve=large,
).also(
    "stop",
    Parameter("gap", "m", 5e-6, 1.2, 1e-8, 1e-2, "to a stop on both sides", log=True),
    Parameter(
        "gap_ratio", "1", 0.7, 0.6, 1e-3, 1e3, "another mode over the first, at the sensor",
        log=True, ratio=True,
    ),
    curve=stop,
    starts=tuple(
        (*np.log([3e6, 0.5]).tolist(), OWN_LOSS.start, *np.log([gap, 0.7]).tolist())
        for gap in (1e-6, 2e-5)
    ),
)  # fmt: skip
