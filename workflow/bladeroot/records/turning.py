"""Where a log-envelope turns: its falls, and kinks in an otherwise smooth log-phasor."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Bool, Complex, Float, Int
from numpy import ndarray

# A fall is looked for in at most this many pieces of the record, each by its highest and lowest
# frame: the search itself is a loop, its cost is thus bounded.
PIECES = 8192


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
    pieces = [(0, 0)]
    peak = trough = 0
    for k in _extremes(level, broken):
        if broken[k] or level[k] > level[trough] + rise or level[k] > level[peak]:
            if level[peak] > level[trough]:
                pieces.append((k, k))
            peak = trough = k
        elif level[k] < level[trough]:
            trough = k
        pieces[-1] = (peak, trough)
    decays: list[list[tuple[int, int]]] = []
    top = bottom = 0.0
    for p, t in pieces:
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


def _extremes(level: Float[ndarray, " frame"], broken: Bool[ndarray, " frame"]) -> list[int]:
    """Indices of each piece's highest, lowest and broken frames, in order."""
    size = max(1, level.size // PIECES)
    whole = level.size // size * size
    rows = level[:whole].reshape(-1, size)
    first = np.arange(0, whole, size)
    chosen = (
        first + rows.argmax(axis=1), first + rows.argmin(axis=1), np.flatnonzero(broken),
        np.arange(whole, level.size),
    )  # fmt: skip
    at = np.unique(np.concatenate(chosen))
    # amid a rise or a fall, and not beside what is broken, nothing turns
    before, here, after = level[at[:-2]], level[at[1:-1]], level[at[2:]]
    amid = ((before < here) & (here < after)) | ((before > here) & (here > after))
    beside = broken[at[:-2]] | broken[at[1:-1]] | broken[at[2:]]
    keep = np.ones(at.size, bool)
    keep[1:-1] = ~amid | beside
    return at[keep].tolist()


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
    basis, jumps, off = _weights(reach)

    explained = _squares(log_phasor, basis.T)
    scatter = _squares(log_phasor, off) * correlation / (2.0 * (reach - 3))
    step, bend = (np.convolve(log_phasor, row[::-1], mode="valid") for row in jumps)
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
        step_std=np.sqrt(2.0 * variance * (jumps[0] @ jumps[0])),
        bend=bend,
    )


def _squares(
    log_phasor: Complex[ndarray, " point"], weights: Float[ndarray, "row wide"], most: int = 8192
) -> Float[ndarray, " window"]:
    """Sum of the squares of weighted sums over each window of the points, some at a time."""
    parts = np.stack([log_phasor.real, log_phasor.imag])
    windows = np.lib.stride_tricks.sliding_window_view(parts, weights.shape[1], axis=1)
    total = np.zeros(windows.shape[1])
    for first in range(0, total.size, most):
        some = np.ascontiguousarray(windows[:, first : first + most]) @ weights.T
        total[first : first + most] = np.einsum("pwr,pwr->w", some, some)
    return total


def expected_gain(bend: float, std: float, reach: int) -> float:
    """The gain that a bend in both parts (a point) shows where points have standard error `std`."""
    basis = _weights(reach)[0]
    seen = basis.T @ _columns(reach)[2][:, 1]
    return float(bend**2 * (seen @ seen) / (4.0 * std**2))


@cache
def _weights(reach: int) -> tuple[ndarray, ndarray, ndarray]:
    """What only a step and a bend explain, their sizes, and a half's misfit to a parabola."""
    x, smooth, jump = _columns(reach)
    columns = np.hstack([smooth, jump])
    half = np.vander(x[x > 0], 3)
    off = np.linalg.svd(half)[0][:, 3:].T
    return np.linalg.qr(columns)[0][:, -2:], np.linalg.pinv(columns)[-2:], off


def _columns(reach: int) -> tuple[ndarray, ndarray, ndarray]:
    """Points about a place, what is smooth there, and a step and a bend."""
    x = (np.arange(-reach, reach) + 0.5) / reach
    late = np.maximum(x, 0.0)
    smooth = np.stack([np.ones_like(x), x, x**2, x**3, late**2], axis=1)
    return x, smooth, np.stack([(x > 0).astype(float), late * reach], axis=1)
