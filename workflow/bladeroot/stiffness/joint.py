"""kn and kt over all axial forces at once, from every measured stick frequency.

Each force by itself has two frequencies for two unknowns. Together they have a law to obey, and the
errors that they share (the model's bias, the gauge) are told apart from those that they do not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from bladeroot.inference.gaussian import Fit
from bladeroot.rom.chebyshev import Surface, trimmed
from bladeroot.rom.parametric import surface_of
from bladeroot.stiffness.information import expected_information, scaled
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.laws import LAWS
from bladeroot.stiffness.levels import from_force, levels_of
from bladeroot.stiffness.model import LevelModel, level_model, map_estimate
from bladeroot.stiffness.posterior import STIFFNESS, Law, posterior
from bladeroot.stiffness.priors import PRIORS, REFERENCE_FORCE, SCATTER
from bladeroot.variables import dataset

_DROPPED_ODDS = np.log(20.0)  # nats of evidence below the best law, at which a law is dropped


def joint(
    model: xr.Dataset,
    stick: xr.Dataset,
    gauge: ForceGauge,
    forces: Sequence[float],
    fe_bias: Mapping[str, float],
    fe_offset: Mapping[str, float] | None = None,
    least_force: float = 0.0,
) -> xr.Dataset:
    """Posterior of (ln kn, ln kt) under every law, and in full under `freest` of them.

    model: from `bladeroot.rom.parametric`. stick: from `bladeroot.pooling.stick`. forces: N,
    where kn and kt are wanted. fe_bias, fe_offset: standard deviation and known part of the model's
    relative error in frequency, by mode; modes without one are not used. least_force: N, below
    which contact is not full and frequencies are left out.

    Without stick frequencies of two modes (from `least_force` up) the result is empty and its
    `law` is "". Raises ValueError if a mode of `fe_bias` is not in the model.
    """
    if len(measured_modes(stick, fe_bias, least_force)) < 2:
        return xr.Dataset(attrs={"structure": model.attrs["structure"], "law": ""})
    models = models_of(model, stick, gauge, fe_bias, fe_offset, least_force)
    fits = {name: map_estimate(one) for name, one in models.items()}
    best = freest(fits)
    found = posterior_of(models, fits, best, forces)
    modes = models[best].levels.modes
    _, extra, others = surfaces_of(model, modes)
    parts = [
        found,
        expected_information(models[best], fits[best], REFERENCE_FORCE, extra, others),
        _variations(models[best], fits[best], stick),
    ]
    whole = xr.merge(parts, compat="equals", join="exact", combine_attrs="drop_conflicts")
    return whole.assign_attrs(
        structure=model.attrs["structure"],
        springs=model.attrs["springs"],
        least_force_N=least_force,
        force_error=gauge.primary,
        error_bound=float(model["error_bound"].sel(mode=list(modes)).max()),
        **found.attrs,
    )


def measured_modes(
    stick: xr.Dataset, fe_bias: Mapping[str, float], least_force: float
) -> tuple[str, ...]:
    """The modes of `fe_bias` with a stick frequency; one alone does not fix kn and kt."""
    known = np.isfinite(stick["frequency"].values) & (stick["force"].values >= least_force)
    return tuple(mode for mode in fe_bias if mode in stick["mode"].values.astype(str)[known])


def models_of(
    model: xr.Dataset,
    stick: xr.Dataset,
    gauge: ForceGauge,
    fe_bias: Mapping[str, float],
    fe_offset: Mapping[str, float] | None = None,
    least_force: float = 0.0,
) -> dict[str, LevelModel]:
    """The model under every law of stiffness; arguments and errors as of `joint`.

    Raises ValueError if there is no stick frequency from `least_force` up, too.
    """
    missing = set(measured_modes(stick, fe_bias, -np.inf)) - set(model["mode"].values)
    if missing:
        raise ValueError(f"the parametric model lacks modes {', '.join(sorted(missing))}")
    modes = measured_modes(stick, fe_bias, least_force)
    if not modes:
        raise ValueError(f"no stick frequency at {least_force:g} N or above")
    surface, _, _ = surfaces_of(model, modes)
    levels = from_force(levels_of(stick, modes), least_force)
    bias = np.array([fe_bias[mode] for mode in modes])
    offset = np.array([(fe_offset or {}).get(mode, 0.0) for mode in modes])
    full_scale = gauge.primary == "full-scale"
    errors = (gauge.full_scale_std if full_scale else 0.0, gauge.relative_std)
    return {
        name: level_model(surface, levels, law, bias, offset, errors) for name, law in LAWS.items()
    }


def freest(fits: Mapping[str, Fit]) -> str:
    """The law with most parameters among those that the evidence does not drop.

    Under too simple a law kn and kt look better known than they are, and such a law often has the
    highest evidence. A law twenty times less probable than the best is dropped.
    """
    best = max(fit.log_evidence for fit in fits.values())
    kept = {name: fit for name, fit in fits.items() if fit.log_evidence > best - _DROPPED_ODDS}
    return max(kept, key=lambda name: (kept[name].parameters.size, kept[name].log_evidence))


def posterior_of(
    models: Mapping[str, LevelModel], fits: Mapping[str, Fit], law: str, forces: Sequence[float]
) -> xr.Dataset:
    """Every law beside the others, and one in full."""
    model = models[law]
    levels = model.levels
    highest = min(1.05 * levels.force.max(), float(model.surface.high[2]))
    measured = {
        "mode": np.array(levels.modes)[levels.mode],
        "force": levels.force,
        "ln_frequency": levels.ln_frequency,
    }
    laws = {name: law_of(models[name], fit) for name, fit in fits.items()}
    return posterior(laws, law, forces, (float(levels.force.min()), highest), measured)


def law_of(model: LevelModel, fit: Fit) -> Law:
    """A law's fit with the names of its parameters and the origins of their priors."""
    other = {"force_offset": "the gauge's accuracy", "force_gain": "the gauge's accuracy"}
    origins = tuple(
        PRIORS[name][2] if name in PRIORS else other.get(name, "search.fe_bias_percent")
        for name in model.names
    )
    return Law(fit, model.ln_k, (*model.names, "ln_scatter"), (*origins, SCATTER[2]))


