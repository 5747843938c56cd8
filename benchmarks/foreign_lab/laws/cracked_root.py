"""A crack at the root that the load opens: stiffness falls with load and with amplitude."""

import numpy as np

ID, UNIT, OUTSIDE = "cracked-root", "fall of ln f when wide open", True
SIZES = (2e-3, 1e-2)
KIN = ("cracked-root", "crack")
FORMS = {
    "opens": lambda r: {"at": float(r.uniform(0.6, 1.6)), "wide": float(r.uniform(0.2, 0.6))},
    "grows": lambda r: {},
    "breathes": lambda r: {"at": float(r.uniform(0.1, 0.5))},
}


def stick(effect, sheet):
    """Opened by the load, or growing with the clampings."""
    load = sheet.state["force"] / sheet.reference
    sizes = effect.size * np.where(sheet.mode == "2B", 0.7, 1.0)
    if effect.form == "opens":
        return {"ln_f": -sizes / (1 + np.exp((effect.shape["at"] - load) / effect.shape["wide"]))}
    if effect.form == "grows":
        return {"ln_f": -sizes * (sheet.clamped / max(sheet.planned("clamped").max(), 1)) ** 2}
    return {"ln_f": np.zeros(len(load))}


def curve(effect, record, x):
    """Breathing: half open from an amplitude on, with even harmonics."""
    if effect.form != "breathes":
        return {}
    u = x / (effect.shape["at"] * record.at("start"))
    fall = effect.size / 2 * u**2 / (1 + u**2)
    return {"ln_f": -fall, "even": fall}
