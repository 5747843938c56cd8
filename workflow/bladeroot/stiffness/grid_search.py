"""The thesis's own search on a grid, kept for comparison (eqs 5.10-5.12 and 5.22-5.24).

Two things in it are known to mislead. The tolerance 5.12 divides by the misfit, 0/0 at an exact
fit; and the smallest covariance 5.23 is found at the softest accepted stiffness, because a soft
contact is a sensitive one, not because it fits best.
"""

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.surface import all_frequencies
from bladeroot.variables import dataset

FLANK_NODES = 33  # nodes of a flank (6.16); the thesis prints the stiffness of one node
NODAL_STIFFNESS = (1e7, 1.5e8)  # N/m, the range searched: 1e4 to 1.5e5 N/mm
GRID_POINTS = 50  # along each axis


def grid_search(
    surface: Surface,
    target: Float[ndarray, " mode"],
    target_std: Float[ndarray, " mode"],
    fe_error: Float[ndarray, " mode"],
) -> xr.Dataset:
    """The accepted points of the thesis's grid and the one with the smallest covariance norm.

    target, target_std, fe_error: Hz. The thesis does not publish its FE error. Stiffness is
    given as flank totals, 33 times the nodal one (eq. 6.16). NaN when no point is accepted.
    """
    axis = np.linspace(*NODAL_STIFFNESS, GRID_POINTS) * FLANK_NODES
    k = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    f, jacobian = all_frequencies(surface, np.log(k))
    miss = np.abs(f - target)
    norm = np.sqrt(np.sum(miss**2, axis=1))
    tolerance = miss @ (target_std + fe_error) / np.maximum(norm, 1e-300)
    accepted = (norm < tolerance) | (norm == 0.0)
    spread = np.maximum(target_std, 1e-9 * target)  # simulated targets may have no error at all
    j = jacobian / k[:, None, :] / spread[:, None]
    inverse = np.linalg.inv(j)
    covariance = inverse @ inverse.transpose(0, 2, 1)
    size = np.where(accepted, np.linalg.norm(covariance, ord=2, axis=(1, 2)), np.inf)
    best = int(np.argmin(size))
    chosen, std = np.full(2, np.nan), np.full(2, np.nan)
    if accepted.any():
        chosen, std = k[best], np.sqrt(np.diag(covariance[best]))
    made = {
        "grid_accepted": accepted.reshape(GRID_POINTS, GRID_POINTS).astype(np.int8),
        "grid_axis_kn": axis,
        "grid_axis_kt": axis,
    }
    for i, name in enumerate(("grid_kn", "grid_kt")):
        made |= {name: chosen[i], f"{name}_std": std[i]}
    return dataset("stiffness/grid_search", made)
