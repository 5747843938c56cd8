"""Normal load that varies with the vibration, until flanks part in one half of the cycle."""

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points
from bladeroot.mechanisms.slip_curve import curve, lift_off


def opening(points: Points, values: np.ndarray) -> CurveEffect:
    """Contacts whose preload, a part of the axial force, is exceeded by the vibration."""
    return curve(points, values, lift_off)


MECHANISM = Mechanism(
    id="normal-load-variation",
    kind="amplitude",
    sentence="the vibration unloads the flanks: they part in one half of the cycle",
    parameters=(
        Parameter(
            "share", "1", 0.01, 1.5, 1e-6, 0.5,
            "part of the mode's stiffness that goes through the flanks' normal contact", log=True,
        ),
        Parameter(
            "share_ratio", "1", 1.0, 1.0, 1e-3, 1e3, "other modes over the first",
            log=True,
        ),
        Parameter(
            "threshold", "m/N", 3e-10, 1.5, 1e-14, 1e-6,
            "preload of a flank over its dynamic load, where that is a small part of the nominal",
            log=True,
        ),
        Parameter(
            "threshold_ratio", "1", 0.5, 0.8, 1e-3, 1e3, "other modes over the first",
            log=True,
        ),
        Parameter(
            "spread", "1", 0.6, 0.5, 0.01, 5.0, "preload varies over the flank",
            log=True,
        ),
        Parameter(
            "dissipation", "1", 0.1, 0.4, 0.0, 0.3,
            "loss over lost stiffness: little is dissipated where the flanks part", log=True,
        ),
    ),
    splitter="even harmonics of the velocity: a contact that parts is not symmetric, friction is",
    curve=opening,
    starts=tuple(
        (np.log(share), 0.0, np.log(threshold), np.log(0.5), np.log(0.6), np.log(0.1))
        for share, threshold in ((3e-3, 1e-10), (0.03, 1e-9), (0.1, 1e-8))
    ),
)  # fmt: skip
