"""One clamping, or the label of one, is out of line."""

import numpy as np

ID, UNIT, OUTSIDE = "bad-clamping", "ln k of it", True
SIZES, SIGNED = (0.4, 1.2), True
KIN = ("bad-clamping", "unlike-clamping", "unlike-repeats")
FORMS = dict.fromkeys(("contact", "label", "two"), lambda r: {"which": float(r.random())})


def stick(effect, sheet):
    """Another contact, or a load off by much, in one or two clampings."""
    holds = np.unique(sheet.hold)
    first = holds[int(effect.shape["which"] * len(holds))]
    chosen = sheet.hold == first
    if effect.form == "two":
        chosen |= sheet.hold == holds[int((effect.shape["which"] + 0.37) % 1 * len(holds))]
    if effect.form == "label":
        return {"force": (np.exp(0.5 * effect.size) - 1) * chosen * sheet.state["force"]}
    return {"ln_kn": effect.size * chosen, "ln_kt": effect.size * chosen}
