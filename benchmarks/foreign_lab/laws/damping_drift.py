"""All losses change in the course of the campaign."""

import numpy as np

ID, UNIT, OUTSIDE = "damping-drift", "ln of the loss factor from first to last", True
SIZES, SIGNED = (0.1, 0.5), True
KIN = ("damping-drift",)
FORMS = {"linear": lambda r: {}, "step": lambda r: {}, "temperature": lambda r: {}}


def stick(effect, sheet):
    """Damping alone."""
    u = sheet.time / max(sheet.planned("time").max(), 1.0)
    if effect.form == "step":
        u = (u > 0.5).astype(float)
    if effect.form == "temperature":
        u = sheet.temperature / max(np.ptp(sheet.planned("temperature")), 1e-9)
    return {"ln_eta": effect.size * u}
