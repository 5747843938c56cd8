"""Going up and coming down the contact is another one; both are one where the loading turns."""

import numpy as np

ID, UNIT = "loading-hysteresis", "largest difference of ln k, down less up"
SIZES, SIGNED = (0.10, 0.5), True
FORMS = {
    "constant": lambda r: {},
    "turning-point": lambda r: {"length": float(r.uniform(0.1, 0.35))},
    "lens": lambda r: {},
    "kt-alone": lambda r: {"length": float(r.uniform(0.1, 0.35))},
}


def stick(effect, sheet):
    """Half of it to each side."""
    loads = sheet.planned("reading")
    top, bottom = loads.max(), loads.min()
    way = (sheet.turning - sheet.reading) / max(top - bottom, 1.0)
    half = -0.5 * effect.size * sheet.direction * np.ones(len(way))
    if effect.form in ("turning-point", "kt-alone"):
        # the memory of the turning point fades with the distance from it
        half = (
            0.5
            * effect.size
            * np.where(
                sheet.direction < 0, 2 * -np.expm1(-np.abs(way) / effect.shape["length"]) - 1, -1.0
            )
        )
    if effect.form == "lens":
        u = (sheet.reading - bottom) / max(top - bottom, 1.0)
        half = half * 4 * u * (1 - u)
    return {"ln_kt": half} if effect.form == "kt-alone" else {"ln_kn": half, "ln_kt": half}
