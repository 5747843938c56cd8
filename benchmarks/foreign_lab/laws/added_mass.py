"""Something rides on the beam that the model lacks."""

import numpy as np

ID, UNIT = "added-mass", "mass, kg"
SIZES = (0.005, 0.025)
FORMS = {
    "lumped": lambda r: {"place": float(r.uniform(-0.08, 0.08))},
    "spread": lambda r: {"length": float(r.uniform(0.1, 0.5))},
    "two-sensors": lambda r: {"place": float(r.uniform(0.03, 0.2))},
}


def stick(effect, sheet):
    """-dm phi(x)^2 / 2 with the bending shapes of a clamped beam."""
    x = np.linspace(-0.5, 0.5, 401)
    if effect.form == "lumped":
        weight = np.exp(-(((x - effect.shape["place"]) / 0.01) ** 2))
    elif effect.form == "spread":
        weight = (np.abs(x) < effect.shape["length"] / 2).astype(float)
    else:
        weight = np.exp(-(((np.abs(x) - effect.shape["place"]) / 0.01) ** 2))
    weight = weight / weight.sum()
    change = np.zeros(len(sheet.mode))
    for mode, surface in sheet.specimen.surfaces.items():
        shape = clamped(int(mode[0]), x)
        laser = sheet.specimen.laser[mode] / span(sheet)
        heavy = surface.modal_mass * np.interp(laser, x, shape) ** 2
        part = effect.size * (weight * shape**2).sum() / heavy
        change[sheet.mode == mode] = -0.5 * np.log1p(part)
    return {"ln_f": change}


def span(sheet) -> float:
    """Length of the beam, m."""
    told = sheet.specimen.told
    return 0.30 if told is None else told.length


def clamped(number: int, x: np.ndarray) -> np.ndarray:
    """Shape of a clamped beam's bending mode over x from -1/2 to 1/2."""
    beta = (4.730041, 7.853205, 10.995608)[number - 1]
    if number % 2:
        return np.cos(beta * x) / np.cos(beta / 2) - np.cosh(beta * x) / np.cosh(beta / 2)
    return np.sin(beta * x) / np.sin(beta / 2) - np.sinh(beta * x) / np.sinh(beta / 2)


def measures(effect, sheet):
    """The mass."""
    return {"mass": effect.size}
