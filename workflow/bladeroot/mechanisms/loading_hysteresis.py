"""Contact stiffness that depends on whether the force was reached from below or from above."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def stick(records: Records, values: np.ndarray) -> StickEffect:
    """kn and kt are stiffer by a half of `difference` when unloading, softer when loading."""
    half = -0.5 * records.sign
    slope = half[:, None]
    return StickEffect(
        {"ln_kn": values[0] * half, "ln_kt": values[0] * half}, {"ln_kn": slope, "ln_kt": slope}
    )


MECHANISM = Mechanism(
    id="loading-hysteresis",
    kind="direction",
    sentence="the contact is stiffer when the force is reached from above than from below",
    parameters=(
        Parameter(
            "difference", "1", 0.0, 0.3, -0.8, 0.8,
            "friction keeps a wedged flank in contact as the load falls; (3.21) averages over it",
        ),
    ),
    splitter="a loading cycle that turns back half-way",
    stick=stick,
    over=("sign", "force"),
)  # fmt: skip
