"""A second line so near that it beats with the mode."""

import numpy as np

ID, UNIT = "mode-beating", "its start over the mode's"
SIZES = (0.05, 0.2)
FORMS = {
    "one": lambda r: {"away": float(r.uniform(0.02, 0.12)), "decay": float(r.uniform(0.5, 2.0))},
    "long-lived": lambda r: {
        "away": float(r.uniform(0.03, 0.12)),
        "decay": float(r.uniform(0.1, 0.4)),
    },
    "two": lambda r: {"away": float(r.uniform(0.03, 0.12)), "decay": float(r.uniform(0.5, 1.5))},
}


def signal(effect, record, rng, t, v):
    """One line or one on either side, each with its own decay."""
    begin = t[np.argmax(np.abs(v) > 0.7 * np.abs(v).max())]
    after, on = np.maximum(t - begin, 0.0), t >= begin
    out = v.copy()
    sides = (1, -1) if effect.form == "two" else (1 if effect.size > 0.08 else -1,)
    for side in sides:
        omega = record.omega * (1 + side * effect.shape["away"])
        rate = 0.5 * effect.shape["decay"] * record.at("eta") * omega
        phase = rng.uniform(0, 2 * np.pi)
        size = effect.size * np.abs(v).max() / len(sides)
        out = out + on * size * np.exp(-rate * after) * np.cos(omega * after + phase)
    return out
