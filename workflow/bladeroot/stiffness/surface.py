"""The model of one structure at one force, as the searches see it: f of each mode over (kn, kt)."""

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.chebyshev import Surface, evaluate

MODES = ("1B", "2B")  # that the source uses and every map holds


def surface_of_map(drawn: xr.Dataset) -> Surface:
    """The model at the map's force: ln f of each mode over (ln kn, ln kt)."""
    force = drawn.attrs["axial_force"]
    low, high = np.log(drawn["map_kn"].values[[0, -1]])
    return Surface(
        drawn["ln_frequency"].values[..., None],
        np.array([low, low, force]),
        np.array([high, high, force]),
    )


def all_frequencies(
    surface: Surface, log_stiffness: Float[ndarray, "point 2"]
) -> tuple[Float[ndarray, "point mode"], Float[ndarray, "point mode 2"]]:
    """Frequencies of every mode and their Jacobian by (ln kn, ln kt) (eq. 5.16, in log k)."""
    force = np.full((len(log_stiffness), 1), surface.low[2])
    value, slope = evaluate(surface, np.hstack([log_stiffness, force]), order=1)
    f = np.exp(value)
    return f, f[..., None] * slope[:, :, :2]
