"""The gauge shows another force than there is, in proportion."""

import numpy as np

ID, UNIT = "force-gain", "true force over the gauge's at full load, less 1"
SIZES, SIGNED = (0.08, 0.35), True
FORMS = {
    "constant": lambda r: {},
    "curved": lambda r: {"bend": float(r.uniform(0.2, 0.6))},
    "two-ranges": lambda r: {
        "change": float(r.uniform(0.3, 0.5)),
        "low": float(r.uniform(0.7, 1.3)),
    },
}


def gain(effect, sheet, reading):
    """One gain, one that grows with the load, or another in the gauge's low range."""
    part = reading / sheet.planned("reading").max()
    same = np.full(np.shape(part), effect.size)
    if effect.form == "curved":
        return effect.size * (1 + effect.shape["bend"] * (part - 1))
    if effect.form == "two-ranges":
        return np.where(part < effect.shape["change"], effect.shape["low"] * same, same)
    return same


def stick(effect, sheet):
    """The part of the reading that the gain is."""
    return {"force": gain(effect, sheet, sheet.reading) * sheet.reading}


def measures(effect, sheet):
    """The gain at 12 kN, where the product states it."""
    return {"gain": float(gain(effect, sheet, 12e3))}
