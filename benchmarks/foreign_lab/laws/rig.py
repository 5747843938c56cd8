"""The slots stand softer than the model's."""

import numpy as np

ID, UNIT = "rig-compliance", "compliance in series with each flank, of the contact's own"
SIZES = (0.05, 0.6)
FORMS = {
    "jaws": lambda r: {"normal": 1.0},
    "base": lambda r: {"normal": float(r.uniform(1.5, 3.0))},
    "slide": lambda r: {"normal": float(r.uniform(0.1, 0.5))},
}


def stick(effect, sheet):
    """Springs in series with the flanks'."""
    kn = np.exp(sheet.state["ln_kn"] - sheet.specimen.ln_kn)
    kt = np.exp(sheet.state["ln_kt"] - sheet.specimen.ln_kt)
    return {
        "ln_kn": -np.log1p(effect.size * effect.shape["normal"] * kn),
        "ln_kt": -np.log1p(effect.size * kt),
    }
