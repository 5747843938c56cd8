"""A clamping loses force while it stands; the gauge is read when it is made."""

import numpy as np

ID, UNIT = "force-relaxation", "part of the force lost a decade of time, at ten minutes"
SIZES = (5e-3, 5e-2)
FORMS = {
    "logarithmic": lambda r: {},
    "power": lambda r: {"power": float(r.uniform(0.15, 0.5))},
    "stretched": lambda r: {"rate": float(np.exp(r.uniform(np.log(300), np.log(3000)))),
                            "stretch": float(r.uniform(0.4, 0.8))},
}  # fmt: skip


def lost(form: str, shape: dict, seconds: np.ndarray) -> np.ndarray:
    """Part of the force lost, in units of the size; its slope by log10 t at 600 s is 1."""
    t = np.maximum(seconds, 1.0)
    if form == "power":
        p = shape["power"]
        return ((t / 600) ** p - (60 / 600) ** p) / (p * np.log(10))
    if form == "stretched":
        rate, b = shape["rate"], shape["stretch"]
        z = (600 / rate) ** b
        return -np.expm1(-((t / rate) ** b)) / (b * z * np.exp(-z) * np.log(10))
    return np.log10(np.maximum(t, 60) / 60)


def stick(effect, sheet):
    """The loss since the clamping was made."""
    part = effect.size * lost(effect.form, effect.shape, sheet.in_hold)
    return {"force": -np.minimum(part, 0.5) * sheet.state["force"]}
