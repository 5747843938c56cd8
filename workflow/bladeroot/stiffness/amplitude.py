"""kn, kt and friction from stick frequencies and amplitude curves together.

The frequencies fix one combination of kn and kt well. Slip takes tangential springs away: how far
frequency falls and damping rises says how much of the motion goes through them, which is another
combination. The friction's own parameters are found with them and integrated out.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.inference.gaussian import Fit
from bladeroot.nonlinear.fast_loading import softening_curve
from bladeroot.nonlinear.pictures import pictures
from bladeroot.nonlinear.uneven import uneven_sliders
from bladeroot.rom.joint import Joint
from bladeroot.stiffness.curve_fit import CurveFit, fit_curves
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.joint import freest, law_of, measured_modes, models_of, posterior_of
from bladeroot.stiffness.model import LevelModel, map_estimate, predict
from bladeroot.stiffness.posterior import at_forces
from bladeroot.stiffness.priors import FRICTION
from bladeroot.stiffness.simulated_curves import friction_of, level_systems
from bladeroot.stiffness.softening import DISCREPANCY, Softening, of_modes, softening_of
from bladeroot.variables import dataset

_CURVE_AMPLITUDES = np.geomspace(2e-7, 2e-5, 41)  # m, of the curves of all levels (`map_fall`)
_PICTURE_AMPLITUDES = (0.3, 0.6, 1.0)  # of loops and slip, over the largest amplitude measured
_TABLE = "stiffness/amplitude"


def amplitude(
    joint: Joint,
    model: xr.Dataset,
    stick: xr.Dataset,
    seen: xr.Dataset,
    lasers: Mapping[str, float],
    gauge: ForceGauge,
    forces: Sequence[float],
    fe_bias: Mapping[str, float],
    fe_offset: Mapping[str, float] | None = None,
    least_force: float = 0.0,
    discrepancy: float = DISCREPANCY,
) -> xr.Dataset:
    """Posterior of kn, kt with curves, beside that of the frequencies alone under the same law.

    joint: the reduced structure. model, stick, gauge, forces, fe_bias, fe_offset, least_force:
    as of `bladeroot.stiffness.joint.joint`. seen: from `bladeroot.diagnosis.observations`.
    lasers: place along the beam (m), by mode. discrepancy: of the simulated curves, of the largest
    effect.

    The law is `freest` with curves, and the same for the frequencies alone.

    Returns the variables of `joint` without its variations, the friction, the curves measured and
    simulated, and `shrinkage`: the standard deviation of ln k without curves over that with them.
    Modes whose curves cannot be simulated, as where the laser stands at their node, go without;
    `left_out` says which and why. Without curves that soften and can be simulated, or stick
    frequencies of two modes, it is empty, its `law` is "" and its `reason` says why.
    """

    def nothing(reason: str) -> xr.Dataset:
        attrs = {"structure": model.attrs["structure"], "law": "", "reason": reason}
        return xr.Dataset(attrs=attrs)

    if len(measured_modes(stick, fe_bias, least_force)) < 2:
        return nothing("there are stick frequencies of fewer than two modes")
    models = models_of(model, stick, gauge, fe_bias, fe_offset, least_force)
    levels = level_names(next(iter(models.values())))
    softening = softening_of(seen, levels)
    if not len(softening.level):
        return nothing("no record's frequency clearly falls with amplitude")
    alone = {name: map_estimate(one) for name, one in models.items()}
    best = freest(alone)
    refused = _refused(joint, _places(models[best], alone[best]), levels, lasers)
    left_out = "; ".join(f"{mode}: {reason}" for mode, reason in refused.items())
    lasers = {mode: x for mode, x in lasers.items() if mode not in refused}
    softening = of_modes(softening, levels, lasers)
    if not len(softening.level):
        return nothing(left_out)
    try:
        whole = _with_curves(joint, models, alone, softening, levels, lasers, forces, discrepancy)
    except RuntimeError as error:
        return nothing(str(error))
    return whole.assign_attrs(
        structure=model.attrs["structure"], left_out=left_out, discrepancy=discrepancy
    )


def _places(model: LevelModel, fit: Fit) -> Float[ndarray, "level 3"]:
    """(ln kn, ln kt, ln F) of the levels at a fit."""
    return predict(model, fit.parameters[None]).logarithms[0]


def _refused(
    joint: Joint,
    z: Float[ndarray, "level 3"],
    levels: list[tuple[str, float]],
    lasers: Mapping[str, float],
) -> dict[str, str]:
    """Modes of which a level cannot be simulated at a fit's places, and why."""
    modes = [mode for mode, _ in levels]
    systems = level_systems(joint, list(zip(modes, z, strict=True)), lasers)
    return {mode: one for mode, one in zip(modes, systems, strict=True) if isinstance(one, str)}


