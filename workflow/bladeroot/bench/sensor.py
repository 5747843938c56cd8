"""The laser and its converter: noise, slow drift, sixteen bits."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

_STEPS = 2**15 - 1  # of the converter's sixteen bits, to either side


def read_velocity(
    velocity: Float[ndarray, " sample"],
    sampling_hz: float,
    noise: float,
    drift: float,
    top: float,
    full_scale: float,
    chance: np.random.Generator,
) -> tuple[Float[ndarray, " sample"], float]:
    """Velocity (m/s) as recorded, and the size of one converter step.

    `noise` is the rms of the white sensor noise, `drift` the size of a slow wander (a sine of a
    few tenths of a hertz with a random start), both m/s; the signal is cut
    off at +- `top`, readings at +- `full_scale`.
    """
    time = np.arange(velocity.size) / sampling_hz
    wander = np.sin(2 * np.pi * (chance.uniform(0.1, 0.5) * time + chance.uniform()))
    seen = velocity + noise * chance.standard_normal(velocity.size) + drift * wander
    step = full_scale / _STEPS
    highest = min(int(top / step), _STEPS)
    return np.clip(np.round(seen / step), -highest, highest) * step, step
