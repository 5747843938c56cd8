"""Air or oil resists with more than the velocity's first power: damping grows with amplitude."""

import numpy as np

ID, UNIT = "quadratic-drag", "rise of the loss factor of 1B at its usual start"
SIZES = (1e-3, 6e-3)
FORMS = {
    "square": lambda r: {"power": 1.0},
    "power": lambda r: {"power": float(r.uniform(0.6, 1.5))},
    "onset": lambda r: {"power": 1.0, "onset": float(r.uniform(0.1, 0.4))},
}


def curve(effect, record, x):
    """A power of the amplitude, from a threshold on where vortices shed."""
    sheet = record.sheet
    start = sheet.usual_start("1B")
    first = sheet.specimen.surfaces["1B"].modal_mass
    onset = effect.shape.get("onset", 0.0)
    u = np.maximum(x / start - onset, 0.0) / (1 - onset)
    # the same body moves the same air; modal masses at the laser are alike but for that
    rise = effect.size * first / record.surface.modal_mass * u ** effect.shape["power"]
    return {"eta": rise, "odd": rise / 16.0}
