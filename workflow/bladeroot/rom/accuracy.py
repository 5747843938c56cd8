"""What reduction and parametric model cost: frequencies against the full model."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.rom.full import FullJoint, full_frequencies
from bladeroot.rom.parametric import frequencies, surface_of
from bladeroot.variables import dataset


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
    made = dataset(
        "rom/accuracy",
        {
            "stiffness": corners,
            "full_frequency": np.array(exact),
            "frequency": np.array(found),
            "residual": np.array(found) / np.array(exact) - 1.0,
        },
    )
    made = made.assign_coords(
        contact=["softest", "stiffest"], mode=names,
        force=("force", np.asarray(forces, float), {"units": "N"}),
    )  # fmt: skip
    return made.assign_attrs(structure=model.attrs["structure"], full_dofs=full.mass.shape[0])
