"""An amplifier whose gain falls with the signal, without a visible flat top."""

import numpy as np

ID, UNIT, OUTSIDE = "amplifier-gain", "loss of gain at the start", True
SIZES = (0.05, 0.25)
KIN = ("sensor-gain", "sensor-nonlinearity", "clipping")
FORMS = {"cubic": lambda r: {}, "tanh": lambda r: {}, "slow": lambda r: {}}


def signal(effect, record, rng, t, v):
    """Cubic or tanh in the velocity; or an automatic gain that follows the envelope."""
    top = np.abs(v).max()
    u = v / top
    if effect.form == "cubic":
        return top * (u - effect.size * u**3 * 4 / 3)
    if effect.form == "tanh":
        steep = np.sqrt(3 * effect.size * 4 / 3)
        return top * np.tanh(steep * u) / steep
    length = max(int(6 * np.pi / record.omega / (t[1] - t[0])), 3)
    power = np.convolve(u**2, np.ones(length) / length, mode="same")
    return v * (1 - effect.size * np.minimum(np.sqrt(2 * np.maximum(power, 0.0)), 1.0))
