"""The flanks wear with every clamping: the tangential stiffness ages."""

import numpy as np

ID, UNIT, OUTSIDE = "ageing", "ln kt from first to last clamping", True
SIZES, SIGNED = (0.15, 0.8), True
KIN = ("ageing", "kt-ageing", "wear")
FORMS = {
    "logarithmic": lambda r: {},
    "linear": lambda r: {},
    "both": lambda r: {},
}


def stick(effect, sheet):
    """By the number of clampings, not by time."""
    u = sheet.clamped / max(sheet.planned("clamped").max(), 1)
    course = np.log1p(20 * u) / np.log(21) if effect.form == "logarithmic" else u
    change = effect.size * course
    return {"ln_kn": change, "ln_kt": change} if effect.form == "both" else {"ln_kt": change}
