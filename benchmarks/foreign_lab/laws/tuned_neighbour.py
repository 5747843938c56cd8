"""A cable or cover that comes into tune with 1B near one load and draws its line."""

import numpy as np

ID, UNIT, OUTSIDE = (
    "tuned-neighbour",
    "coupling: half the least distance of the lines, relative",
    True,
)
SIZES = (2e-3, 1e-2)
KIN = ("mode-coupling", "tuned-neighbour", "mode-beating")
FORMS = {"absorber": lambda r: {"at": float(r.uniform(0.2, 0.8))},
         "lossy": lambda r: {"at": float(r.uniform(0.2, 0.8))},
         "2B": lambda r: {"at": float(r.uniform(0.2, 0.8))}}  # fmt: skip


def stick(effect, sheet):
    """Veering: the stronger of two coupled lines."""
    mode = "2B" if effect.form == "2B" else "1B"
    mine = sheet.mode == mode
    f = sheet.ln_frequency()
    if not mine.any():
        return {}
    tune = np.quantile(f[mine], effect.shape["at"])
    half = (f - tune) / 2
    shift = np.where(half >= 0, 1.0, -1.0) * (np.hypot(half, effect.size) - np.abs(half))
    share = 0.5 * (1 - np.abs(half) / np.hypot(half, effect.size))
    lossy = 3.0 if effect.form == "lossy" else 1.0
    return {"ln_f": shift * mine, "ln_eta": np.log1p(lossy * share) * mine}
