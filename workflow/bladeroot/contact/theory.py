"""The artifact of the contact theory: stiffness, profiles and comparison (chapter 6)."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact import compliance
from bladeroot.contact.loads import FRICTION_STATES, axial_per_normal, normal_force
from bladeroot.contact.punch import Punch, contact_half_width, pressure, punch_from, shear
from bladeroot.contact.punch import stick_half_width as stick_width

LOAD_RATIOS = np.array([0.0, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0])


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
    `ln_kn_std` and `ln_kt_std`; published: from `bladeroot.contact.published`. Either may be
    absent. Ratios are identified over theory.
    Raises ValueError for a force that is not positive or a missing parameter.
    """
    forces = np.sort(np.asarray(axial_forces, float))
    if forces.size == 0 or not forces[0] > 0.0:
        raise ValueError(f"axial forces must be positive, got {axial_forces}")
    punch = punch_from(parameters)
    angle = float(parameters["flank_angle"])
    per_normal = np.array([axial_per_normal(s, punch.friction, angle) for s in FRICTION_STATES])
    parts = [
        _against_normal_force(punch, punch_from(parameters, "printed"), forces, per_normal),
        _against_axial_force(punch, forces, angle),
        _profiles(punch, float(forces[0]), angle),
        _sensitivity(punch, float(forces[0]), angle),
    ]
    whole = xr.merge(parts, compat="equals", combine_attrs="drop_conflicts")
    if stiffness is not None:
        whole = _compared(whole, stiffness, "identified", "")
    if published is not None:
        whole = _compared(whole, published, "published", "_total")
    return whole.assign_attrs(
        description="contact theory of a flat punch with rounded edges",
        contact_modulus=punch.contact_modulus,
        **{name: float(parameters[name]) for name in sorted(parameters)},
    )


def _attrs(units: str, long_name: str, source: str = "") -> dict[str, str]:
    attrs = {"units": units, "long_name": long_name}
    return attrs | ({"source": source} if source else {})


def _against_normal_force(
    punch: Punch, printed: Punch, forces: ndarray, per_normal: ndarray
) -> xr.Dataset:
    """Fine curves over the normal force, up to the largest that the axial forces need."""
    n = np.linspace(0.02, 1.0, 160) * 1.25 * forces[-1] / per_normal.min()

    def var(values: ndarray, long_name: str, source: str, units: str = "N/m") -> tuple:
        return ("normal_force", values, _attrs(units, long_name, source))

    return xr.Dataset(
        {
            "contact_half_width": var(
                contact_half_width(n / punch.length, punch), "contact half-width b", "eq. 6.5", "m"
            ),
            "contact_half_width_printed": var(
                contact_half_width(n / punch.length, printed),
                "contact half-width b with the printed 4PR",
                "eq. 6.5 as printed",
                "m",
            ),
            "normal_approach": var(
                compliance.normal_approach(n, punch), "normal approach", "eq. 6.14", "m"
            ),
            "kn": var(
                compliance.normal_stiffness(n, punch),
                "normal stiffness of a flank, closed form",
                "eq. 6.15 with b of eq. 6.5",
            ),
            "kt": var(
                compliance.tangential_stiffness(n, punch),
                "tangential stiffness of a flank at T = 0, closed form",
                "eq. 6.11 with b of eq. 6.5",
            ),
            "kn_printed": var(
                compliance.normal_stiffness(n, printed),
                "normal stiffness of a flank with the printed 4PR",
                "eq. 6.15 with b of eq. 6.5 as printed",
            ),
            "kt_printed": var(
                compliance.tangential_stiffness(n, printed),
                "tangential stiffness of a flank with the printed 4PR",
                "eq. 6.11 with b of eq. 6.5 as printed",
            ),
        },
        coords={"normal_force": ("normal_force", n, _attrs("N", "normal force on a flank"))},
    )


def _against_axial_force(punch: Punch, forces: ndarray, angle: float) -> xr.Dataset:
    """Both friction limits: on a fine axis for curves, and at the FE forces for comparison."""
    fine = np.linspace(0.25 * forces[0], 1.15 * forces[-1], 120)
    variables = {}
    for axis, values in (("axial_force", fine), ("force", forces)):
        n = np.stack([normal_force(values, s, punch.friction, angle) for s in FRICTION_STATES])
        suffix = "_of_axial_force" if axis == "axial_force" else "_theory"
        dims = ("friction_state", axis)
        for name, function, text in (
            ("kn", compliance.normal_stiffness, "normal"),
            ("kt", compliance.tangential_stiffness, "tangential"),
        ):
            k = function(n.ravel(), punch).reshape(n.shape)
            attrs = _attrs("N/m", f"{text} stiffness of a flank by theory", "eqs 6.11, 6.15")
            variables[name + suffix] = (dims, k, attrs)
        if axis == "force":
            variables["normal_force_theory"] = (
                dims,
                n,
                _attrs("N", "normal force on a flank", "section 6.5"),
            )
    return xr.Dataset(
        variables,
        coords={
            "friction_state": list(FRICTION_STATES),
            "axial_force": ("axial_force", fine, _attrs("N", "axial force")),
            "force": ("force", forces, _attrs("N", "axial force of the FE models")),
        },
    )


def _profiles(punch: Punch, axial: float, angle: float) -> xr.Dataset:
    """Pressure and shear across the contact at one axial force, for rising T/(mu N)."""
    n = axial / (2.0 * (np.sin(angle) + LOAD_RATIOS * punch.friction * np.cos(angle)))
    load = n / punch.length
    tangential = LOAD_RATIOS * punch.friction * load
    b, c = contact_half_width(load, punch), stick_width(load, tangential, punch)
    x = np.sin(np.linspace(-0.5, 0.5, 401) * np.pi) * b.max()  # dense at the rims
    line, across = load[:, None], tangential[:, None]
    profile = ("load_ratio", "position")
    per_ratio = "load_ratio"
    return xr.Dataset(
        {
            "pressure": (
                profile,
                pressure(x[None, :], line, punch),
                _attrs("Pa", "contact pressure across the flank", "eq. 6.4"),
            ),
            "shear": (
                profile,
                shear(x[None, :], line, across, punch),
                _attrs("Pa", "shear traction across the flank", "eqs 6.7-6.9"),
            ),
            "profile_normal_force": (per_ratio, n, _attrs("N", "normal force on the flank")),
            "profile_contact_half_width": (
                per_ratio,
                b,
                _attrs("m", "contact half-width b", "eq. 6.5"),
            ),
            "profile_stick_half_width": (
                per_ratio,
                c,
                _attrs("m", "half-width c of the sticking part", "eq. 6.8"),
            ),
        },
        coords={
            "load_ratio": (per_ratio, LOAD_RATIOS, _attrs("1", "T/(mu N), tangential over limit")),
            "position": ("position", x, _attrs("m", "position across the flank from its middle")),
        },
        attrs={"profile_axial_force": axial},
    )


def _sensitivity(punch: Punch, axial: float, angle: float) -> xr.Dataset:
    """Per cent change of the stiffness for one per cent of each parameter, at one axial force."""
    names = ("flat_half_width", "edge_radius", "length", "youngs_modulus", "poisson_ratio")
    step, slopes = 1e-4, {"kn": [], "kt": []}
    n = normal_force(np.array([axial]), FRICTION_STATES[0], punch.friction, angle)
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
    return xr.Dataset(
        {
            f"{k}_sensitivity": (
                "parameter", np.array(values), _attrs("1", f"d ln {k} / d ln parameter at T = 0")
            )
            for k, values in slopes.items()
        },
        coords={"parameter": list(names)},
    )  # fmt: skip


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
