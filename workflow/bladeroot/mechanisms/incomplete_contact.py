"""Contact that is not full below a seating force."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def stick(records: Records, values: np.ndarray) -> StickEffect:
    """kn and kt have the share (1 - exp(-(F/Fs)^q))^(1/q): F/Fs far below Fs, 1 far above."""
    seating, sharpness = values
    ln_ratio = np.clip(np.log(records.force / seating), -7.0, 7.0)
    power = np.exp(np.minimum(sharpness * ln_ratio, 6.0))
    touching = -np.expm1(-power)
    share = np.log(touching) / sharpness
    growing = power * np.exp(-power) / touching  # d ln(touching) / d ln(power)
    slope = np.stack([-growing / seating, (growing * ln_ratio - share) / sharpness], axis=1)
    return StickEffect({"ln_kn": share, "ln_kt": share}, {"ln_kn": slope, "ln_kt": slope})


MECHANISM = Mechanism(
    id="incomplete-contact",
    kind="force-law",
    sentence="at low axial force the flanks touch on a part of their area only",
    parameters=(
        Parameter(
            "seating_force", "N", 4e3, 0.8, 300.0, 30e3,
            "63 % of a flank touch there; section 5.2: not all of it below 12 kN", log=True,
        ),
        Parameter(
            "sharpness", "1", 1.0, 0.3, 0.3, 5.0,
            "a gap that is used up at a constant rate 1, one that closes at once above 3",
            log=True,
        ),
    ),
    splitter="stick frequencies at more forces, below the seating force and far above it; "
    "pressure-sensitive film",
    stick=stick,
    starts=((float(np.log(9e3)), 0.0),),
)  # fmt: skip
