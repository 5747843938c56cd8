"""The map from contact stiffness to the modes' frequencies at one force (section 5.2.1).

A cut through the parametric model of the structure, checked against the assembly of that force. No
measurement enters it.
"""

import numpy as np
import xarray as xr

from bladeroot.rom.chebyshev import at_force
from bladeroot.rom.joint import bonded_modes, exact_modes, joint_of
from bladeroot.rom.parametric import surface_of
from bladeroot.rom.ritz import frequency
from bladeroot.stiffness.surface import MODES, all_frequencies
from bladeroot.variables import dataset

MAP_POINTS = 60  # of the drawn map along each axis
_CHECK_POINTS = 3  # in the box, at which the map is compared with exact solutions


def frequency_map(model: xr.Dataset, assembly: xr.Dataset) -> xr.Dataset:
    """Frequencies of the model's modes over the box of flank stiffness at the assembly's force.

    model: from `bladeroot.rom.parametric`. assembly: from `bladeroot.rom.assembly`,
    of the same structure.

    The result holds the model at that force (`ln_frequency`), the map on a grid, the frequencies of
    bonded contact (both stiffnesses infinite) and a check of the map against exact solutions of the
    assembly (`check_error`). Raises ValueError if the two are not of one structure, the force lies
    outside the model or it lacks one of 1B and 2B.
    """
    if model.attrs["structure"] != assembly.attrs["structure"]:
        raise ValueError(
            f"model and assembly must be of one structure, got {model.attrs['structure']} and "
            f"{assembly.attrs['structure']}"
        )
    missing = set(MODES) - set(model["mode"].values)
    if missing:
        raise ValueError(f"the parametric model must have modes {MODES}, it lacks {missing}")
    force = assembly.attrs["axial_force"]
    modes = tuple(str(mode) for mode in model["mode"].values)
    surface = at_force(surface_of(model), force)
    axis = np.linspace(surface.low[0], surface.high[0], MAP_POINTS)
    mesh = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    drawn, _ = all_frequencies(surface, mesh)
    joint = joint_of(assembly, equal_nodes=model.attrs["springs"] != "by area")
    shares = np.random.default_rng(2).uniform(size=(_CHECK_POINTS, 2))
    unseen = axis[0] + (axis[-1] - axis[0]) * shares
    exact = [exact_modes(joint, np.append(point, 0.0), modes).values for point in unseen]
    truth = frequency(np.array(exact)).T
    error = all_frequencies(surface, unseen)[0].T / truth - 1.0
    bonded = frequency(bonded_modes(joint, 0.0, modes).values)
    made = {
        "mode": list(modes),
        "map_kn": np.exp(axis),
        "map_kt": np.exp(axis),
        "ln_frequency": surface.coefficients[..., 0],
        "map_frequency": drawn.T.reshape(-1, MAP_POINTS, MAP_POINTS),
        "bonded_frequency": bonded,
        "check_kn": np.exp(unseen[:, 0]),
        "check_kt": np.exp(unseen[:, 1]),
        "check_frequency": truth,
        "check_error": error,
    }
    return dataset("stiffness/map", made).assign_attrs(
        largest_relative_error=float(np.abs(error).max()),
        axial_force=force,
        structure=assembly.attrs["structure"],
        springs=model.attrs["springs"],
        error_bound=float(model["error_bound"].max()),
    )
