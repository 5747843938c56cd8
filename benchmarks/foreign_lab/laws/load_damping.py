"""The stuck joint's loss depends on the load."""

import numpy as np

ID, UNIT, OUTSIDE = "load-dependent-damping", "-d ln eta / d ln F", True
SIZES = (0.1, 0.5)
KIN = ("load-dependent-damping", "force-dependent-damping")
FORMS = {"power": lambda r: {}, "floor": lambda r: {}, "one-mode": lambda r: {}}


def stick(effect, sheet):
    """Falling with the load, to a floor, or in 1B alone."""
    load = np.maximum(sheet.state["force"] / sheet.reference, 0.02)
    change = -effect.size * np.log(load)
    if effect.form == "floor":
        change = np.log((1 + 2 * effect.size / load) / (1 + 2 * effect.size))
    if effect.form == "one-mode":
        change = change * (sheet.mode == "1B")
    return {"ln_eta": change}
