"""How far measured and simulated curves may differ, as a covariance.

Besides noise: the clampings' own friction, which moves a curve along the amplitude; and the model
itself, which is trusted to some per cent. Slip is made of patches that let go one after the other,
so an effect that is small against the largest, made by few of them, is less certain by its root.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.stiffness.softening import Softening

DISCREPANCY = 0.05  # of the largest effect
CLAMPING = 0.06  # standard deviation of ln friction between clampings
_LENGTH = 0.7  # of the model's error, in ln amplitude
# Of its variance: common to all forces at the same amplitude over force; own to the level; neither.
_COMMON, _OWN, _LOOSE = 0.4, 0.4, 0.2


def covariance(
    softening: Softening,
    levels: list[tuple[str, float]],
    discrepancy: float = DISCREPANCY,
) -> Float[ndarray, "number number"]:
    """Of all falls, then all rises. discrepancy: standard deviation, of the largest effect."""
    mode = np.array([levels[k][0] for k in softening.level])
    force = np.array([levels[k][1] for k in softening.level])
    noise = np.concatenate([softening.fall_std, softening.rise_std])
    total = np.diag(noise**2)
    points = len(mode)
    alike = (mode[:, None] == mode) * _near(np.log(softening.amplitude / force))
    own = (softening.level[:, None] == softening.level) * _near(np.log(softening.amplitude))
    kernel = _COMMON * alike + _OWN * own + _LOOSE * np.eye(points)
    for part, value in ((slice(0, points), softening.fall), (slice(points, None), softening.rise)):
        largest = np.array([np.abs(value[mode == one]).max() for one in mode])
        size = discrepancy * np.sqrt(np.abs(value) * largest)
        total[part, part] += kernel * np.outer(size, size)
    along = np.concatenate([_slope(softening, softening.fall), _slope(softening, softening.rise)])
    moved = CLAMPING * along / np.sqrt(np.tile(softening.holds, 2))
    same = np.tile(force, 2)[:, None] == np.tile(force, 2)
    return total + same * np.outer(moved, moved)


def _slope(softening: Softening, value: Float[ndarray, " point"]) -> Float[ndarray, " point"]:
    """By ln amplitude, within each level; of a lone point as of one that grows with its square."""
    slope = 2.0 * value
    for one in np.unique(softening.level):
        own = softening.level == one
        if own.sum() > 1:
            slope[own] = np.gradient(value[own], np.log(softening.amplitude[own]))
    return slope


def _near(place: Float[ndarray, " point"]) -> Float[ndarray, "point point"]:
    return np.exp(-np.abs(place[:, None] - place) / _LENGTH)
