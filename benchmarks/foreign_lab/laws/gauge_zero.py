"""The gauge's zero is off."""

import numpy as np

ID, UNIT = "force-offset", "true force less the gauge's, N"
SIZES, SIGNED = (1500.0, 6000.0), True
FORMS = {
    "constant": lambda r: {},
    "warming-up": lambda r: {"part": float(r.uniform(0.1, 0.3))},
    "dead-weight": lambda r: {},
}


def stick(effect, sheet):
    """Constant, or with a part that fades over the first third of the campaign."""
    offset = np.full(len(sheet.reading), effect.size)
    if effect.form == "warming-up":
        offset = offset * (
            1 - effect.shape["part"] * np.exp(-3 * sheet.time / sheet.planned("time").max())
        )
    size = np.abs(offset) if effect.form == "dead-weight" else offset
    return {"force": np.maximum(size, 300.0 - sheet.state["force"])}


def measures(effect, sheet):
    """The mean offset."""
    return {"offset": float(stick(effect, sheet)["force"].mean())}
