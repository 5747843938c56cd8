"""The beam stretches as it bends: the frequency rises with amplitude."""

import numpy as np

ID, UNIT = "geometric-hardening", "rise of ln f of 1B at its usual start"
SIZES = (3e-4, 5e-3)
FORMS = {
    "cubic": lambda r: {},
    "large": lambda r: {"bend": float(r.uniform(0.3, 1.5))},
    "stop": lambda r: {"gap": float(r.uniform(0.2, 0.5))},
}


def curve(effect, record, x):
    """Cubic in the force; levelling off at large amplitude; or from where a clearance closes."""
    sheet = record.sheet
    start = sheet.usual_start("1B")
    first = sheet.specimen.surfaces["1B"]
    point = (sheet.specimen.ln_kn, sheet.specimen.ln_kt, sheet.reference)

    def stretch(surface):
        """(Change of omega^2 by tension)^2 times modal mass: the quartic part of the energy."""
        omega2 = np.exp(2 * surface.ln_frequency(*point))
        return (omega2 * surface.slope(2, *point)) ** 2 * surface.modal_mass / omega2

    u = x / start
    scale = effect.size * float(stretch(record.surface) / stretch(first))
    if effect.form == "large":
        rise = u**2 / (1 + effect.shape["bend"] * u**2) * (1 + effect.shape["bend"])
    elif effect.form == "stop":
        gap = effect.shape["gap"]
        rise = np.maximum(u - gap, 0.0) ** 2 / (1 - gap) ** 2
    else:
        rise = u**2
    change = scale * rise
    return {"ln_f": change, "odd": change / 12.0}