def surfaces_of(
    model: xr.Dataset, modes: tuple[str, ...]
) -> tuple[Surface, Surface, tuple[str, ...]]:
    """Surfaces of the modes that are used and of the others, of one size, and the others' names."""
    others = tuple(str(mode) for mode in model["mode"].values if mode not in modes)
    every = trimmed(surface_of(model.sel(mode=[*modes, *others])))
    used, rest = np.split(every.coefficients, [len(modes)])
    return replace(every, coefficients=used), replace(every, coefficients=rest), others


def _variations(model: LevelModel, fit: Fit, stick: xr.Dataset) -> xr.Dataset:
    """k at 12 kN and the std of ln k (Laplace) when an assumption is changed."""
    biases = tuple(name for name in model.names if name.startswith(("bias_", "tilt_")))
    gauge = tuple(name for name in model.names if name.startswith("force_"))
    cases = {
        "as reported": model,
        "model's bias half as large": scaled(model, biases, 0.5),
        "model's bias twice as large": scaled(model, biases, 2.0),
        "prior of kn, kt twice as wide": scaled(model, ("ln_kn", "ln_kt"), 2.0),
        "gauge without error": scaled(model, gauge, 1e-3),
    }
    every = levels_of(stick, model.levels.modes)
    if len(every.force) > len(model.levels.force):
        cases["all forces"] = replace(model, levels=every)
    elif len(np.unique(every.mode[every.force >= REFERENCE_FORCE])) == len(every.modes):
        cases["forces from 12 kN up"] = replace(model, levels=from_force(every, REFERENCE_FORCE))
    at = np.array([REFERENCE_FORCE])
    found = [
        law_of(one, fit if one is model else map_estimate(one, (-0.4, 0.4)))
        for one in cases.values()
    ]
    made = {
        "variation_k": [one.k for one in found],
        "variation_ln_std": [np.sqrt(np.diag(one.covariance(at)[0])) for one in found],
        "variation": list(cases),
        "stiffness": list(STIFFNESS),
    }
    return dataset("stiffness/joint", made)
