"""Normal load that varies with the vibration, until flanks part in one half of the cycle."""

import numpy as np

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Parameter, Points
from bladeroot.mechanisms.slip_curve import (
    Spread,
    curve,
    lift_off,
    lognormal,
    parameters,
    power,
    starts,
)


def law(spread: Spread):
    """The hook of contacts whose preload, a part of the axial force, the vibration exceeds."""

    def opening(points: Points, values: np.ndarray) -> CurveEffect:
        return curve(points, values, lift_off, spread)

    return opening


SPREAD = Parameter("spread", "1", 0.6, 0.6, 0.01, 5.0, "preload varies over the flank", log=True)
RUNNING_OUT = (
    Parameter(
        "steepness", "1", 0.0, 0.6, -0.9, 2.0,
        "power of the density of preloads down to none, as towards a contact's edge", bounded=True,
    ),
    Parameter(
        "at_once", "1", 0.3, 1.2, 0.0, 1.0, "part of the flank under an even preload", bounded=True
    ),
)  # fmt: skip
MECHANISM = Mechanism(
    id="normal-load-variation",
    kind="amplitude",
    sentence="the vibration unloads the {flanks}: they part in one half of the cycle",
    parameters=(
        *parameters(
            "normal",
            "part of the mode's stiffness that goes through the flanks' normal contact, in a "
            "simulation at most the normal contact springs'",
            "at 12 kN: preload of a flank over its dynamic load, where that is a small part of the "
            "nominal",
            "other modes over the first",
            "preload over the axial force; an opening whatever the force is none of a flank",
        ),
        Parameter(
            "dissipation", "1", 0.03, 0.8, 0.0, 0.1,
            "loss over lost stiffness: a coefficient of restitution of 0.6 and more loses at most "
            "0.1 of the contact's energy a radian", bounded=True,
        ),
        SPREAD,
    ),
    splitter="even harmonics of the velocity: a contact that parts is not symmetric, friction is",
    curve=law(lognormal),
    starts=starts(-0.75, SPREAD.start),
    form="lognormal preloads",
).also(
    "preload that runs out", *RUNNING_OUT, keep=6, curve=law(power),
    starts=starts(-0.75, *(p.start for p in RUNNING_OUT)),
)  # fmt: skip
