"""Frequencies wander with time: warmth, creep, a loosening cable."""

import numpy as np

ID, UNIT = "drift", "peak to peak of ln f over the campaign"
SIZES, SIGNED = (2e-3, 1.2e-2), True
FORMS = {
    "linear": lambda r: {},
    "saturating": lambda r: {"rate": float(r.uniform(2.0, 6.0))},
    "step": lambda r: {"when": float(r.uniform(0.25, 0.75))},
    "periodic": lambda r: {
        "cycles": float(r.uniform(0.7, 3.0)),
        "phase": float(r.uniform(0, 6.28)),
    },
    "temperature": lambda r: {},
}


def course(effect, sheet) -> np.ndarray:
    """Between 0 and 1, or about so."""
    u = sheet.time / max(sheet.planned("time").max(), 1.0)
    if effect.form == "saturating":
        rate = effect.shape["rate"]
        return np.expm1(-rate * u) / np.expm1(-rate)
    if effect.form == "step":
        return (u > effect.shape["when"]).astype(float)
    if effect.form == "periodic":
        return 0.5 * np.sin(2 * np.pi * effect.shape["cycles"] * u + effect.shape["phase"])
    if effect.form == "temperature":
        return sheet.temperature / max(np.ptp(sheet.planned("temperature")), 1e-9)
    return u


def stick(effect, sheet):
    """All modes alike."""
    return {"ln_f": effect.size * course(effect, sheet)}


def measures(effect, sheet):
    """From the first to the last record."""
    shift = stick(effect, sheet)["ln_f"]
    first, last = np.argmin(sheet.time), np.argmax(sheet.time)
    return {"first_to_last": float(shift[last] - shift[first])}
