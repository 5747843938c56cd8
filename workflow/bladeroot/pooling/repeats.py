"""Records whose frequency is not that of their repeats: a wrong sampling rate, mode or force.

A record is compared with the others of its clamping, which repeat it closely, and a clamping with
the others of its force, which scatter more. Either stands out where it lies further from the
median than `USUAL_DISTANCES` times the usual distance at its force and two next to it, or at all
forces, where that is more; and further than `LEAST_DISTANCE`, which no clamping's scatter should
reach.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.loads import value_of
from bladeroot.pooling.level_curve import ladder_of, on_ladder

# Distance from the median beyond which a record or a clamping stands out: the larger of these. Set
# on drawn campaigns (benchmarks/repeats.py): the clampings of a force are few, so the usual
# distance is known roughly, and clampings scatter more where the force is small.
USUAL_DISTANCES = 10.0  # times the usual distance, as a standard deviation
LEAST_DISTANCE = 0.01  # relative
_TO_STD = 1.4826  # standard deviation of a normal distribution over its median distance

Matrix = Float[ndarray, "record record"]


def unlike_repeats(
    decays: Sequence[xr.Dataset], plateaus: Sequence[xr.Dataset]
) -> list[tuple[int, float, float]]:
    """Number of each record that stands out, its distance from the others, and what was allowed.

    decays, plateaus: of the same records, with mode, force_N and hold in the attributes. Distances
    are relative, and negative below the others: of the stick frequencies, or where one of two
    records has none, of the curves at the amplitudes that both reach.
    """
    found = []
    # amplitudes are those at a sensor, and groups are no repeats of each other
    kinds = [
        tuple(str(plateau.attrs.get(name, "")) for name in ("mode", "group", "sensor"))
        for plateau in plateaus
    ]
    modes = np.array(["\n".join(kind) for kind in kinds])
    force = np.array([value_of(plateau.attrs) for plateau in plateaus])
    clamping = np.array([str(plateau.attrs["hold"]) for plateau in plateaus])
    for mode in np.unique(modes):
        mine = np.flatnonzero(modes == mode)
        distance = _distances([decays[k] for k in mine], [plateaus[k] for k in mine], force[mine])
        out, allowed = _unlike(distance, force[mine], clamping[mine])
        for k in np.flatnonzero(out):
            apart = _median(distance[k, ~out & (force[mine] == force[mine[k]])])
            # clampings that lie apart with no third to say which is right are all out
            apart = _median(np.delete(distance[k], k)) if np.isnan(apart) else apart
            found.append((int(mine[k]), float(np.expm1(apart)), float(allowed[k])))
    return sorted(found)


def _unlike(
    distance: Matrix, force: Float[ndarray, " record"], clamping: ndarray
) -> tuple[Bool[ndarray, " record"], Float[ndarray, " record"]]:
    """Which records of one mode stand out, and what distance each was allowed."""
    places = np.array([f"{f!r} {h}" for f, h in zip(force.tolist(), clamping, strict=True)])
    clampings, member = np.unique(places, return_inverse=True)
    out, allowed = _stand_out(distance, member, force)
    for k in np.flatnonzero(np.bincount(member) == 2):
        # of two that lie apart, the one further from the other clampings
        one, two = np.flatnonzero(member == k)
        others = (force == force[one]) & (member != k) & ~out
        away = [abs(_median(distance[record, others])) for record in (one, two)]
        if out[[one, two]].all() and np.isfinite(away).all():
            out[one if away[0] < away[1] else two] = False
    rows = [np.flatnonzero((member == k) & ~out) for k in range(clampings.size)]
    forces = np.array([force[member == k][0] for k in range(clampings.size)])
    between = np.zeros((clampings.size, clampings.size))
    for a, b in zip(*np.nonzero(forces[:, None] == forces), strict=True):
        between[a, b] = 0.0 if a == b else _median(distance[np.ix_(rows[a], rows[b])])
    far, reach = _stand_out(between, np.unique(forces, return_inverse=True)[1], forces)
    allowed = np.where(far[member] & ~out, reach[member], allowed)
    return out | far[member], allowed


def _stand_out(
    distance: Float[ndarray, "one one"], group: ndarray, force: Float[ndarray, " one"]
) -> tuple[Bool[ndarray, " one"], Float[ndarray, " one"]]:
    """Which lie far from the median of their group, and what distance each was allowed."""
    count = np.bincount(group)[group]
    away = np.array([_median(row[group == own]) for row, own in zip(distance, group, strict=True)])
    # the median lies between the records themselves: half the distance for two, less for more
    away = np.where(count > 1, away * np.sqrt(count / np.maximum(count - 1, 1)), np.nan)
    forces, place = np.unique(force, return_inverse=True)
    middle = np.clip(np.arange(forces.size), 1, max(forces.size - 2, 1))
    usual = np.array([_median(np.abs(away[np.abs(place - k) <= 1])) for k in middle])
    usual = np.fmax(usual, _median(np.abs(away)))[place]
    allowed = np.fmax(LEAST_DISTANCE, USUAL_DISTANCES * _TO_STD * usual)
    return np.abs(away) > allowed, allowed


def _distances(
    decays: Sequence[xr.Dataset], plateaus: Sequence[xr.Dataset], force: Float[ndarray, " record"]
) -> Matrix:
    """ln frequency of each record less that of each other at its force; NaN where none can be."""
    stick = np.log([float(plateau["stick_frequency"]) for plateau in plateaus])
    distance = stick[:, None] - stick
    usable = [
        decay.sizes["point"] > 1 and not str(plateau["verdict"].values).startswith("rejected")
        for decay, plateau in zip(decays, plateaus, strict=True)
    ]
    ladder = ladder_of([d for d, known in zip(decays, usable, strict=True) if known])
    curves = [
        np.log(on_ladder(decay, "frequency", ladder)) if known else np.full(ladder.size, np.nan)
        for decay, known in zip(decays, usable, strict=True)
    ]
    for a, b in zip(*np.nonzero(np.isnan(distance) & (force[:, None] == force)), strict=True):
        distance[a, b] = _median(curves[a] - curves[b])
    return np.where(force[:, None] == force, distance, np.nan)


def _median(values: ndarray) -> float:
    """Median of what is known; NaN of nothing."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else np.nan
