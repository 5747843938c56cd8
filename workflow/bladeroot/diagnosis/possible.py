"""Whether a structure can be the specimen at all, before anything is inferred with it."""

from collections.abc import Mapping
from itertools import combinations

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis.simulation.table import Table
from bladeroot.rom import chebyshev
from bladeroot.rom.parametric import ln_frequencies, solved_of, surface_of

# A structure is the specimen's if some point of its box lies within so many of the model's stated
# errors (0.5 % unless told otherwise, so 5 %). It guards against another machine's structure. The
# shipped dovetails miss the published frequencies by at most 1.7 %; a wrong modulus or an added
# mass, which the diagnosis names, moves modes by some per cent; a 122 Hz beam is 77 % off.
FACTOR = 10.0
_GRID = (17, 17, 7)  # of ln kn, ln kt and the load
_SOLVED = 5  # of each of any number of stiffnesses, where each point is an eigenproblem


def impossible(model: xr.Dataset, measured: Mapping[str, float], error: Mapping[str, float]) -> str:
    """Why a structure cannot be the specimen, one sentence with the numbers, or "".

    model: from `bladeroot.rom.parametric`. measured: frequency (Hz) of each mode; where the
    structure has no mode of a name, modes are taken in the order of their frequencies, in the way
    that suits it best. error: the model's stated relative error by mode.
    """
    if not measured:
        return ""
    names = model["mode"].values.astype(str).tolist()
    grid = _box(model)
    wanted = dict(sorted(measured.items(), key=lambda one: one[1]))
    if set(wanted) <= set(names):
        choices = [tuple(names.index(mode) for mode in wanted)]
    else:
        count = min(len(wanted), len(names))
        choices = list(combinations(range(len(names)), count))
    target = np.log(np.array(list(wanted.values())))[: len(choices[0])]
    stated = np.array([error.get(mode, max(error.values())) for mode in wanted])[: target.size]
    best = min((_miss(grid, choice, target, stated) for choice in choices), key=lambda one: one[0])
    times, point, choice = best
    if times <= FACTOR:
        return ""
    there = np.exp(grid[point, list(choice)])
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


def _box(model: xr.Dataset) -> Float[ndarray, "point mode"]:
    """ln f on a grid of the model's whole box."""
    sums = "ln_frequency" in model
    surface = surface_of(model) if sums else solved_of(model)
    size = len(surface.low)
    count = _GRID if sums else (*[_SOLVED] * (size - 1), 2)
    axes = [np.linspace(a, b, n) for a, b, n in zip(surface.low, surface.high, count, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, size)
    return chebyshev.evaluate(surface, points)[0] if sums else ln_frequencies(surface, points)[0]


def _miss(
    grid: Float[ndarray, "point mode"], choice: tuple[int, ...], target: ndarray, stated: ndarray
) -> tuple[float, int, tuple[int, ...]]:
    """Largest miss over the stated error at the best point, that point, and the modes chosen."""
    off = np.abs(grid[:, list(choice)] - target) / stated
    worst = off.max(axis=1)
    at = int(np.argmin(worst))
    return float(worst[at]), at, choice
