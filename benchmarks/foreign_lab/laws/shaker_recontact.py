"""The shaker touches the beam again after it has let go."""

import numpy as np

ID, UNIT = "shaker-recontact", "step of the velocity over the amplitude"
SIZES = (0.10, 0.4)
FORMS = {
    "blow": lambda r: {},
    "gradual": lambda r: {"cycles": float(r.uniform(1.0, 4.0))},
    "bounces": lambda r: {"count": int(r.integers(2, 5))},
}


def signal(effect, record, rng, t, v):
    """Another free motion of the same mode begins during the decay; in two records of three."""
    loud = np.flatnonzero(np.abs(v) > 0.3 * np.abs(v).max())
    quiet = np.flatnonzero(np.abs(v) > 0.05 * np.abs(v).max())
    if rng.random() < 1 / 3 or not len(loud):
        return v
    omega = record.omega
    out = v.copy()
    count = effect.shape.get("count", 1)
    first = rng.uniform(t[loud[-1]], 0.4 * t[loud[-1]] + 0.6 * t[quiet[-1]])
    for k in range(count):
        when = first + k * rng.uniform(5, 20) * 2 * np.pi / omega
        near = np.abs(t - when) < 4 * np.pi / omega
        if not near.any():
            break
        size = effect.size * np.abs(v[near]).max() * 0.6**k
        after = np.maximum(t - when, 0.0)
        blend = (t >= when).astype(float)
        if effect.form == "gradual":
            blend = -np.expm1(-after * omega / (2 * np.pi * effect.shape["cycles"]))
        decay = np.exp(-0.5 * record.at("eta") * omega * after)
        out = out + size * blend * decay * np.sin(omega * after + rng.uniform(0, 2 * np.pi))
    return out
