"""The sensor or its amplifier runs out of range at the loud start."""

import numpy as np

ID, UNIT = "clipping", "part of the peak that is cut off"
SIZES = (0.10, 0.4)
FORMS = {
    "hard": lambda r: {},
    "soft": lambda r: {"knee": float(r.uniform(0.05, 0.2))},
    "one-side": lambda r: {},
}


def signal(effect, record, rng, t, v):
    """A level at which it stops, with a knee, or on one side alone; in two records of three."""
    if rng.random() < 1 / 3:
        return v
    level = (1 - effect.size) * np.abs(v).max()
    if effect.form == "soft":
        knee = effect.shape["knee"] * level
        over = np.maximum(np.abs(v) - (level - knee), 0.0)
        return np.sign(v) * (np.minimum(np.abs(v), level - knee) + knee * np.tanh(over / knee))
    return np.clip(v, -np.inf if effect.form == "one-side" else -level, level)
