"""The thesis's own search as a whole: equal nodal springs, all forces, its Tables 5.1 and 5.2.

`grid_search` is done at every force on a model with equal nodal springs, and the thesis's error
propagation (5.22) is repeated at the points of its Table 5.2.
"""

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.chebyshev import Surface, at_force
from bladeroot.rom.parametric import surface_of
from bladeroot.stiffness.grid_search import FLANK_NODES, grid_search
from bladeroot.stiffness.search import ln_covariance
from bladeroot.stiffness.surface import MODES, all_frequencies
from bladeroot.variables import dataset


def thesis_search(
    model: xr.Dataset,
    fe_forces: xr.Dataset,
    published: xr.Dataset,
    published_std: Float[ndarray, "force mode"],
    fe_error: Float[ndarray, " mode"],
) -> xr.Dataset:
    """Solution sets, the points of minimum error, and the errors of Table 5.2 computed anew.

    model: parametric, with equal nodal springs. fe_forces: from
    `bladeroot.stiffness.interpolation`; its errors with 1 % of reading are used, which
    Table 5.1 needs. published: Table 5.2, from `bladeroot.contact.published`. published_std: of
    Table 5.1, Hz, at its forces. fe_error: relative errors of the model's frequencies; the thesis
    has some and does not say which.
    """
    surface = surface_of(model.sel(mode=list(MODES)))
    forces = fe_forces["force"].values
    here = fe_forces.sel(force_error="reading", mode=list(MODES)).transpose("force", ...)
    target = here["frequency"].transpose("force", "mode").values
    std = here["frequency_std"].transpose("force", "mode").values
    known = np.isfinite(target).all(axis=1)
    found, drawn, chosen = [], [], np.full(target.shape, np.nan)
    for f in np.flatnonzero(known):
        cut = at_force(surface, float(forces[f]))
        one = grid_search(cut, target[f], std[f], fe_error * target[f])
        found.append(one)
        axis = np.log(one["grid_axis_kn"].values)
        mesh = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
        drawn.append(all_frequencies(cut, mesh)[0].T.reshape(len(MODES), len(axis), len(axis)))
        point = np.array([[float(one["grid_kn"]), float(one["grid_kt"])]])
        if np.isfinite(point).all():
            chosen[f] = all_frequencies(cut, np.log(point))[0][0]
    made = {
        "force": forces[known],
        "mode": list(MODES),
        "stiffness": ["kn", "kt"],
        "grid_frequency": np.array(drawn),
        "target_frequency": target[known],
        "target_std": std[known],
        "chosen_frequency": chosen[known],
        "fe_error": fe_error,
        **table_deltas(surface, published, published_std, fe_error),
    }
    ours = dataset("reproduction/thesis_search", made)
    parts = xr.concat(found, ours["force"].variable).drop_attrs(deep=False)
    return parts.merge(ours, compat="equals", join="exact").assign_attrs(
        structure=model.attrs["structure"], springs=model.attrs["springs"]
    )


def table_deltas(
    surface: Surface,
    published: xr.Dataset,
    published_std: Float[ndarray, "force mode"],
    fe_error: Float[ndarray, " mode"],
) -> dict[str, ndarray]:
    """Standard deviations of nodal kn and kt at Table 5.2's points from Table 5.1's errors (5.22).

    `table_std` counts the measurement alone, as the thesis does, `table_bias_std` the model's error
    alone; both in N/m a node. `table_frequency` is what the model has at those points.
    """
    k = np.column_stack([published["kn_total"].values, published["kt_total"].values])
    std, bias, frequency = np.empty(k.shape), np.empty(k.shape), np.empty((len(k), len(fe_error)))
    for row, force in enumerate(published["force"].values):
        cut = at_force(surface, float(force))
        f, jacobian = all_frequencies(cut, np.log(k[row : row + 1]))
        both = ln_covariance(jacobian[0], f[0], published_std[row], fe_error)
        spreads = np.sqrt(np.diagonal(both, axis1=1, axis2=2)) * k[row] / FLANK_NODES
        std[row], bias[row], frequency[row] = spreads[0], spreads[1], f[0]
    printed = np.column_stack([published["kn_nodal_std"].values, published["kt_nodal_std"].values])
    return {
        "table_force": published["force"].values,
        "table_printed_std": printed,
        "table_std": std,
        "table_bias_std": bias,
        "table_frequency": frequency,
    }
