"""Contact stiffness over all axial forces, and the law it follows (Table 5.2, figs 5.15, 5.16)."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.stiffness.grid_search import FLANK_NODES
from bladeroot.stiffness.priors import REFERENCE_FORCE
from bladeroot.variables import dataset, registered

DETERMINED = ("root", "fit")  # status of a search whose frequencies alone give kn and kt
FEWEST_DETERMINED = 3  # such searches that a law of two parameters needs
_TABLES = ("stiffness/search", "stiffness/grid_search")
_LEFT_OUT = {"root", "grid_axis_kn", "grid_axis_kt"}  # variables with these dims are of one search
_LEAST_LN_STD = 1e-6  # of ln k, for the weights of the law's fit


def summarise(
    searches: Mapping[str, Sequence[xr.Dataset]],
    fe_forces: xr.Dataset,
    published: xr.Dataset | None = None,
) -> xr.Dataset:
    """All searches side by side, dims structure and force, with the joint law of each structure.

    searches: by structure, one Dataset of `bladeroot.stiffness.search` per axial force.
    fe_forces: where their targets came from. published: Table 5.2, from
    `bladeroot.reproduction.published`. The law is k = k_ref (F / 12 kN)^p, fitted to ln k.
    Raises ValueError when a structure has two searches at one force.
    """
    lines = [_of_structure(name, parts) for name, parts in searches.items()]
    whole = xr.concat(lines, "structure", join="outer", combine_attrs="override").sortby("force")
    whole["structure"] = whole["structure"].astype(str)
    status = whole["status"].fillna("no measurement").astype(str)
    whole["status"] = status.assign_attrs(whole["status"].attrs)
    whole = whole.assign(_counted(whole))
    laws = xr.concat(
        [_laws(whole.sel(structure=name), fe_forces) for name in whole["structure"].values],
        whole["structure"],
    )
    parts = [whole, laws]
    if published is not None:
        named = published.rename({name: f"published_{name}" for name in published.data_vars})
        parts.append(named.reindex(force=whole["force"].values))
    merged = xr.merge(parts, compat="equals", join="exact", combine_attrs="drop_conflicts")
    merged["force"].attrs = registered("stiffness/summary")["force"][1]
    return merged.assign_attrs(
        force_error=fe_forces.attrs["primary_force_error"], reference_force_N=REFERENCE_FORCE
    )


def _of_structure(name: str, parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """All forces of a structure, without the list of all roots and the thesis's grid."""
    forces = [float(part.attrs["axial_force"]) for part in parts]
    if len(set(forces)) != len(forces):
        raise ValueError(f"structure {name}: two searches at one force among {sorted(forces)} N")
    listed = {name: dims for table in _TABLES for name, (dims, _) in registered(table).items()}
    kept = {name for name, dims in listed.items() if not _LEFT_OUT & set(dims)}
    kept.add("bonded_frequency")
    chosen = [
        part[[n for n in part.variables if n in kept]].drop_attrs(deep=False) for part in parts
    ]
    line = xr.concat(chosen, xr.Variable("force", forces), data_vars="all", join="outer")
    return line.expand_dims(structure=[name])


def _counted(whole: xr.Dataset) -> dict[str, xr.DataArray]:
    """Roots, and totals shared equally among the thesis's 33 nodes (eq. 6.16)."""
    made = {f"{name}_nodal": whole[name] / FLANK_NODES for name in ("kn", "kt")}
    made["root_count"] = (whole["status"] == "root").sum("force")
    known = registered("stiffness/summary")
    return {name: value.assign_attrs(known[name][1]) for name, value in made.items()}


def power_law(
    force: Float[ndarray, " force"],
    ln_stiffness: Float[ndarray, " force"],
    measured: Float[ndarray, "force force"],
    shared: Float[ndarray, "force force"],
) -> tuple[Float[ndarray, " 2"], Float[ndarray, "2 2"], float]:
    """Weighted fit of ln k = ln k_ref + p ln(F/12 kN): (ln k_ref, p), its covariance, the scatter.

    measured: covariance of ln k from the measurement; its diagonal gives the weights. shared:
    covariance from the model's bias, which is one and the same for all forces: it moves the law
    without scattering about it, so it takes no part in the weights. Where the points scatter more
    than their errors allow, the measured part of the covariance grows with it. The scatter is the
    root mean square of the residuals in ln k.
    """
    x = np.log(force / REFERENCE_FORCE)
    design = np.column_stack([np.ones_like(x), x])
    weight = 1.0 / np.maximum(np.diag(measured), _LEAST_LN_STD**2)
    estimator = np.linalg.solve(design.T @ (weight[:, None] * design), design.T * weight)
    law = estimator @ ln_stiffness
    residual = ln_stiffness - design @ law
    excess = max(1.0, float(residual @ (weight * residual)) / (len(x) - 2))
    covariance = estimator @ (excess * measured + shared) @ estimator.T
    return law, covariance, float(np.sqrt(np.mean(residual**2)))


def _laws(line: xr.Dataset, fe_forces: xr.Dataset) -> xr.Dataset:
    """The laws of one structure; NaN with fewer than `FEWEST_DETERMINED` searches."""
    good = np.flatnonzero(np.isin(line["status"].values, DETERMINED))
    names = ("kn", "kt")
    law, std, scatter = np.full((2, 2), np.nan), np.full((2, 2), np.nan), np.full(2, np.nan)
    if len(good) >= FEWEST_DETERMINED:
        here = line.isel(force=good).transpose("force", ...)
        measured, shared = _joint_covariances(here, fe_forces)
        for i, name in enumerate(names):
            ln_k = np.log(here[name].values)
            parts = (measured[:, i, :, i], shared[:, i, :, i])
            law[i], covariance, scatter[i] = power_law(here["force"].values, ln_k, *parts)
            std[i] = np.sqrt(np.diag(covariance))
    made = {}
    for i, name in enumerate(names):
        made |= {
            f"{name}_law_reference": np.exp(law[i, 0]),
            f"ln_{name}_law_reference_std": std[i, 0],
            f"{name}_law_exponent": law[i, 1],
            f"{name}_law_exponent_std": std[i, 1],
            f"{name}_law_scatter": scatter[i],
        }
    return dataset("stiffness/summary", made)


def _joint_covariances(
    here: xr.Dataset, fe_forces: xr.Dataset
) -> tuple[Float[ndarray, "force 2 force 2"], Float[ndarray, "force 2 force 2"]]:
    """Covariance of ln k between forces, from shared measurements and from the shared bias."""
    modes = [str(mode) for mode in here["mode"].values]
    inverse = np.nan_to_num(here["gain"].transpose("force", "stiffness", "mode").values)
    chosen = fe_forces["frequency_covariance"].sel(
        force_error=fe_forces.attrs["primary_force_error"], mode=modes
    )
    place = [int(np.argmin(np.abs(fe_forces["force"].values - f))) for f in here["force"].values]
    scale = 1.0 + np.nan_to_num(here["fe_offset"].transpose("mode", "force").values)
    frequency = (
        np.nan_to_num(chosen.values)[:, place][:, :, place] * scale[:, :, None] * scale[:, None, :]
    )
    measured = np.einsum("fkm,mfg,glm->fkgl", inverse, frequency, inverse)
    target = here["target_frequency"].transpose("force", "mode").values * scale.T
    bias = np.nan_to_num(here["fe_bias_std"].transpose("force", "mode").values * target)
    gain = inverse * bias[:, None, :]
    return measured, np.einsum("fkm,glm->fkgl", gain, gain)
