"""Where a log-envelope turns: its falls, and kinks in an otherwise smooth log-phasor."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Bool, Complex, Float, Int
from numpy import ndarray


def clean_falls(
    level: Float[ndarray, " frame"], rise: float, broken: Bool[ndarray, " frame"]
) -> list[tuple[int, int]]:
    """Peak and trough (indices) of the cleanest piece of every decay, the largest first.

    A rise by more than `rise`, and what is marked in `broken`, divide the record into pieces. One
    that regains half of what had fallen begins another decay; the others go on with the same, and
    of these the first counts that holds a quarter of the fall, or halves the level over 40 frames:
    before it the tip chatters or the hammer bounces, after it the mode is no longer free, however
    fast it falls.
    """
    decays: list[list[tuple[int, int]]] = []
    top = bottom = 0.0
    for p, t in _pieces(level, rise, broken):
        if not decays or level[p] - bottom > 0.5 * (top - bottom):
            decays.append([])
            top, bottom = level[p], level[t]
        decays[-1].append((p, t))
        bottom = min(bottom, level[t])
    found = []
    for decay in decays:
        depth = [level[p] - level[t] for p, t in decay]
        lasting = [
            d >= 0.25 * sum(depth) or (d > np.log(2.0) and t - p > 40)
            for d, (p, t) in zip(depth, decay, strict=True)
        ]
        found.append(decay[lasting.index(True)] if True in lasting else decay[np.argmax(depth)])
    return sorted(found, key=lambda fall: level[fall[1]] - level[fall[0]])


def _pieces(
    level: Float[ndarray, " frame"], rise: float, broken: Bool[ndarray, " frame"]
) -> list[tuple[int, int]]:
    """Peak and trough of every piece of the record, in order."""
    pieces = [(0, 0)]
    peak = trough = 0
    high = low = float(level[0])
    # only the ends of the level's falls and rises matter, and what is broken
    turns = np.diff(np.sign(np.diff(level)), prepend=2.0, append=2.0) != 0.0
    turns |= broken
    turns[1:] |= broken[:-1]
    turns[:-1] |= broken[1:]
    at = np.flatnonzero(turns)
    for k, now, struck in zip(*(x.tolist() for x in (at, level[at], broken[at])), strict=True):
        if struck or now > low + rise or now > high:
            if high > low:
                pieces.append((k, k))
            peak = trough = k
            high = low = now
        elif now < low:
            trough, low = k, now
        pieces[-1] = (peak, trough)
    return pieces


@dataclass(frozen=True)
class Kinks:
    """For each place between points: how much a step and a bend there would explain.

    `gain` is the misfit explained over what noise explains by chance (1 on average), `bare` the
    same where a ripple on the other side counts as noise too; `step` (standard error `step_std`)
    and `bend` are the complex jump in value and in slope (a point).
    """

    place: Int[ndarray, " place"]
    gain: Float[ndarray, " place"]
    bare: Float[ndarray, " place"]
    step: Complex[ndarray, " place"]
    step_std: Float[ndarray, " place"]
    bend: Complex[ndarray, " place"]


def kinks(
    log_phasor: Complex[ndarray, " point"],
    std: Float[ndarray, " point"],
    reach: int,
    smooth_side: int,
    correlation: float = 1.0,
) -> Kinks:
    """Test every place for a step or bend of a log-phasor that is smooth otherwise.

    The `reach` points on either side of a place are fitted with one cubic whose curvature may
    change there (a joint that begins to stick does that), then with a step and a bend as well.
    Noise is the larger of `std` (each of real and imaginary part) and the scatter about a parabola
    on the side that is known to be smooth: +1 what comes after the place, -1 what comes before.
    Neighbouring points may share their noise: `correlation` is the variance of a long mean over
    that of independent points, for the scatter only. A place k lies between the points k - 1 and k.
    """
    place = np.arange(reach, log_phasor.size - reach + 1)
    if not place.size:
        none = np.zeros(0)
        return Kinks(place, none, none, none.astype(complex), none, none.astype(complex))
    basis, sizes, off = _weights(reach)
    seen = np.stack([np.convolve(log_phasor, row[::-1], mode="valid") for row in basis])
    explained = (seen.real**2 + seen.imag**2).sum(axis=0)
    step, bend = sizes @ seen
    left = np.zeros(log_phasor.size - reach + 1)
    for row in off:
        one = np.convolve(log_phasor, row[::-1], mode="valid")
        left += one.real**2 + one.imag**2
    scatter = left * correlation / (2.0 * (reach - 3))
    known = np.convolve(std**2, np.full(reach, 1.0 / reach), mode="valid")
    early, late = slice(0, place.size), slice(reach, reach + place.size)
    smooth_part, other = (late, early) if smooth_side > 0 else (early, late)
    variance = np.maximum(np.maximum(known, scatter)[smooth_part], 1e-24)
    ripple = np.maximum(scatter - known, 0.0)[other]
    return Kinks(
        place=place,
        gain=explained / (4.0 * variance),
        bare=explained / (4.0 * np.maximum(variance, ripple)),
        step=step,
        step_std=np.sqrt(2.0 * variance * (sizes[0] @ sizes[0])),
        bend=bend,
    )


def expected_gain(bend: float, std: float, reach: int) -> float:
    """The gain that a bend in both parts (a point) shows where points have standard error `std`."""
    return bend**2 * _unit_bend(reach) / (4.0 * std**2)


@cache
def _unit_bend(reach: int) -> float:
    """What only a step and a bend explain of a unit bend in both parts."""
    seen = np.linalg.solve(_weights(reach)[1], [0.0, 1.0])
    return float(seen @ seen)


@cache
def _weights(reach: int) -> tuple[ndarray, ndarray, ndarray]:
    """Weights of the points, and the sizes of a step and of a bend (a point) from weighted sums.

    First, orthonormal rows for what only a step and a bend explain; second, the matrix from these
    sums to the sizes; third, orthonormal rows for what no parabola explains of one half.
    """
    x = (np.arange(-reach, reach) + 0.5) / reach
    late = np.maximum(x, 0.0)
    smooth = [np.ones_like(x), x, x**2, x**3, late**2]
    basis, triangle = np.linalg.qr(np.stack([*smooth, x > 0, late * reach], axis=1))
    off = np.linalg.svd(np.vander(x[x > 0], 3))[0][:, 3:].T
    return basis[:, -2:].T.copy(), np.linalg.inv(triangle[-2:, -2:]), off.copy()
