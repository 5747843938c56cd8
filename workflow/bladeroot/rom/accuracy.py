"""What reduction and parametric model cost: frequencies against the full model."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.rom.full import FullJoint, full_frequencies
from bladeroot.rom.parametric import frequencies, surface_of


def accuracy(full: FullJoint, model: xr.Dataset, forces: Sequence[float]) -> xr.Dataset:
    """Parametric model against the finite-element model with all dofs: `accuracy.nc`.

    At the softest and the stiffest contact of the model's box (kn = kt), at the lowest and the
    highest of the axial forces (N), for each mode of the model. Between them the error changes
    little, stiffness being linear in the force: from 2.6e-6 to 2.9e-6 between 12 and 22 kN. Raises
    ValueError if a force lies outside the box or a mode is not found in the full model.
    """
    surface = surface_of(model)
    forces = sorted({float(min(forces)), float(max(forces))})
    names = [str(name) for name in model["mode"].values]
    corners = np.exp([surface.low[0], surface.high[0]])
    exact, found = [], []
    for k in corners:
        points = np.column_stack([np.full((len(forces), 2), np.log(k)), forces])
        found.append(frequencies(surface, points))
        exact.append(full_frequencies(full, k, k, forces, names))
    dims = ("contact", "force", "mode")
    return xr.Dataset(
        {
            "stiffness": (
                "contact",
                corners,
                {"units": "N/m", "long_name": "normal and tangential stiffness of a flank"},
            ),
            "full_frequency": (
                dims,
                np.array(exact),
                {"units": "Hz", "long_name": "frequency of the model with all dofs"},
            ),
            "frequency": (
                dims,
                np.array(found),
                {"units": "Hz", "long_name": "frequency of the parametric reduced model"},
            ),
            "residual": (
                dims,
                np.array(found) / np.array(exact) - 1.0,
                {"units": "1", "long_name": "parametric over full, minus one"},
            ),
        },
        coords={
            "contact": ["softest", "stiffest"],
            "force": ("force", np.asarray(forces, float), {"units": "N"}),
            "mode": names,
        },
        attrs={"structure": model.attrs["structure"], "full_dofs": full.mass.shape[0]},
    )
