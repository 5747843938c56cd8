"""The parametric model of a structure with changed stiffness and mass."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.chebyshev_fit import fit
from bladeroot.rom.parametric import frequencies, ritz_of, surface_of
from bladeroot.rom.ritz import Ritz, frequency, solve, stiffness_of
from bladeroot.rom.sensitivity import Change

_CHECK_POINTS = 200  # random ones, at which the sums are compared with solutions
_TOLERANCE = 1e-7  # of ln f, of the sums


def changed_model(model: xr.Dataset, changes: Mapping[str, Change]) -> xr.Dataset:
    """Frequencies over (ln kn, ln kt, F) when each mode's matrices are changed.

    model: from `bladeroot.rom.parametric`. changes: by mode, in that mode's basis. Inside the
    basis the changed problem is solved exactly, with the vectors for perturbations; nothing else of
    the model (projections, bounds of its bases) holds for the changed structure, so it is left out.
    `surface_error`: of the new sums, relative, at random points.
    """
    modes = [str(mode) for mode in model["mode"].values]
    ritzes = [ritz_of(model, mode) for mode in modes]
    low, high = model["box"].values

    def ln_frequency(points: Float[ndarray, "point 3"]) -> Float[ndarray, "mode point"]:
        amounts = np.ones((len(points), 1))
        return np.log([
            changed_frequencies(ritz, points, [changes[mode]], amounts)
            for mode, ritz in zip(modes, ritzes, strict=True)
        ])  # fmt: skip

    surface = fit(ln_frequency, low, high, _TOLERANCE)
    unseen = np.random.default_rng(5).uniform(low, high, (_CHECK_POINTS, 3))
    error = np.abs(np.log(frequencies(surface, unseen)).T - ln_frequency(unseen)).max(axis=1)
    kept = model[["box", "error_bound"]].copy()
    attrs = model["ln_frequency"].attrs
    dims = ("mode", "order_kn", "order_kt", "order_force")
    kept["ln_frequency"] = (dims, surface.coefficients, attrs)
    text = "largest relative error of the sums at random points, changed matrices"
    kept["surface_error"] = ("mode", error, {"units": "1", "long_name": text})
    moved = frequencies(surface, unseen) / frequencies(surface_of(model), unseen) - 1.0
    text = "mean relative change of the frequency over the box"
    kept["frequency_change"] = ("mode", moved.mean(axis=0), {"units": "1", "long_name": text})
    return kept.assign_attrs(model.attrs)


def changed_frequencies(
    ritz: Ritz,
    points: Float[ndarray, "point coordinate"],
    changes: Sequence[Change],
    amounts: Float[ndarray, "point change"],
) -> Float[ndarray, " point"]:
    """Frequency (Hz) with finite amounts of each change; the unchanged shape tells the mode."""
    stiffness = stiffness_of(ritz.beam + ritz.slots, ritz.geometric, ritz.springs, points)
    mass = np.broadcast_to(np.eye(len(ritz.beam)), stiffness.shape).copy()
    for change, amount in zip(changes, amounts.T, strict=True):
        stiffness += amount[:, None, None] * change.stiffness
        mass += amount[:, None, None] * change.mass
    root = np.linalg.inv(np.linalg.cholesky(mass))
    values, shapes = np.linalg.eigh(root @ stiffness @ root.transpose(0, 2, 1))
    before = np.zeros((len(points), len(ritz.beam)))
    before[:, : ritz.own] = solve(ritz, points).shape
    like = np.einsum("piv,pi->pv", root.transpose(0, 2, 1) @ shapes, before)
    place = np.abs(like).argmax(axis=1)
    return frequency(values[np.arange(len(points)), place])
