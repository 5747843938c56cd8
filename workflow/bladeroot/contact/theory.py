"""The artifact of the contact theory: stiffness, profiles and comparison (chapter 6)."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact import compliance
from bladeroot.contact.punch import (
    Array,
    Punch,
    contact_half_width,
    pressure,
    punch_from,
    shear,
)
from bladeroot.contact.punch import stick_half_width as stick_width
from bladeroot.variables import dataset

# The two limits of section 6.5, with T / (mu N), and the ratios of which profiles are shown.
FRICTION_STATES = {"T = 0": 0.0, "T = mu N": 1.0}
LOAD_RATIOS = np.array([0.0, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0])


def normal_force(axial: Array, ratio: Array, angle: float) -> Array:
    """N on each flank, N, under the axial force F_ax = 2 N (sin theta + (T/N) cos theta).

    axial: of one end, N. ratio: T/N. angle: theta between flank and beam axis, rad (section 6.5).
    """
    return axial / (2.0 * (np.sin(angle) + ratio * np.cos(angle)))


def theory(
    parameters: Mapping[str, float],
    axial_forces: Float[ndarray, " force"],
    stiffness: xr.Dataset | None = None,
    published: xr.Dataset | None = None,
) -> xr.Dataset:
    """Contact stiffness by theory against normal and axial force, beside identified values.

    parameters: SI values by name (`bladeroot.contact.punch.PARAMETERS`).
    axial_forces: the FE axial forces, N, positive.
    stiffness: identified flank totals, `kn`(structure, force) and `kt` in N/m, with their
    `ln_kn_std` and `ln_kt_std`; published: from `bladeroot.reproduction.published`. Either may be
    absent. Ratios are identified over theory.
    Raises ValueError for a force that is not positive or a missing parameter.
    """
    forces = np.sort(np.asarray(axial_forces, float))
    if forces.size == 0 or not forces[0] > 0.0:
        raise ValueError(f"axial forces must be positive, got {axial_forces}")
    punch = punch_from(parameters)
    angle = float(parameters["flank_angle"])
    whole = dataset(
        "contact/theory",
        _against_normal_force(punch, punch_from(parameters, "printed"), forces, angle)
        | _against_axial_force(punch, forces, angle)
        | _profiles(punch, float(forces[0]), angle)
        | _sensitivity(punch, float(forces[0]), angle),
    )
    if stiffness is not None:
        whole = _compared(whole, stiffness, "identified", "")
    if published is not None:
        whole = _compared(whole, published, "published", "_total")
    return whole.assign_attrs(
        description="contact theory of a flat punch with rounded edges",
        contact_modulus=punch.contact_modulus,
        profile_axial_force=float(forces[0]),
        **{name: float(parameters[name]) for name in sorted(parameters)},
    )


def _attrs(units: str, long_name: str, source: str = "") -> dict[str, str]:
    attrs = {"units": units, "long_name": long_name}
    return attrs | ({"source": source} if source else {})


def _against_normal_force(
    punch: Punch, printed: Punch, forces: ndarray, angle: float
) -> dict[str, object]:
    """Fine curves over the normal force, up to the largest that the axial forces need."""
    n = np.linspace(0.02, 1.0, 160) * 1.25 * normal_force(forces[-1], 0.0, angle)
    made = {"normal_force": n, "normal_approach": compliance.normal_approach(n, punch)}
    for suffix, one in (("", punch), ("_printed", printed)):
        made[f"contact_half_width{suffix}"] = contact_half_width(n / punch.length, one)
        made[f"kn{suffix}"] = compliance.normal_stiffness(n, one)
        made[f"kt{suffix}"] = compliance.tangential_stiffness(n, one)
    return made


def _against_axial_force(punch: Punch, forces: ndarray, angle: float) -> dict[str, object]:
    """Both friction limits: on a fine axis for curves, and at the FE forces for comparison."""
    fine = np.linspace(0.25 * forces[0], 1.15 * forces[-1], 120)
    made = {"friction_state": list(FRICTION_STATES), "axial_force": fine, "force": forces}
    for suffix, values in (("_of_axial_force", fine), ("_theory", forces)):
        shares = FRICTION_STATES.values()
        n = np.stack([normal_force(values, one * punch.friction, angle) for one in shares])
        made[f"kn{suffix}"] = compliance.normal_stiffness(n.ravel(), punch).reshape(n.shape)
        made[f"kt{suffix}"] = compliance.tangential_stiffness(n.ravel(), punch).reshape(n.shape)
    return made | {"normal_force_theory": n}


def _profiles(punch: Punch, axial: float, angle: float) -> dict[str, object]:
    """Pressure and shear across the contact at one axial force, for rising T/(mu N)."""
    n = normal_force(axial, LOAD_RATIOS * punch.friction, angle)
    load = n / punch.length
    tangential = LOAD_RATIOS * punch.friction * load
    b, c = contact_half_width(load, punch), stick_width(load, tangential, punch)
    x = np.sin(np.linspace(-0.5, 0.5, 401) * np.pi) * b.max()  # dense at the rims
    line, across = load[:, None], tangential[:, None]
    return {
        "load_ratio": LOAD_RATIOS,
        "position": x,
        "pressure": pressure(x[None, :], line, punch),
        "shear": shear(x[None, :], line, across, punch),
        "profile_normal_force": n,
        "profile_contact_half_width": b,
        "profile_stick_half_width": c,
    }


def _sensitivity(punch: Punch, axial: float, angle: float) -> dict[str, object]:
    """Per cent change of the stiffness for one per cent of each parameter, at one axial force."""
    names = ("flat_half_width", "edge_radius", "length", "youngs_modulus", "poisson_ratio")
    step, slopes = 1e-4, {"kn": [], "kt": []}
    n = normal_force(np.array([axial]), 0.0, angle)
    for name in names:
        moved = [
            replace(punch, **{name: getattr(punch, name) * (1.0 + sign * step)})
            for sign in (1.0, -1.0)
        ]
        for k, function in (
            ("kn", compliance.normal_stiffness),
            ("kt", compliance.tangential_stiffness),
        ):
            up, down = (float(function(n, other)[0]) for other in moved)
            slopes[k].append(np.log(up / down) / np.log((1.0 + step) / (1.0 - step)))
    return {"parameter": list(names)} | {f"{k}_sensitivity": np.array(v) for k, v in slopes.items()}


def _compared(whole: xr.Dataset, other: xr.Dataset, label: str, suffix: str) -> xr.Dataset:
    """`other`'s totals on the theory's forces, with their ratio to the theory."""
    chosen = other.reindex(force=whole["force"].values)
    added = {}
    for name, text in (("kn", "normal"), ("kt", "tangential")):
        k = chosen[f"{name}{suffix}"]
        known = {key: k.attrs[key] for key in ("units", "source") if key in k.attrs}
        added[f"{name}_{label}"] = k.assign_attrs(
            known, long_name=f"{label} {text} stiffness of a flank"
        )
        ratio = (k / whole[f"{name}_theory"]).transpose(..., "friction_state", "force")
        ratio.attrs = _attrs("1", f"{label} over theoretical {text} stiffness", "section 6.5")
        added[f"{name}_{label}_ratio"] = ratio
        if label == "published":
            spread = chosen[f"{name}_total_std"] / chosen[f"{name}_total"]
        else:
            spread = chosen[f"ln_{name}_std"]
        spread.attrs = _attrs("1", f"relative standard deviation of the {label} {text} stiffness")
        added[f"{name}_{label}_relative_std"] = spread
    return whole.assign(added)
