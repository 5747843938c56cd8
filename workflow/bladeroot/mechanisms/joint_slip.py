"""Friction at the flanks: beyond a threshold amplitude the joint slips, softens and damps."""

from dataclasses import replace

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points
from bladeroot.mechanisms.slip_curve import (
    PLACES,
    Spread,
    curve,
    free,
    lognormal,
    parameters,
    power,
    rounded,
    starts,
)
from bladeroot.mechanisms.slip_curve import coulomb as element

SHARED = parameters(
    "tangential",
    "part of the mode's stiffness that goes through the flanks' friction, in a simulation at most "
    "the tangential contact springs'",
    "at 12 kN; sliding of a whole flank begins at 130 um at 4 kN with a friction of 0.42, the "
    "thesis sees 2 um",
    "other modes over the first: slip per unit of the sensor's amplitude",
    "friction's limit over the axial force, 1; displacement of a rounded contact 2/3",
)
SPREAD = Parameter(
    "spread", "1", 0.6, 0.6, 0.01, 5.0, "pressure varies over the flank: edges slip first", log=True
)


def law(spread: Spread):
    """The hook of Coulomb sliders with a distribution of thresholds.

    Their loss is what they dissipate: the sixth value of `curve` is 1, and no parameter.
    """

    def slip(points: Points, values: np.ndarray) -> CurveEffect:
        effect = curve(points, np.insert(values, 5, 1.0), element, spread)
        own = np.arange(values.size + 1) != 5
        return replace(
            effect, ln_f_slope=effect.ln_f_slope[:, own], loss_slope=effect.loss_slope[:, own]
        )

    return slip


MECHANISM = Mechanism(
    id="joint-slip",
    kind="amplitude",
    sentence="the {flanks} slip: above a threshold that grows with the {force}, "
    "softer and more damped",
    parameters=(*SHARED, SPREAD),
    splitter="the same amplitudes at twice the {load}: a friction threshold doubles",
    curve=law(lognormal),
    starts=starts(SPREAD.start),
    form="lognormal thresholds",
)
for _form, _spread, _own in (
    (
        "Iwan", power,
        (
            Parameter(
                "steepness", "1", -0.4, 0.6, -0.99, 0.5,
                "power of the density of thresholds: lap joints -0.2 to -0.7 (Segalman 2005)",
                bounded=True,
            ),
            Parameter(
                "at_once", "1", 0.3, 1.2, 0.0, 1.0,
                "part of the sliders that give way together, at macroslip", bounded=True,
            ),
        ),
    ),
    (
        "Cattaneo-Mindlin", rounded,
        (
            Parameter(
                "roundness", "1", 0.5, 0.25, 0.2, 2.0,
                "sphere on plane 1/2, cylinder near 1 for small forces", log=True,
            ),
        ),
    ),
    (
        "free thresholds", free,
        tuple(
            Parameter(
                f"weight_{k + 1}", "1", float(-0.15 * place**2), 1.0, -20.0, 20.0,
                "ln of the density of thresholds, up to a constant",
            )
            for k, place in enumerate(PLACES)
        ),
    ),
):  # fmt: skip
    MECHANISM = MECHANISM.also(
        _form, *_own, keep=len(SHARED), curve=law(_spread), starts=starts(*(p.start for p in _own))
    )
