"""A loose mount: the sensor rattles and adds what is no motion of the beam."""

import numpy as np

ID, UNIT, OUTSIDE = "loose-sensor", "rattle over the velocity", True
SIZES = (0.03, 0.2)
KIN = ("loose-sensor", "mode-beating", "shaker-recontact", "clipping")
FORMS = {
    "clicks": lambda r: {},
    "even": lambda r: {},
    "lag": lambda r: {"from": float(r.uniform(0.1, 0.4))},
}


def signal(effect, record, rng, t, v):
    """Clicks at the peaks, the square of the velocity, or a lag beyond an amplitude."""
    top = np.abs(v).max()
    u = v / top
    if effect.form == "clicks":
        hit = (u > 0.35) & (rng.random(len(u)) < 0.15)
        return v + top * effect.size * hit * u * rng.normal(size=len(u))
    if effect.form == "even":
        return v + top * effect.size * u**2
    over = np.maximum(np.abs(u) - effect.shape["from"], 0.0)
    return v - top * effect.size * np.gradient(u) * over * 4
