"""Measured curves as the inference takes them: how far frequency falls and damping rises by slip.

How far measured and simulated curves may differ is a covariance. Besides noise it holds the
scatter of friction between clampings, which moves a curve along the amplitude, and the model's own
error of some per cent. Slip is made of patches that let go one after the other. So the relative
error of a small effect, made by few of them, is larger: its standard deviation goes with the root
of the effect.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.linalg import block_diag

from bladeroot.pooling.level_curve import level_curve

# A point of a curve is used if its frequency has fallen by more than both of these.
_LEAST_FALL = 2e-4  # of the stick frequency
_FALL_ERRORS = 4.0  # standard errors of the fall
CLAMPING_SCATTER = 0.06  # standard deviation of ln friction between clampings
# The error of the simulated curves.
DISCREPANCY = 0.05  # relative standard deviation, of the largest effect
_ERROR_LENGTH = 0.7  # of ln amplitude, over which its correlation falls to 1/e
# Parts of its variance, which add up to one.
_SHARED_PART = 0.4  # of a mode, shared by all forces at the same amplitude over force
_LEVEL_PART = 0.4  # of each level by itself
_POINT_PART = 0.2  # of each point by itself


@dataclass(frozen=True)
class Softening:
    """Points of the curves, one entry a level and amplitude (m).

    level: number of the level. fall: f / f_stick - 1. rise: eta - eta_stick. clampings: behind the
    point. noise: covariance by the measurement alone, of all falls, then all rises.
    """

    level: Int[ndarray, " point"]
    amplitude: Float[ndarray, " point"]
    fall: Float[ndarray, " point"]
    rise: Float[ndarray, " point"]
    clampings: Float[ndarray, " point"]
    noise: Float[ndarray, "number number"]


def softening_of(seen: xr.Dataset, levels: list[tuple[str, float]]) -> Softening:
    """Points of the given levels (mode, force as read in N).

    seen: from `bladeroot.diagnosis.observations`. Only records that reach their plateau count, and
    points at which the frequency has clearly fallen.
    """
    parts: list[tuple] = [(np.zeros((5, 0)), np.zeros((0, 0)), np.zeros((0, 0)))]
    names = np.where(seen["hold"].values == "", seen["record"].values, seen["hold"].values)
    for number, (mode, force) in enumerate(levels):
        own = (
            (seen["mode"].values.astype(str) == mode)
            & (seen["force"].values == force)
            & (seen["plateau_reached"].values == 1)
            & (seen["verdict"].values.astype(str) == "usable")
        )
        curve = level_curve(seen.isel(record=np.flatnonzero(own)))
        if curve is None:
            continue
        fall, (noise, noise_rise) = np.expm1(curve.mean[0]), curve.stated
        noise = np.outer(1.0 + fall, 1.0 + fall) * noise
        clear = (fall < -_LEAST_FALL) & (-fall > _FALL_ERRORS * np.sqrt(np.diag(noise)))
        known = np.isfinite(seen["frequency"].values[own])
        at = np.searchsorted(seen["amplitude"].values, curve.amplitude)
        clampings = [len(set(names[own][row])) for row in known[:, at].T]
        level = np.full(fall.size, float(number))
        columns = np.array([level, curve.amplitude, fall, curve.mean[1], clampings])
        parts.append((columns[:, clear], *(n[np.ix_(clear, clear)] for n in (noise, noise_rise))))
    columns, *noise = zip(*parts, strict=True)
    level, *rest = np.concatenate(columns, axis=1)
    return Softening(level.astype(int), *rest, block_diag(*noise[0], *noise[1]))


def of_modes(
    softening: Softening, levels: list[tuple[str, float]], modes: Collection[str]
) -> Softening:
    """The points of some modes."""
    own = np.array([levels[k][0] in modes for k in softening.level], bool)
    s, both = softening, np.tile(own, 2)
    parts = (part[own] for part in (s.level, s.amplitude, s.fall, s.rise, s.clampings))
    return Softening(*parts, s.noise[np.ix_(both, both)])


def covariance(
    softening: Softening,
    levels: list[tuple[str, float]],
    discrepancy: float = DISCREPANCY,
) -> Float[ndarray, "number number"]:
    """Covariance of measured less simulated values, all falls, then all rises.

    discrepancy: standard deviation of the model's error over the largest effect.
    """
    mode = np.array([levels[k][0] for k in softening.level])
    force = np.array([levels[k][1] for k in softening.level])
    total = softening.noise.copy()
    points = len(mode)
    alike = (mode[:, None] == mode) * _near(np.log(softening.amplitude / force))
    own = (softening.level[:, None] == softening.level) * _near(np.log(softening.amplitude))
    kernel = _SHARED_PART * alike + _LEVEL_PART * own + _POINT_PART * np.eye(points)
    for part, value in ((slice(0, points), softening.fall), (slice(points, None), softening.rise)):
        largest = np.array([np.abs(value[mode == one]).max() for one in mode])
        size = discrepancy * np.sqrt(np.abs(value) * largest)
        total[part, part] += kernel * np.outer(size, size)
    along = np.concatenate([_slope(softening, softening.fall), _slope(softening, softening.rise)])
    moved = CLAMPING_SCATTER * along / np.sqrt(np.tile(softening.clampings, 2))
    same = np.tile(force, 2)[:, None] == np.tile(force, 2)
    return total + same * np.outer(moved, moved)


def _slope(softening: Softening, value: Float[ndarray, " point"]) -> Float[ndarray, " point"]:
    """Slope by ln amplitude within each level; a lone point is taken to grow with its square."""
    slope = 2.0 * value
    for one in np.unique(softening.level):
        own = softening.level == one
        if own.sum() > 1:
            slope[own] = np.gradient(value[own], np.log(softening.amplitude[own]))
    return slope


def _near(place: Float[ndarray, " point"]) -> Float[ndarray, "point point"]:
    return np.exp(-np.abs(place[:, None] - place) / _ERROR_LENGTH)
