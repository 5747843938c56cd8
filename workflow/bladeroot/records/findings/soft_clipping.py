"""Tilted or rounded tops: clipping before an AC coupling or a filter."""

from functools import cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.records.finding import Finding
from bladeroot.records.findings import clipping
from bladeroot.records.sight import Sight

MIXED = True
STATISTIC = "factor of a cosine cut off at one level in the loudest cycles, in standard errors"
THRESHOLD = 7.0
BINS = 32
# Mean cycles are made of stretches in which the amplitude falls by this part.
STRETCH = 0.04
FEWEST_CYCLES = 3


def find(sight: Sight) -> Finding | None:
    """Mean cycles of the loud part against cosines cut off at a level common to all.

    Harmonics up to the third belong to modes and contact; what is looked for is the rest of the
    cut-off cosine, in the size that goes with the amplitude at the time.
    """
    frames = sight.frames
    if clipping.find(sight).counts:
        return None  # the plain case, told by itself
    if sight.sampling_Hz < 12.0 * sight.own_Hz or frames.clear < 20:
        return None
    amplitude, cycles, count = _mean_cycles(sight)
    if amplitude.size < 2 or count.min() < 2:
        return None
    _, away = _shapes()
    rest = cycles - (cycles @ away) @ away.T
    weight = count.mean(axis=1)
    weight = weight / weight.mean()
    levels = amplitude.max() * _DEPTHS
    shape = _cut_off(levels[:, None] / amplitude)  # level, part, bin
    power = np.einsum("p,lpb,lpb->l", weight, shape, shape)
    known = np.maximum(power, 1e-300)
    share = np.einsum("p,lpb,pb->l", weight, shape, rest) / known
    left = np.einsum("p,lpb->l", weight, (rest - share[:, None, None] * shape) ** 2)
    error = np.sqrt(left / (rest.size - amplitude.size * away.shape[1] - 1) / known)
    sized = (power > 0.0) & (share > 0.5) & (share < 2.0)
    ratio = np.where(sized, share / np.maximum(error, 1e-300), 0.0)
    best = int(np.argmax(ratio))
    statistic, level = (float(ratio[best]), float(levels[best])) if sized.any() else (0.0, 1.0)
    below = np.flatnonzero(frames.amplitude > level)
    last = int(frames.centre[min(below[-1] + 2, frames.log.size - 1)]) if below.size else 0
    text = (
        f"rounded tops: the first cycles are those of a cosine cut off at {level:.3g} m/s; "
        f"masked up to {sight.seconds(last):.4g} s"
    )
    return Finding(float(statistic), THRESHOLD, "mask", text, ((0, last),))


def _mean_cycles(
    sight: Sight,
) -> tuple[Float[ndarray, " part"], Float[ndarray, "part bin"], Float[ndarray, "part bin"]]:
    """Mean amplitude of some stretches, their mean cycles over it, and samples in each bin."""
    frames = sight.frames
    fallen = np.log(frames.amplitude[: frames.clear].max()) - frames.log.real[: frames.clear]
    loud = int(np.argmax(fallen > 0.7)) or frames.clear
    part = np.zeros(loud, int)
    begin = 0
    for k in range(1, loud):
        full = fallen[k] - fallen[begin] > STRETCH and k - begin >= FEWEST_CYCLES
        part[k] = part[k - 1] + full
        begin = k if full else begin
    stop = int(frames.centre[loud - 1])
    sample = np.arange(float(stop))
    turns = np.interp(sample, frames.centre, frames.log.imag) / (2.0 * np.pi)
    turns += frames.frequency_Hz / sight.sampling_Hz * sample
    size = np.exp(np.interp(sample, frames.centre, frames.log.real))
    place = (np.mod(turns, 1.0) * BINS).astype(int) % BINS
    index = ((sample - frames.centre[0]) / frames.hop).astype(int)
    place += BINS * part[np.maximum(index, 0)]
    length = (part[-1] + 1) * BINS
    count = np.bincount(place, minlength=length).reshape(-1, BINS).astype(float)
    sums = np.bincount(place, sight.velocity[:stop] / size, length).reshape(-1, BINS)
    total = np.bincount(place // BINS, size, part[-1] + 1) / np.maximum(count.sum(axis=1), 1.0)
    whole = count.min(axis=1) >= 2
    return total[whole], sums[whole] / count[whole], count[whole]


@cache
def _shapes() -> tuple[Float[ndarray, "level bin"], Float[ndarray, "bin harmonic"]]:
    """Cut-off cosines over their fundamental, beyond the third harmonic; what was taken off."""
    fine = (np.arange(BINS * 16) + 0.5) / (BINS * 16) * 2.0 * np.pi
    angle = fine.reshape(BINS, 16).mean(axis=1)
    plain = [np.ones(BINS)]
    for order in (1, 2, 3):
        plain += [np.cos(order * angle), np.sin(order * angle)]
    away, _ = np.linalg.qr(np.stack(plain, axis=1))
    shapes = []
    for level in _LEVELS:
        cut = np.clip(np.cos(fine), -level, level)
        cut = (cut / (2.0 * np.mean(cut * np.cos(fine)))).reshape(BINS, 16).mean(axis=1)
        shapes.append(cut - away @ (away.T @ cut))
    return np.array(shapes), away


def _cut_off(relative: Float[ndarray, "level part"]) -> Float[ndarray, "level part bin"]:
    """Shapes for a level relative to the fundamental's amplitude (1 and more: not cut off)."""
    shapes, _ = _shapes()
    at = np.interp(relative, _LEVELS / _FUNDAMENTAL, np.arange(_LEVELS.size))
    low = np.minimum(at.astype(int), _LEVELS.size - 2)
    part = (at - low)[..., None]
    return (1.0 - part) * shapes[low] + part * shapes[low + 1]


_DEPTHS = np.geomspace(0.3, 0.98, 30)
_LEVELS = np.linspace(0.02, 1.0, 99)
# of a cosine cut off at `_LEVELS` of its amplitude, over that amplitude
_FUNDAMENTAL = (2.0 / np.pi) * (np.arcsin(_LEVELS) + _LEVELS * np.sqrt(1.0 - _LEVELS**2))
