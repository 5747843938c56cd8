"""Parallel sliders with any density of thresholds, under u cos(theta): describing function.

Every rate-independent element that obeys Masing's rules is such a set; the forms differ by the part
of the stiffness that slides at a displacement of less than x (in units of the largest threshold).
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np

LEVELS, PHASES = 400, 256


def cycle(thresholds: np.ndarray, u: float, phases: int = PHASES) -> np.ndarray:
    """Mean force of sliders of unit stiffness over one steady cycle of u cos(theta)."""
    half = np.arange(phases // 2) * 2 * np.pi / phases
    x = u * np.cos(half)[:, None]
    slipping = np.minimum(thresholds, u)
    force = np.maximum(slipping - (u - x), -slipping).mean(axis=1)
    return np.concatenate([force, -force])


def loop(thresholds: np.ndarray, u: float) -> tuple[float, float, float]:
    """Stiffness in phase, energy over u^2, size of the third harmonic of the force over u.

    `thresholds`: of sliders of equal stiffness, 1 in all; inf never slides.
    """
    force = cycle(thresholds, u)
    theta = np.arange(len(force)) * 2 * np.pi / len(force)
    inphase = 2 * (force * np.cos(theta)).mean() / u
    third = abs(2 * (force * np.exp(-3j * theta)).mean()) / u
    finite = thresholds[thresholds < u]
    energy = 4 * (finite * (u - finite)).sum() / len(thresholds) / u**2
    return float(inphase), float(energy), float(third)


def quantiles(inverse: Callable, levels: int = LEVELS) -> np.ndarray:
    """Thresholds at the middles of equal parts of the stiffness."""
    return inverse((np.arange(levels) + 0.5) / levels)


@lru_cache(maxsize=64)
def table(form: str, items: tuple) -> tuple[np.ndarray, ...]:
    """ln u, stiffness, energy over u^2, third harmonic of a form with its shape's items."""
    thresholds = quantiles(INVERSE[form](dict(items)))
    ln_u = np.linspace(np.log(1e-4), np.log(1e3), 120)
    values = np.array([loop(thresholds, u) for u in np.exp(ln_u)])
    return ln_u, *values.T


def respond(form: str, shape: dict, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness left, energy over k u^2 and third harmonic at amplitudes u (of the threshold)."""
    ln_u, *values = table(form, tuple(sorted(shape.items())))
    return tuple(np.interp(np.log(np.maximum(u, 1e-12)), ln_u, one) for one in values)


def _rest(shape: dict, inverse: Callable) -> Callable:
    """Of the stiffness a part `rest` never slides."""
    moving = 1.0 - shape["rest"]

    def thresholds(level: np.ndarray) -> np.ndarray:
        part = np.minimum(level / moving, 1.0)
        return np.where(level < moving, inverse(part), np.inf)

    return thresholds


def _lognormal(shape: dict) -> Callable:
    from scipy.special import ndtri

    return lambda level: np.exp(shape["spread"] * ndtri(np.clip(level, 1e-9, 1 - 1e-9)))


def _iwan(shape: dict) -> Callable:
    """Segalman's four parameters: a power density and a part that all breaks loose at the end."""
    smooth = 1.0 - shape["last"]
    return lambda level: np.minimum(level / smooth, 1.0) ** (1.0 / (1.0 + shape["chi"]))


# The thresholds at a level of the stiffness, from 0 to 1, for each form.
INVERSE = {
    "power": lambda s: _rest(s, lambda level: level ** s["power"]),
    "lognormal": lambda s: _rest(s, _lognormal(s)),
    "uniform": lambda s: _rest(s, lambda level: s["first"] + (1 - s["first"]) * level),
    "iwan": lambda s: _rest(s, _iwan(s)),
    # Mindlin's sphere: q = 1 - (1 - u)^(3/2), so that (1 - u)^(1/2) of the stiffness is left
    "mindlin": lambda s: _rest(s, lambda level: 1.0 - (1.0 - level) ** 2),
    # two rough lines in contact (Cattaneo): nearly all slides late, the edges at once
    "cattaneo-line": lambda s: _rest(s, lambda level: level**2 * (2.0 - level) ** 2),
    # Dahl: the force tends to its limit exponentially
    "dahl": lambda s: _rest(s, lambda level: -np.log1p(-np.minimum(level, 1 - 1e-9))),
    # two patches: edges early, the middle ten times later
    "two-patches": lambda s: _rest(
        s, lambda level: np.where(level < s["edge"], 0.1 * (0.5 + level), 0.7 + 0.6 * level)
    ),
}
