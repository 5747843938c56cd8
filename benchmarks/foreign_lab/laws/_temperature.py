"""Warmth: a modulus that falls, a rig that stretches the beam, a contact that softens."""

import numpy as np

ID, UNIT = "temperature", "ln f per kelvin about the mean"
SIZES, SIGNED = (1.5e-4, 8e-4), True
FORMS = {
    "modulus": lambda r: {"debye": float(r.uniform(250.0, 500.0))},
    "stretch": lambda r: {},
    "contact": lambda r: {"kt_over_kn": float(r.uniform(0.5, 1.5))},
}
ROOM = 294.0  # K


def stick(effect, sheet):
    """By what is warmed; the size is what 1B does at the middle load."""
    warm = sheet.temperature - sheet.planned("temperature").mean()
    surface = sheet.specimen.surfaces["1B"]
    point = (sheet.specimen.ln_kn, sheet.specimen.ln_kt, sheet.reference)
    if effect.form == "stretch":
        newtons = effect.size / (surface.slope(2, *point))
        return {"force": newtons * warm}
    if effect.form == "contact":
        ratio = effect.shape["kt_over_kn"]
        change = effect.size / (surface.slope(0, *point) + ratio * surface.slope(1, *point)) * warm
        return {"ln_kn": change, "ln_kt": ratio * change}
    # a modulus by the solid's heat, E = E0 - b T exp(-T0 / T), scaled to the size at room
    rise, room = (t * np.exp(-effect.shape["debye"] / t) for t in (ROOM + warm, ROOM))
    slope = (1 + effect.shape["debye"] / ROOM) * np.exp(-effect.shape["debye"] / ROOM)
    return {"ln_f": 0.5 * np.log1p(2 * effect.size * (rise - room) / slope)}


def measures(effect, sheet):
    """Per kelvin."""
    return {"per_kelvin": effect.size}
