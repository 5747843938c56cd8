"""Lines of the mains in the velocity."""

import numpy as np

ID, UNIT = "mains-hum", "m/s"
SIZES = (2e-4, 1.5e-3)
FORMS = {
    "line": lambda r: {"f": float(r.choice([50.0, 60.0, 150.0, 100.0]))},
    "comb": lambda r: {"f": float(r.choice([50.0, 60.0]))},
    "rectifier": lambda r: {"f": float(r.choice([50.0, 60.0]))},
}


def signal(effect, record, rng, t, v):
    """A line, the line with odd harmonics, or pulses twice a period; a grid off by up to 0.05 %."""
    f = effect.shape["f"] * (1 + 3e-4 * rng.uniform(-1, 1))
    phase = 2 * np.pi * f * t + rng.uniform(0, 2 * np.pi)
    if effect.form == "comb":
        return v + effect.size * (np.cos(phase) + 0.4 * np.cos(3 * phase) + 0.2 * np.cos(5 * phase))
    if effect.form == "rectifier":
        return v + effect.size * 2 * (np.abs(np.cos(phase)) - 2 / np.pi)
    return v + effect.size * np.cos(phase)
