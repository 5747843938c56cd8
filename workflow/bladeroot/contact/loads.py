"""The axial force that goes with a normal force on a flank (section 6.5)."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

FRICTION_STATES = ("T = 0", "T = mu N")


def axial_per_normal(state: str, friction: float, flank_angle: float) -> float:
    """F_ax / N = 2 (sin theta + (T/N) cos theta) in one of the two limits (section 6.5).

    flank_angle: theta between the flank and the beam's axis, rad. Raises ValueError for a
    state other than "T = 0" and "T = mu N".
    """
    if state not in FRICTION_STATES:
        raise ValueError(f"friction state must be one of {FRICTION_STATES}, got {state!r}")
    ratio = friction if state == "T = mu N" else 0.0
    return 2.0 * (np.sin(flank_angle) + ratio * np.cos(flank_angle))


def axial_force(
    normal_force: Float[ndarray, " force"], state: str, friction: float, flank_angle: float
) -> Float[ndarray, " force"]:
    """F_ax of two flanks of one end under N each, N."""
    return np.asarray(normal_force) * axial_per_normal(state, friction, flank_angle)


def normal_force(
    axial: Float[ndarray, " force"], state: str, friction: float, flank_angle: float
) -> Float[ndarray, " force"]:
    """N on each flank under the axial force `axial`, N."""
    return np.asarray(axial) / axial_per_normal(state, friction, flank_angle)
