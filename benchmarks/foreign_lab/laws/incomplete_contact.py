"""At small loads only a part of the flanks is seated."""

import numpy as np

ID, UNIT = "incomplete-contact", "force (N) at which 1 - 1/e of the flank is seated"
SIZES = (2500.0, 9000.0)
FORMS = {
    "exponential": lambda r: {},
    "logistic": lambda r: {"steep": float(r.uniform(2.0, 4.0))},
    "threshold": lambda r: {"least": float(r.uniform(0.1, 0.4))},
    "weibull": lambda r: {"power": float(r.uniform(0.7, 2.0))},
}


def seated(form: str, shape: dict, size: float, force: np.ndarray) -> np.ndarray:
    """Part of the flank in contact."""
    u = np.maximum(force, 1.0) / size
    if form == "logistic":
        steep = shape["steep"]
        return 1.0 / (1.0 + (np.e - 1) ** -1 * u**-steep)
    if form == "threshold":
        least = shape["least"]
        return np.minimum(least + (1 - 1 / np.e - least) * u, 1.0)
    return -np.expm1(-(u ** shape.get("power", 1.0)))


def stick(effect, sheet):
    """Both stiffnesses in proportion to the contact's part."""
    part = seated(effect.form, effect.shape, effect.size, sheet.state["force"])
    change = np.log(np.maximum(part, 0.05))
    return {"ln_kn": change, "ln_kt": change}