def _with_curves(
    joint: Joint,
    models: Mapping[str, LevelModel],
    alone: Mapping[str, Fit],
    softening: Softening,
    levels: list[tuple[str, float]],
    lasers: Mapping[str, float],
    forces: Sequence[float],
    discrepancy: float,
) -> xr.Dataset:
    """The inference of `amplitude` where there are points; alone: fits without curves.

    RuntimeError if the curves cannot be simulated at the stiffness that they lead to, or leave no
    posterior.
    """
    best = freest(alone)
    fit = fit_curves(joint, models[best], alone[best], softening, levels, lasers, discrepancy)
    with_curves = {name: replace(model, curves=fit.term) for name, model in models.items()}
    together = {name: map_estimate(model) for name, model in with_curves.items()}
    law = freest(together)
    try:
        found = posterior_of(with_curves, together, law, forces)
    except ValueError as error:  # curves that no stiffness explains leave no posterior to draw from
        raise RuntimeError(f"the posterior with curves cannot be drawn from: {error}") from None
    before = at_forces(law_of(models[law], alone[law]), forces)
    z = _places(with_curves[law], together[law])
    parts = [
        found,
        _gained(before, found),
        _friction(fit),
        _points(softening, levels, fit),
        _simulated(joint, z, levels, lasers, fit, softening),
    ]
    whole = xr.merge(parts, compat="equals", join="exact", combine_attrs="drop_conflicts")
    return whole.assign_attrs(rounds=fit.rounds, converged=int(fit.converged), **found.attrs)


def level_names(model: LevelModel) -> list[tuple[str, float]]:
    """Mode and force as read of every level."""
    levels = model.levels
    return [
        (levels.modes[mode], float(force))
        for mode, force in zip(levels.mode, levels.force, strict=True)
    ]


def _gained(before: xr.Dataset, found: xr.Dataset) -> xr.Dataset:
    """Standard deviations without curves, and by how much they are larger than with them."""
    area = [
        one["ln_std"].prod("stiffness") * np.sqrt(1.0 - one["correlation"] ** 2)
        for one in (before, found)
    ]
    made = {
        "frequencies_ln_std": before["ln_std"].values,
        "frequencies_k_quantile": before["k_quantile"].values,
        "shrinkage": (before["ln_std"] / found["ln_std"]).values,
        "area_shrinkage": (area[0] / area[1]).values,
    }
    return dataset(_TABLE, made).assign_coords(
        {name: found[name] for name in ("force", "stiffness", "quantile")}
    )


def _friction(fit: CurveFit) -> xr.Dataset:
    std = np.sqrt(np.diag(fit.friction_covariance))
    prior = np.array([entry[:2] for entry in FRICTION.values()])
    made = {
        "friction_value": np.exp(fit.friction),
        "friction_ln_std": std,
        "friction_prior": np.exp(prior[:, 0]),
        "friction_prior_ln_std": prior[:, 1],
        "friction_origin": [entry[2] for entry in FRICTION.values()],
        "friction": [name.removeprefix("ln_") for name in FRICTION],
    }
    return dataset(_TABLE, made)


def _points(softening: Softening, levels: list[tuple[str, float]], fit: CurveFit) -> xr.Dataset:
    """Measured and simulated curves at the points that were fitted."""
    (fall, rise), (fall_std, rise_std) = (part.reshape(2, -1) for part in (fit.value, fit.std))
    made = {
        "point_mode": [levels[k][0] for k in softening.level],
        "point_force": [levels[k][1] for k in softening.level],
        "point_amplitude": softening.amplitude,
        "fall": softening.fall,
        "rise": softening.rise,
        "fall_simulated": fall,
        "rise_simulated": rise,
        "fall_std": fall_std,
        "rise_std": rise_std,
    }
    return dataset(_TABLE, made)


def _simulated(
    joint: Joint,
    z: Float[ndarray, "level 3"],
    levels: list[tuple[str, float]],
    lasers: Mapping[str, float],
    fit: CurveFit,
    softening: Softening,
) -> xr.Dataset:
    """Curves of every level on one ladder, and pictures of the level that softens most."""
    law = friction_of(fit.friction)

    shown = [level for level, (mode, _) in enumerate(levels) if mode in lasers]
    systems = dict(
        zip(
            shown,
            level_systems(joint, [(levels[k][0], z[k]) for k in shown], lasers),
            strict=True,
        )
    )

    def made(level: int) -> tuple:
        system = systems[level]
        if isinstance(system, str):
            raise RuntimeError(system)
        return system, uneven_sliders(joint, system, float(np.exp(z[level, 2])), law)

    curves = np.full((2, len(levels), len(_CURVE_AMPLITUDES)), np.nan)
    for level in shown:
        with suppress(RuntimeError):  # beyond what was measured it may not settle
            curves[:, level] = softening_curve(*made(level), _CURVE_AMPLITUDES)[0]
    most = int(softening.level[np.argmin(softening.fall)])
    largest = float(softening.amplitude[softening.level == most].max())
    drawn = pictures(joint, *made(most), [p * largest for p in _PICTURE_AMPLITUDES])
    made = dataset(
        _TABLE, {"map_fall": curves[0], "map_rise": curves[1], "amplitude": _CURVE_AMPLITUDES}
    )
    return made.assign(drawn.variables).assign_attrs(drawn.attrs, picture_force_N=levels[most][1])
