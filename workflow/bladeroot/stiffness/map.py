"""The map from contact stiffness to the modes' frequencies at one force (section 5.2.1).

A cut through the parametric model of the structure, checked against the assembly of that force. The
map knows nothing of measurements.
"""

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.chebyshev import Surface, at_force
from bladeroot.rom.joint import bonded_modes, exact_modes, joint_of
from bladeroot.rom.parametric import frequencies_gradient, surface_of
from bladeroot.rom.ritz import frequency

MODES = ("1B", "2B")  # of the source, and of every map
GRID = 60
_CHECKS = 3


def frequency_map(model: xr.Dataset, assembly: xr.Dataset, grid: int = GRID) -> xr.Dataset:
    """Frequencies of the model's modes over the box of flank stiffness at the assembly's force.

    model: from `bladeroot.rom.parametric`. assembly: from `bladeroot.rom.assembly`,
    of the same structure. grid: points of the drawn map along each axis.

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
    axis = np.linspace(surface.low[0], surface.high[0], grid)
    mesh = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    drawn, _ = all_frequencies(surface, mesh)
    joint = joint_of(assembly, equal_nodes=model.attrs["springs"] != "by area")
    shares = np.random.default_rng(2).uniform(size=(_CHECKS, 2))
    unseen = axis[0] + (axis[-1] - axis[0]) * shares
    exact = [exact_modes(joint, np.append(point, 0.0), modes).values for point in unseen]
    truth = frequency(np.array(exact)).T
    error = all_frequencies(surface, unseen)[0].T / truth - 1.0
    bonded = frequency(bonded_modes(joint, 0.0, modes).values)
    return _as_dataset(
        modes, surface, axis, drawn.T.reshape(-1, grid, grid), bonded, unseen, truth, error
    ).assign_attrs(
        axial_force=force,
        structure=assembly.attrs["structure"],
        springs=model.attrs["springs"],
        error_bound=float(model["error_bound"].max()),
    )


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
    f, gradient = frequencies_gradient(surface, np.hstack([log_stiffness, force]))
    return f, gradient[:, :, :2]


def _as_dataset(modes, surface, axis, drawn, bonded, unseen, truth, error) -> xr.Dataset:
    def var(dims, values, units: str, long_name: str, source: str = "") -> tuple:
        attrs = {"units": units, "long_name": long_name}
        return (dims, values, attrs | ({"source": source} if source else {}))

    k = np.exp(axis)
    return xr.Dataset(
        {
            "ln_frequency": var(
                ("mode", "order_kn", "order_kt"),
                surface.coefficients[..., 0],
                "1",
                "Chebyshev coefficients of ln(f / Hz) over ln k from the least to the largest",
                "eq. 5.4",
            ),
            "map_frequency": var(
                ("mode", "map_kn", "map_kt"), drawn, "Hz", "frequency of the model", "eq. 5.4"
            ),
            "bonded_frequency": var(
                "mode", bonded, "Hz", "frequency with bonded contact (infinite kn and kt)"
            ),
            "check_kn": var("check", np.exp(unseen[:, 0]), "N/m", "normal stiffness of the check"),
            "check_kt": var(
                "check", np.exp(unseen[:, 1]), "N/m", "tangential stiffness of the check"
            ),
            "check_frequency": var(
                ("mode", "check"), truth, "Hz", "exact frequency of the assembly there"
            ),
            "check_error": var(("mode", "check"), error, "1", "relative error of the map there"),
        },
        coords={
            "mode": list(modes),
            "map_kn": var("map_kn", k, "N/m", "normal stiffness of a flank"),
            "map_kt": var("map_kt", k, "N/m", "tangential stiffness of a flank"),
        },
        attrs={"largest_relative_error": float(np.abs(error).max())},
    )
