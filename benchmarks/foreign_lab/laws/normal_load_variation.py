"""Flanks that open for a part of the cycle, or whose gap stiffness is uneven about the preload."""

import numpy as np
from scipy.special import ive

ID, UNIT = "normal-load-variation", "largest fall of ln f at the middle load"
SIZES = (3e-4, 3e-3)


def _common(rng) -> dict:
    return {"loss": float(rng.uniform(0.005, 0.04)), "preload": float(rng.uniform(0.6, 1.2))}


FORMS = {
    "distributed": _common,
    "at-once": _common,
    "rough": _common,
    "hertz": _common,
}


def bilinear(u: np.ndarray) -> np.ndarray:
    """In-phase stiffness of a spring that opens at the gap 1 under u cos(theta)."""
    angle = np.arccos(np.clip(1.0 / np.maximum(u, 1e-12), 0.0, 1.0))
    return 1.0 - (angle - 0.5 * np.sin(2 * angle)) / np.pi


def left(form: str, u: np.ndarray) -> np.ndarray:
    """Part of the stiffness left at a gap amplitude u, in units of what the preload closes."""
    if form == "at-once":
        return bilinear(u)
    if form == "distributed":  # preloads evenly spread from 0.3 to 1.7
        return np.mean([bilinear(u / gap) for gap in np.linspace(0.3, 1.7, 29)], axis=0)
    if form == "rough":  # pressure exponential in the gap, mean load kept
        z = np.maximum(u, 1e-9)
        return 2.0 * ive(1, z) / (z * ive(0, z))
    # sphere on a plane, force ~ approach^(3/2), mean load kept; expanded, then levelling off
    return 1.0 / (1.0 + 3.0 / 16.0 * u**2)


def _gap(effect, record) -> float:
    """Laser amplitude (m) at which the flanks begin to open, for the record's mode."""
    sheet = record.sheet
    surface = sheet.specimen.surfaces["1B"]
    share = 2.0 * float(
        surface.slope(0, sheet.specimen.ln_kn, sheet.specimen.ln_kt, sheet.reference)
    )
    start = sheet.usual_start("1B")
    u = np.geomspace(1e-2, 100, 600)
    fall = share / 2.0 * (1.0 - left(effect.form, u))
    wanted = min(effect.size, 0.6 * fall[-1])
    middle = start / u[int(np.argmax(fall >= wanted))]
    grow = record.load ** effect.shape["preload"]
    return middle * grow * surface.open / record.surface.open


def curve(effect, record, x):
    """Softening of kn, a small loss, even harmonics."""
    u = x / _gap(effect, record)
    ratio = np.maximum(left(effect.form, u), 0.13)
    share = record.share(0, ratio)
    return {
        "ln_f": record.softened(0, ratio),
        "eta": effect.shape["loss"] * share * (1 - ratio),
        "even": 0.4 * share * (1 - ratio) / 3.0,
    }
