"""Friction at the flanks: beyond a threshold amplitude the joint slips, softens and damps."""

from dataclasses import replace

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points
from bladeroot.mechanisms.slip_curve import coulomb, curve


def slip(points: Points, values: np.ndarray) -> CurveEffect:
    """Coulomb sliders; thresholds rise in proportion to the axial force."""
    effect = curve(points, np.append(values, 1.0), coulomb)
    return replace(
        effect, ln_f_slope=effect.ln_f_slope[:, :-1], loss_slope=effect.loss_slope[:, :-1]
    )


MECHANISM = Mechanism(
    id="joint-slip",
    kind="amplitude",
    sentence="the flanks slip: above a threshold that grows with the force, softer and more damped",
    parameters=(
        Parameter(
            "share", "1", 0.01, 1.5, 1e-6, 0.5,
            "part of the mode's stiffness that goes through the flanks' friction", log=True,
        ),
        Parameter(
            "share_ratio", "1", 1.0, 1.0, 1e-3, 1e3, "other modes over the first",
            log=True,
        ),
        Parameter(
            "threshold", "m/N", 3e-10, 1.5, 1e-14, 1e-6,
            "sliding of a whole flank begins at 130 um at 4 kN with a friction of 0.42, "
            "the thesis sees 2 um", log=True,
        ),
        Parameter(
            "threshold_ratio", "1", 0.5, 0.8, 1e-3, 1e3,
            "other modes over the first: slip per unit of the sensor's amplitude",
            log=True,
        ),
        Parameter(
            "spread", "1", 0.6, 0.5, 0.01, 5.0,
            "pressure varies over the flank: edges slip first", log=True,
        ),
    ),
    splitter="the same amplitudes at twice the axial force: a friction threshold doubles",
    curve=slip,
    starts=tuple(
        (np.log(share), 0.0, np.log(threshold), np.log(0.5), np.log(0.6))
        for share, threshold in ((3e-3, 1e-10), (0.03, 1e-9), (0.1, 1e-8))
    ),
)  # fmt: skip
