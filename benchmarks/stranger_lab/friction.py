"""Friction by first harmonic: softening and loss over the amplitude of the joint's motion."""

from functools import cache

import numpy as np

FORMS = ("lognormal", "bimodal", "power", "exp", "boucwen")


def sliders(form: str, spread: float, exponent: float) -> tuple[np.ndarray, np.ndarray]:
    """Thresholds of parallel sliders over a characteristic amplitude, and their shares."""
    z = np.linspace(-2.6, 2.6, 241)
    if form == "lognormal":
        x, share = np.exp(spread * z), np.exp(-0.5 * z**2)
    elif form == "bimodal":
        z = z[::2]
        x = np.r_[np.exp(0.25 * z), np.exp(0.25 * z + 1.9)]
        share = np.r_[np.exp(-(z**2) / 2), 2 * np.exp(-(z**2) / 2)]
    elif form == "power":
        x = np.linspace(0.004, 1, 300) ** 1.5 * 4
        share = np.gradient(x) * x**exponent
    else:
        x = np.linspace(0.01, 7, 400)
        share = np.gradient(x) * np.exp(-x)
    return x, share / share.sum()


def of_sliders(x: np.ndarray, share: np.ndarray, amplitude: np.ndarray):
    """Share of stiffness that is lost, and loss over the stuck stiffness, at amplitudes."""
    a = np.maximum(np.asarray(amplitude)[:, None], 1e-12)
    angle = np.arccos(1 - 2 * np.minimum(x / a, 1.0))
    kept = (angle - 0.5 * np.sin(2 * angle)) / np.pi
    loss = 4 * x * np.maximum(a - x, 0) / (np.pi * a**2)
    return 1 - kept @ share, loss @ share


@cache
def bouc_wen(exponent: float):
    """ln of amplitudes over the yield motion, and there the same two numbers, by time steps."""
    amplitude = np.geomspace(0.01, 60, 36)
    turn = np.linspace(0, 6 * np.pi, 1801)
    force = np.zeros((turn.size, amplitude.size))
    motion = np.outer(np.cos(turn), amplitude)
    for i in range(1, len(turn)):
        z, step = force[i - 1], motion[i] - motion[i - 1]
        back = np.abs(step) * np.abs(z) ** (exponent - 1) * z + step * np.abs(z) ** exponent
        force[i] = z + step - 0.5 * back
    last, force = turn[1200:1800, None], force[1200:1800]
    kept = 2 * np.mean(force * np.cos(last), axis=0) / amplitude
    loss = np.abs(2 * np.mean(force * np.sin(last), axis=0)) / amplitude
    return np.log(amplitude), 1 - kept, loss


def softening(slip: dict, amplitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Share of stiffness lost, and loss, of a drawn law at amplitudes over its threshold."""
    if slip["form"] == "boucwen":
        at, lost, loss = bouc_wen(slip["exponent"])
        ln_a = np.log(amplitude)
        return np.interp(ln_a, at, lost, left=0.0), np.interp(ln_a, at, loss, left=0.0)
    return of_sliders(*sliders(slip["form"], slip["spread"], slip["density"]), amplitude)
