"""The gauge's zero is off."""

import numpy as np

ID, UNIT = "force-offset", "true force less the gauge's, N"
SIZES, SIGNED = (1500.0, 6000.0), True
LEAST = 300.0  # N: a zero that leaves the lowest load no force is seen at once
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
    offset = np.abs(offset) if effect.form == "dead-weight" else offset
    room = sheet.state["force"].min() - LEAST
    return {"force": offset * min(1.0, room / max(-offset.min(), room))}


def measures(effect, sheet):
    """The mean offset."""
    return {"offset": float(stick(effect, sheet)["force"].mean())}
