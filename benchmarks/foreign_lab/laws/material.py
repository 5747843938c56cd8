"""Modulus or density other than the model's."""

import numpy as np

ID, UNIT = "modulus-density", "modulus over the model's, less 1"
SIZES, SIGNED = (0.01, 0.05), True
FORMS = {
    "modulus": lambda r: {},
    "density": lambda r: {},
    "graded": lambda r: {"odd_over_even": float(r.uniform(0.8, 1.2))},
}


def stick(effect, sheet):
    """Both modes alike but for what contact and tension hold; graded along the beam, less so."""
    change = np.full(len(sheet.mode), 0.5 * np.log1p(effect.size))
    if effect.form == "graded":
        change = np.where(sheet.mode == "2B", effect.shape["odd_over_even"], 1.0) * change
    if effect.form != "density":
        for k in range(len(change)):
            kn, kt, force = (sheet.state[name][k] for name in ("ln_kn", "ln_kt", "force"))
            surface = sheet.surface(k)
            rest = sum(2 * surface.slope(axis, kn, kt, force) for axis in (0, 1))
            rest = rest + 2 * force * surface.slope(2, kn, kt, force)
            change[k] *= 1 - rest
    return {"ln_f": change}
