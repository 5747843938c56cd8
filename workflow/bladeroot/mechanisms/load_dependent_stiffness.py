"""Contact stiffness that grows with the normal load by a power."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect

REFERENCE_FORCE = 12e3  # N


def stick(records: Records, values: np.ndarray) -> StickEffect:
    """ln k grows by exponent * ln(F / 12 kN); kt's exponent differs from kn's."""
    x = np.log(records.force / REFERENCE_FORCE)
    exponent, difference = values
    return StickEffect(
        {"ln_kn": (exponent - 0.5 * difference) * x, "ln_kt": (exponent + 0.5 * difference) * x},
        {"ln_kn": np.stack([x, -0.5 * x], axis=1), "ln_kt": np.stack([x, 0.5 * x], axis=1)},
    )


MECHANISM = Mechanism(
    id="load-dependent-stiffness",
    kind="force-law",
    sentence="the contact stiffens with the axial force by a power, as rough surfaces do",
    parameters=(
        Parameter(
            "exponent", "1", 0.3, 0.4, 0.0, 1.2,
            "smooth contact 0.05 (6.16), rough contact 1; Table 5.2 has 0.65 and 0.47",
        ),
        Parameter(
            "exponent_difference", "1", 0.0, 0.1, -0.6, 0.6,
            "kt less kn; Table 5.2 has -0.18, elastic theory 0",
        ),
    ),
    splitter="forces twice as high, where a power goes on and a seated contact does not",
    stick=stick,
)  # fmt: skip
