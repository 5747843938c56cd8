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


def stick(effect, sheet):
    """One gain, one that grows with the load, or another in the gauge's low range."""
    part = sheet.reading / sheet.planned("reading").max()
    gain = np.full(len(part), effect.size)
    if effect.form == "curved":
        gain = effect.size * (1 + effect.shape["bend"] * (part - 1))
    if effect.form == "two-ranges":
        gain = np.where(
            part < effect.shape["change"], effect.shape["low"] * effect.size, effect.size
        )
    return {"force": gain * sheet.reading}


def measures(effect, sheet):
    """The mean gain over the records."""
    return {"gain": float((stick(effect, sheet)["force"] / sheet.reading).mean())}
