"""Part of the records comes from a recorder whose clock is off."""

import numpy as np

ID, UNIT, OUTSIDE = "sampling-clock", "error of the clock", True
SIZES, SIGNED = (2e-3, 1.5e-2), True
KIN = ("group-effect", "clock-error", "sampling-rate", "operator-group")
FORMS = {"group": lambda r: {}, "one-mode": lambda r: {}, "every-third": lambda r: {}}


def stick(effect, sheet):
    """One operator's recorder, the one used for 2B, or every third record's."""
    chosen = {
        "group": sheet.group == 1,
        "one-mode": (sheet.mode == "2B") & (sheet.group == 1),
        "every-third": np.arange(len(sheet.mode)) % 3 == 0,
    }[effect.form]
    return {"ln_f": effect.size * chosen}
