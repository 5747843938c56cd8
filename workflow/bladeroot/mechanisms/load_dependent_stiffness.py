"""Contact stiffness that grows with the normal load and does not stop growing."""

import numpy as np

from bladeroot.mechanisms.mechanism import (
    REFERENCE_FORCE,
    Mechanism,
    Parameter,
    Records,
    StickEffect,
)

_LEAST_COMPLIANCE = 0.05  # over that at 12 kN
_DIFFERENCE = Parameter(
    "exponent_difference", "1", 0.0, 0.1, -0.6, 0.6, "kt less kn; Table 5.2 has -0.18, theory 0"
)


def power(records: Records, values: np.ndarray) -> StickEffect:
    """ln k grows by exponent * ln(F / 12 kN); kt's exponent differs from kn's."""
    x = np.log(records.force / REFERENCE_FORCE)
    return _effect(x, values[0] * x, x, values[1])


def series(records: Records, values: np.ndarray) -> StickEffect:
    """A layer, whose stiffness is as a power of the force, in series with the bulk.

    Of the compliance at 12 kN the layer has the part exponent / power: `exponent` is the slope of
    ln k there.
    """
    exponent, difference, power = values
    x = np.log(records.force / REFERENCE_FORCE)
    ratio = np.exp(-power * x)
    part = exponent / power
    plain = 1.0 + part * (ratio - 1.0)
    soft = np.maximum(plain, _LEAST_COMPLIANCE)
    free = np.where(plain > _LEAST_COMPLIANCE, 1.0 / soft, 0.0)
    by_power = free * part * ((ratio - 1.0) / power + ratio * x)
    return _effect(x, -np.log(soft), -free * (ratio - 1.0) / power, difference, by_power)


def _effect(
    x: np.ndarray, growth: np.ndarray, slope: np.ndarray, difference: float, *others: np.ndarray
) -> StickEffect:
    half = 0.5 * x
    return StickEffect(
        {"ln_kn": growth - difference * half, "ln_kt": growth + difference * half},
        {
            "ln_kn": np.stack([slope, -half, *others], axis=1),
            "ln_kt": np.stack([slope, half, *others], axis=1),
        },
    )


MECHANISM = Mechanism(
    id="load-dependent-stiffness",
    kind="force-law",
    sentence="the contact stiffens with the {load}, as rough or rounded surfaces do",
    parameters=(
        Parameter(
            "exponent", "1", 0.3, 0.4, 0.0, 1.2,
            "smooth contact 0.05 (6.16), spheres 1/3 (Hertz), rough contact 1; Table 5.2 has 0.65 "
            "and 0.47",
        ),
        _DIFFERENCE,
    ),
    splitter="{forces} twice as high, where a power goes on and a seated contact does not",
    stick=power,
    form="power",
).also(
    "layer in series with the bulk",
    Parameter(
        "exponent", "1", 0.3, 1.2, 0.0, 1.0,
        "slope of ln k at 12 kN: the layer's part of the compliance times its power", bounded=True,
    ),
    _DIFFERENCE,
    Parameter(
        "power", "1", 0.9, 0.4, 0.2, 4.0,
        "of the layer's stiffness over the force: spheres 1/3, rough surfaces 1, a gap that closes "
        "at once more", log=True,
    ),
    keep=0, stick=series,
)  # fmt: skip
