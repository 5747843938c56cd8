"""The parametric reduced model as it is read: frequencies over (ln k..., load).

For each named mode it holds a small basis with an error bound (`ritz`). Of two stiffnesses it holds
ln f as a sum of Chebyshev polynomials (`chebyshev`), too, the fast way to values and gradients; of
other numbers of them the small problem itself is solved wherever it is asked for (`Solved`): a grid
in five dimensions would take more solutions than any inference asks for. The model is made by
`parametric_build`.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.rom import chebyshev
from bladeroot.rom.chebyshev import Surface
from bladeroot.rom.ritz import Pairs, Ritz, frequency, solve, turning

# The matrices of a mode's small problem, as the artifact and `Ritz` name them; springs beside them.
PROJECTED = ("beam", "slots", "geometric", "beam_mass", "contact", "display", "residual")


def spring_names(count: int) -> tuple[str, ...]:
    """Of each contact stiffness the name of its projection's factor: gap and slip by interface."""
    return ("gap", "slip") if count == 2 else tuple(f"spring_{k + 1}" for k in range(count))


def surface_of(model: xr.Dataset) -> Surface:
    """ln f (Hz) of each mode, in the order of `mode`, as Chebyshev sums."""
    return Surface(model["ln_frequency"].values, *model["box"].values)


def ritz_of(model: xr.Dataset, mode: str) -> Ritz:
    """The projected problem of one mode: error bound, shapes, perturbations."""
    if mode not in model["mode"].values:
        raise ValueError(f"the parametric model has modes {list(model['mode'].values)}, not {mode}")
    one = model.sel(mode=mode)
    counts = {name: int(one[name]) for name in ("vectors", "own", "rank")}
    springs = spring_names(len(model["coordinate"]) - 1)
    vectors, parts = counts["vectors"], (3 + len(springs)) * counts["own"]
    kept = {"vector": vectors, "vector_": vectors, "part": parts, "part_": parts}
    here = one.isel({dim: slice(count) for dim, count in kept.items()})
    return Ritz(
        springs=tuple(here[name].values for name in springs),
        **{name: here[name].values for name in PROJECTED},
        display_x=model["display_x"].values,
        own=counts["own"],
        rank=counts["rank"],
        amplification=float(one["amplification"]),
    )


def frequencies(
    surface: Surface, points: Float[ndarray, "point 3"]
) -> Float[ndarray, "point mode"]:
    """Frequencies (Hz) at points (ln kn, ln kt, F). ValueError outside the box."""
    return np.exp(chebyshev.evaluate(surface, points)[0])


@dataclass(frozen=True)
class Solved:
    """The modes' own small problems, solved at every point; `low` and `high`: the box."""

    ritzes: tuple[Ritz, ...]
    low: Float[ndarray, " coordinate"]
    high: Float[ndarray, " coordinate"]


def solved_of(model: xr.Dataset) -> Solved:
    """Of every mode in the order of `mode`."""
    return Solved(tuple(ritz_of(model, str(m)) for m in model["mode"].values), *model["box"].values)


def ln_frequencies(
    model: Surface | Solved, points: Float[ndarray, "point coordinate"]
) -> tuple[Float[ndarray, "point mode"], Float[ndarray, "point mode coordinate"]]:
    """ln f (Hz) and its gradient by (ln k..., load); straight on outside the box.

    NaN where a point is not finite, as a search's step may go beyond what a law can be of.
    """
    inside = _inside(model, points)
    if isinstance(model, Surface):
        value, slope = chebyshev.evaluate(model, inside, order=1)
    else:
        rows = [_solved(one, inside)[1:] for one in model.ritzes]
        value, slope = (np.stack(part, axis=1) for part in zip(*rows, strict=True))
    return value + np.einsum("pma,pa->pm", slope, points - inside), slope


def ln_frequency(
    model: Surface | Solved,
    mode: Int[ndarray, " point"],
    points: Float[ndarray, "point coordinate"],
) -> tuple[
    Float[ndarray, " point"],
    Float[ndarray, "point coordinate"],
    Callable[[], Float[ndarray, "point coordinate coordinate"]],
]:
    """The same of one mode at each point, and what makes its second derivatives: none outside."""
    inside = _inside(model, points)
    if isinstance(model, Surface):
        value, slope = chebyshev.evaluate(model, inside, 1, mode)

        def made() -> ndarray:
            return chebyshev.evaluate(model, inside, 2, mode)[-1]

    else:
        value, slope, made = _of_modes(model, mode, inside)

    def second() -> ndarray:
        bend = made()
        bend[inside != points] = 0.0
        return bend

    return value + (slope * (points - inside)).sum(axis=1), slope, second


def _of_modes(
    model: Solved,
    mode: Int[ndarray, " point"],
    points: Float[ndarray, "point coordinate"],
) -> tuple[ndarray, ndarray, Callable[[], ndarray]]:
    value, slope, parts = np.empty(len(points)), np.empty(points.shape), []
    for k, ritz in enumerate(model.ritzes):
        mine = np.flatnonzero(mode == k)
        found, value[mine], slope[mine] = _solved(ritz, points[mine])
        parts.append((ritz, mine, found))

    def second() -> ndarray:
        made = np.empty((*points.shape, points.shape[1]))
        for ritz, mine, found in parts:
            made[mine] = _curvature(ritz, points[mine], found, slope[mine])
        return made

    return value, slope, second


def _curvature(
    ritz: Ritz, points: Float[ndarray, "point coordinate"], found: Pairs, slope: ndarray
) -> Float[ndarray, "point coordinate coordinate"]:
    """Second derivatives of ln f of one mode."""
    moved, turned = turning(ritz, points, found)
    made = np.einsum("pvc,pvd->pcd", moved, turned) / found.value[:, None, None]
    stiffness = np.arange(points.shape[1] - 1)
    made[:, stiffness, stiffness] += slope[:, :-1]  # by ln k as by k once more
    return made - 2.0 * slope[:, :, None] * slope[:, None, :]


def _inside(model: Surface | Solved, points: ndarray) -> ndarray:
    """Points moved into the box."""
    return np.where(np.isfinite(points), np.clip(points, model.low, model.high), model.low)


def _solved(
    ritz: Ritz, points: Float[ndarray, "point coordinate"]
) -> tuple[Pairs, Float[ndarray, " point"], Float[ndarray, "point coordinate"]]:
    """Eigenpairs of one mode, ln f, and its gradient by Rayleigh's quotient (5.16, in log k)."""
    found, own = solve(ritz, points), slice(0, ritz.own)
    parts = [
        k * ((found.shape @ rows[own, own].T) ** 2).sum(axis=1)
        for k, rows in zip(np.exp(points[:, :-1].T), ritz.springs, strict=True)
    ]
    parts.append(((found.shape @ ritz.geometric[own, own]) * found.shape).sum(axis=1))
    slope = 0.5 * np.stack(parts, axis=1) / found.value[:, None]
    return found, np.log(frequency(found.value)), slope
