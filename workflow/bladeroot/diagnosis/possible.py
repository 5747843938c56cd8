"""Whether a structure can be the specimen at all, before anything is inferred with it."""

from collections.abc import Mapping
from itertools import combinations

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray
from scipy.optimize import least_squares

from bladeroot.diagnosis.simulation.table import Table
from bladeroot.rom.chebyshev import Surface
from bladeroot.rom.parametric import Solved, ln_frequencies, solved_of, surface_of

# A structure is the specimen's if some point of its box lies within so many of the model's stated
# errors (0.5 % unless told otherwise, so 5 %). It guards against another machine's structure. The
# shipped dovetails miss the published frequencies by at most 1.7 %; a wrong modulus or an added
# mass, which the diagnosis names, moves modes by some per cent; a 122 Hz beam is 77 % off.
FACTOR = 10.0
_GRID = (17, 17, 7)  # of ln kn, ln kt and the load
_SOLVED = 5  # of each of any number of stiffnesses, where each point is an eigenproblem
_STARTS = 3  # points of the grid from which the nearest point of the box is looked for


def impossible(model: xr.Dataset, measured: Mapping[str, float], error: Mapping[str, float]) -> str:
    """Why a structure cannot be the specimen, one sentence with the numbers, or "".

    model: from `bladeroot.rom.parametric`. measured: frequency (Hz) of each mode; where the
    structure has no mode of a name, modes are taken in the order of their frequencies, in the way
    that suits it best. error: the model's stated relative error by mode.
    """
    if not measured:
        return ""
    names = model["mode"].values.astype(str).tolist()
    surface = surface_of(model) if "ln_frequency" in model else solved_of(model)
    points = _box(surface)
    grid = ln_frequencies(surface, points)[0]
    wanted = dict(sorted(measured.items(), key=lambda one: one[1]))
    if set(wanted) <= set(names):
        choices = [tuple(names.index(mode) for mode in wanted)]
    else:
        count = min(len(wanted), len(names))
        choices = list(combinations(range(len(names)), count))
    target = np.log(np.array(list(wanted.values())))[: len(choices[0])]
    stated = np.array([error.get(mode, max(error.values())) for mode in wanted])[: target.size]
    best = min((_nearest(surface, points, grid, one, target, stated) for one in choices),
               key=lambda one: one[0])  # fmt: skip
    times, there = best[0], np.exp(best[1])
    if times <= FACTOR:
        return ""
    pairs = [
        f"{own:.4g} Hz for {mode} at {float(np.exp(t)):.4g} Hz ({_off(own / float(np.exp(t)))})"
        for mode, t, own in zip(wanted, target, there, strict=False)
    ]
    return (
        f"{model.attrs.get('structure', 'the structure')} cannot be this specimen: no contact "
        "stiffness and load of its model comes nearer to the measured frequencies than "
        f"{', '.join(pairs)}, where {FACTOR:g} times its stated error of "
        f"{100 * float(stated.max()):.2g} % would be {100 * FACTOR * float(stated.max()):.3g} %"
    )


def impossible_table(table: Table, measured: Mapping[str, float]) -> str:
    """The same of a table, at any of its loads: its sensitivities move it two standard deviations.

    Columns that are exchanged, or another unit of frequency, show here.
    """
    far = []
    for name, ln_f, own, bias in zip(
        table.modes, table.ln_f, table.sensitivities, table.bias, strict=True
    ):
        if name in measured:
            miss = np.abs(ln_f - np.log(measured[name])) - 2.0 * np.abs(own) @ table.std
            nearest = float(np.exp(ln_f[int(np.argmin(miss))]))
            there = measured[name]
            if miss.min() > FACTOR * bias:
                text = f"{nearest:.4g} Hz for {name} at {there:.4g} Hz ({_off(nearest / there)})"
                far.append((float(miss.min() / bias), text, float(bias)))
    if not far:
        return ""
    _, text, bias = max(far)
    return (
        f"{table.structure or 'the table'} cannot be of this specimen: at none of its loads does "
        f"it come nearer to the measured frequencies than {text}, where {FACTOR:g} times its "
        f"stated error of {100 * bias:.2g} % would be {100 * FACTOR * bias:.3g} %"
    )


def _off(ratio: float) -> str:
    """How far a frequency is off, per cent while that is a small number."""
    return f"{100.0 * (ratio - 1.0):+.3g} %" if 0.5 < ratio < 2.0 else f"{ratio:.3g} times it"


def _box(surface: Surface | Solved) -> Float[ndarray, "point coordinate"]:
    """A grid of the model's whole box."""
    size = len(surface.low)
    count = _GRID if isinstance(surface, Surface) else (*[_SOLVED] * (size - 1), 2)
    axes = [np.linspace(a, b, n) for a, b, n in zip(surface.low, surface.high, count, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, size)


def _nearest(
    surface: Surface | Solved,
    points: Float[ndarray, "point coordinate"],
    grid: Float[ndarray, "point mode"],
    choice: tuple[int, ...],
    target: Float[ndarray, " chosen"],
    stated: Float[ndarray, " chosen"],
) -> tuple[float, Float[ndarray, " chosen"]]:
    """Largest miss over the stated error at the box's nearest point, and ln f of the modes there.

    A grid's cells are wider than the errors: from its best points the nearest is looked for.
    """
    columns = list(choice)
    off = (grid[:, columns] - target) / stated
    worst = np.abs(off).max(axis=1)
    at = int(np.argmin(worst))
    if worst[at] <= FACTOR:
        return float(worst[at]), grid[at, columns]
    wide = surface.high - surface.low
    free = np.flatnonzero(wide > 0.0)
    found = []
    for start in np.argsort((off**2).sum(axis=1))[:_STARTS]:
        place = points[start].copy()

        def seen(part: ndarray, place: ndarray = place) -> tuple[ndarray, ndarray]:
            place[free] = surface.low[free] + part * wide[free]
            value, slope = ln_frequencies(surface, place[None])
            return value[0, columns], slope[0, columns][:, free] * wide[free]

        first = ((points[start] - surface.low) / np.where(wide > 0.0, wide, 1.0))[free]
        end = least_squares(
            lambda part: (seen(part)[0] - target) / stated,
            first,
            lambda part: seen(part)[1] / stated[:, None],
            bounds=(0.0, 1.0),
        )
        found.append((float(np.abs(end.fun).max()), target + end.fun * stated))
    return min(found, key=lambda one: one[0])
