"""Friction in the cylinder: the true force lags behind the gauge's, the other way going down."""

import numpy as np

ID, UNIT, OUTSIDE = "gauge-friction", "friction over the force", True
SIZES = (0.06, 0.25)
KIN = ("gauge-friction",)
FORMS = {"proportional": lambda r: {}, "constant": lambda r: {}, "turning-point": lambda r: {}}


def stick(effect, sheet):
    """Less going up, more coming down."""
    side = -sheet.direction.astype(float)
    if effect.form == "constant":
        return {
            "force": np.maximum(side * effect.size * sheet.reference, 300 - sheet.state["force"])
        }
    if effect.form == "turning-point":
        way = np.abs(sheet.turning - sheet.reading) / max(np.ptp(sheet.planned("reading")), 1.0)
        side = np.where(sheet.direction < 0, 1 - 2 * np.exp(-way / 0.15), -1.0)
    return {"force": side * effect.size * sheet.state["force"]}
