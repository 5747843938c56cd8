"""kn and kt over all axial forces at once, from every measured stick frequency.

Each force by itself has two frequencies for two unknowns. Together they have a law to obey, and the
errors that they share (the model's bias, the gauge) are told apart from those that they do not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.chebyshev import Surface
from bladeroot.rom.parametric import surface_of
from bladeroot.stiffness.interpolation import ForceGauge
from bladeroot.stiffness.laws import LAWS, REFERENCE_FORCE, Law
from bladeroot.stiffness.levels import Levels, levels_of
from bladeroot.stiffness.posterior import Problem, predict, problem_of
from bladeroot.stiffness.region import share_within
from bladeroot.stiffness.sampler import STEPS, sample, walkers
from bladeroot.stiffness.summit import Summit, find_summit, freest
from bladeroot.stiffness.worth import stiffness_rows, worth

QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)
COMBINATIONS = ("stiff", "sloppy")
_KEPT = 2000  # draws in the artifact
_CURVE = 60
_PLANE = 80  # points along each axis of the plane of (ln kn, ln kt)
STIFFNESS = ("kn", "kt")


def joint(
    model: xr.Dataset,
    stick: xr.Dataset,
    gauge: ForceGauge,
    forces: Sequence[float],
    fe_bias: Mapping[str, float],
    fe_offset: Mapping[str, float] | None = None,
    least_force: float = 0.0,
    steps: int = STEPS,
    extension: Law | None = None,
) -> xr.Dataset:
    """Posterior of (ln kn, ln kt) under every law, and in full under `freest` of them.

    model: from `bladeroot.rom.parametric`. stick: from `bladeroot.pooling.stick`. forces: N,
    where kn and kt are wanted. fe_bias, fe_offset: standard deviation and known part of the model's
    relative error in frequency, by mode; modes without one are not used. least_force: N, below
    which contact is not full and frequencies are left out. steps: of the sampler. extension: a law
    that a named cause asks for; it is compared with the others, and the result is in full under it.

    Without stick frequencies of two modes (from `least_force` up) the result is empty and its
    `law` is "". Raises ValueError if a mode of `fe_bias` is not in the model.
    """
    if len(measured_modes(stick, fe_bias, least_force)) < 2:
        return xr.Dataset(attrs={"structure": model.attrs["structure"], "law": ""})
    laws = LAWS if extension is None else {**LAWS, extension.name: extension}
    problems = problems_of(model, stick, gauge, fe_bias, fe_offset, least_force, laws)
    summits = {name: find_summit(problem) for name, problem in problems.items()}
    found, summit = posterior_of(
        summits, forces, steps, None if extension is None else extension.name
    )
    modes = summit.problem.levels.modes
    _, extra, others = surfaces_of(model, modes)
    parts = [
        found,
        worth(summit.problem, summit.theta, REFERENCE_FORCE, extra, others),
        _variations(summit, stick, modes, least_force),
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


def problems_of(
    model: xr.Dataset,
    stick: xr.Dataset,
    gauge: ForceGauge,
    fe_bias: Mapping[str, float],
    fe_offset: Mapping[str, float] | None = None,
    least_force: float = 0.0,
    laws: Mapping[str, Law] = LAWS,
) -> dict[str, Problem]:
    """The posterior of every law of stiffness; arguments and errors as of `joint`.

    Raises ValueError if there is no stick frequency from `least_force` up, too.
    """
    missing = set(fe_bias) - set(model["mode"].values)
    if missing:
        raise ValueError(f"the parametric model lacks modes {', '.join(sorted(missing))}")
    modes = measured_modes(stick, fe_bias, least_force)
    if not modes:
        raise ValueError(f"no stick frequency at {least_force:g} N or above")
    surface, _, _ = surfaces_of(model, modes)
    levels = _from(levels_of(stick, modes), least_force)
    bias = np.array([fe_bias[mode] for mode in modes])
    offset = np.array([(fe_offset or {}).get(mode, 0.0) for mode in modes])
    full_scale = gauge.primary == "full-scale"
    errors = (gauge.full_scale_std if full_scale else 0.0, gauge.relative_std)
    return {
        name: problem_of(surface, levels, law, bias, offset, errors) for name, law in laws.items()
    }


def posterior_of(
    summits: Mapping[str, Summit],
    forces: Sequence[float],
    steps: int = STEPS,
    law: str | None = None,
) -> tuple[xr.Dataset, Summit]:
    """Every law beside the others, and in full a given one or `freest` of them.

    The summit is that of the law in full.
    """
    best = law or freest(summits)
    summit = summits[best]
    draws, time = sample(summit, steps=steps)
    parts = [
        _laws(summits),
        _parameters(summit, draws),
        _at_forces(summit, draws, np.asarray(forces, float)),
        _plane(summit, draws),
        _curve(summit, draws, summit.problem.surface.high[2]),
        _levels(summit, draws),
    ]
    whole = xr.merge(parts, compat="equals", join="exact", combine_attrs="drop_conflicts")
    return whole.assign_attrs(
        law=best,
        reference_force_N=REFERENCE_FORCE,
        autocorrelation_steps=time,
        independent_draws=float(walkers(summit.problem) * steps / time),
    ), summit


def surfaces_of(
    model: xr.Dataset, modes: tuple[str, ...]
) -> tuple[Surface, Surface, tuple[str, ...]]:
    """Surfaces of the modes that are used and of the others, of one size, and the others' names."""
    others = tuple(str(mode) for mode in model["mode"].values if mode not in modes)
    every = trimmed(surface_of(model.sel(mode=[*modes, *others])))
    used, rest = np.split(every.coefficients, [len(modes)])
    return replace(every, coefficients=used), replace(every, coefficients=rest), others


def trimmed(surface: Surface, tolerance: float = 1e-5) -> Surface:
    """The surface without trailing coefficients that change no frequency by more than a part of it.

    The posterior asks for a hundred thousand points and does not see a hundred-thousandth.
    """
    c = surface.coefficients
    for axis in (1, 2, 3):
        size = np.abs(c).sum(axis=tuple(k for k in range(1, 4) if k != axis)).max(axis=0)
        tail = size[::-1].cumsum()[::-1]
        c = np.take(c, np.arange(max(2, int((tail > tolerance / 3.0).sum()))), axis=axis)
    return Surface(c, surface.low, surface.high)


def _from(levels: Levels, least_force: float) -> Levels:
    """The levels at or above a force."""
    kept = levels.force >= least_force
    parts = {
        name: getattr(levels, name)[kept]
        for name in ("mode", "force", "ln_frequency", "std", "holds")
    }
    clamping = np.unique(levels.clamping[kept], return_inverse=True)[1]
    return replace(levels, **parts, clamping=clamping)


def ln_stiffness(
    problem: Problem, theta: Float[ndarray, "draw parameter"], force: Float[ndarray, " force"]
) -> Float[ndarray, "draw force 2"]:
    """(ln kn, ln kt) of draws of the parameters at axial forces (N)."""
    weights = problem.law.weights(theta[:, : len(problem.law.parameters)])
    return np.einsum("fb,dkb->dfk", problem.law.functions(force), weights)


def combinations(covariance: Float[ndarray, "2 2"]) -> tuple[ndarray, ndarray]:
    """Std of the stiff and the sloppy combination of (ln kn, ln kt), and their unit weights.

    Rows of the weights are combinations; the weight of larger size is positive.
    """
    values, vectors = np.linalg.eigh(covariance)
    weights = vectors.T
    largest = np.abs(weights).argmax(axis=1)
    return np.sqrt(np.maximum(values, 0.0)), weights * np.sign(weights[[0, 1], largest])[:, None]


def _var(dims, values, units: str, long_name: str, source: str = "") -> tuple:
    attrs = {"units": units, "long_name": long_name}
    return (dims, values, attrs | ({"source": source} if source else {}))


def _laws(summits: Mapping[str, Summit]) -> xr.Dataset:
    rows = {name: [] for name in ("evidence", "ln_k", "std", "correlation", "scatter")}
    for summit in summits.values():
        covariance = _laplace(summit, np.array([REFERENCE_FORCE]))[0]
        std = np.sqrt(np.diag(covariance))
        rows["evidence"].append(summit.log_evidence)
        middle = ln_stiffness(summit.problem, summit.theta[None], np.array([REFERENCE_FORCE]))
        rows["ln_k"].append(middle[0, 0])
        rows["std"].append(std)
        rows["correlation"].append(covariance[0, 1] / std.prod())
        rows["scatter"].append(np.exp(summit.theta[-1]))
    of_k = ("law", "stiffness")
    return xr.Dataset(
        {
            "log_evidence": _var("law", rows["evidence"], "1", "log evidence of a law (Laplace)"),
            "law_k": _var(of_k, np.exp(rows["ln_k"]), "N/m", "k at 12 kN by a law, most probable"),
            "law_ln_std": _var(
                of_k, rows["std"], "1", "standard deviation of ln k there (Laplace)"
            ),
            "law_correlation": _var("law", rows["correlation"], "1", "correlation there"),
            "law_scatter": _var("law", rows["scatter"], "1", "scatter of ln k about a law"),
        },
        coords={"law": list(summits), "stiffness": list(STIFFNESS)},
    )


def _laplace(summit: Summit, force: Float[ndarray, " force"]) -> Float[ndarray, "force 2 2"]:
    """Covariance of (ln kn, ln kt) by the curvature at the summit."""
    rows = stiffness_rows(summit.problem.law, len(summit.u), force)
    return rows @ summit.theta_covariance @ rows.transpose(0, 2, 1)


def _parameters(summit: Summit, draws: ndarray) -> xr.Dataset:
    problem = summit.problem
    origin = {"force_offset": "the gauge's accuracy", "force_gain": "the gauge's accuracy",
              "ln_scatter": "re-clamping changes k by 2 to 14 %"}  # fmt: skip
    sources = [
        problem.law.priors[name][2]
        if name in problem.law.parameters
        else origin.get(name, "search.fe_bias_percent")
        for name in problem.names
    ]
    return xr.Dataset(
        {
            "prior_mean": _var("parameter", problem.mean, "mixed", "mean of the prior"),
            "prior_std": _var("parameter", problem.std, "mixed", "standard deviation of the prior"),
            "prior_origin": _var("parameter", sources, "", "where the prior comes from"),
            "mode_value": _var("parameter", summit.theta, "mixed", "most probable value"),
            "laplace_std": _var(
                "parameter", np.sqrt(np.diag(summit.theta_covariance)), "mixed",
                "standard deviation by the curvature at the most probable value",
            ),
            "posterior_mean": _var("parameter", draws.mean(axis=0), "mixed", "mean of the draws"),
            "posterior_std": _var(
                "parameter", draws.std(axis=0), "mixed", "standard deviation of the draws"
            ),
        },
        coords={"parameter": list(problem.names)},
    )  # fmt: skip


def _at_forces(summit: Summit, draws: ndarray, forces: ndarray) -> xr.Dataset:
    """Posterior of kn, kt at each wanted force; the sampled one and Laplace's."""
    at = np.append(forces, REFERENCE_FORCE)
    ln_k = ln_stiffness(summit.problem, draws, at)
    covariance = np.array([np.cov(ln_k[:, f].T) for f in range(len(at))])
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    laplace = np.sqrt(np.diagonal(_laplace(summit, at), axis1=1, axis2=2))
    size, weights = zip(*(combinations(one) for one in covariance), strict=True)
    quantile = np.exp(np.quantile(ln_k, QUANTILES, axis=0)).transpose(1, 2, 0)
    step = max(1, len(draws) // _KEPT)
    of_k = ("force", "stiffness")
    entries = {
        "k_quantile": _var((*of_k, "quantile"), quantile[:-1], "N/m", "quantiles of k"),
        "ln_std": _var(of_k, std[:-1], "1", "standard deviation of ln k"),
        "ln_laplace_std": _var(of_k, laplace[:-1], "1", "the same by curvature (Laplace)"),
        "correlation": _var(
            "force", covariance[:-1, 0, 1] / std[:-1].prod(axis=1), "1",
            "correlation of ln kn and ln kt",
        ),
        "combination_std": _var(
            ("force", "combination"), np.array(size)[:-1], "1",
            "standard deviation of the stiff and the sloppy combination of ln kn, ln kt",
        ),
        "combination_weight": _var(
            ("force", "combination", "stiffness"), np.array(weights)[:-1], "1",
            "weights of ln kn, ln kt in it, of unit length",
        ),
        "reference_quantile": _var(
            ("stiffness", "quantile"), quantile[-1], "N/m", "quantiles of k at 12 kN"
        ),
        "reference_draw": _var(
            ("draw", "stiffness"), np.exp(ln_k[::step, -1]), "N/m", "draws of k at 12 kN"
        ),
    }  # fmt: skip
    return xr.Dataset(
        entries,
        coords={
            "force": ("force", forces, {"units": "N", "long_name": "axial force"}),
            "stiffness": list(STIFFNESS),
            "quantile": list(QUANTILES),
            "combination": list(COMBINATIONS),
        },
    )


def _plane(summit: Summit, draws: ndarray) -> xr.Dataset:
    """Regions of (ln kn, ln kt) at 12 kN, by the share of the draws that lie denser."""
    some = draws[:: max(1, len(draws) // _KEPT)]
    ln_k = ln_stiffness(summit.problem, some, np.array([REFERENCE_FORCE]))[:, 0]
    low, high = np.quantile(ln_k, (0.005, 0.995), axis=0)
    margin = 0.2 * (high - low)
    axes = np.linspace(low - margin, high + margin, _PLANE).T
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    share = share_within(ln_k, points.reshape(-1, 2)).reshape(points.shape[:2])
    return xr.Dataset(
        {
            "region_share": _var(
                ("region_kn", "region_kt"), share, "1",
                "share of the posterior in the region of highest density of (ln kn, ln kt) at "
                "12 kN on whose edge the point lies: where it is below 0.95 is the 95 % region",
            )
        },
        coords={
            f"region_{name}": _var(f"region_{name}", np.exp(axis), "N/m", f"{name} of a flank")
            for name, axis in zip(STIFFNESS, axes, strict=True)
        },
    )  # fmt: skip


def _curve(summit: Summit, draws: ndarray, highest: float) -> xr.Dataset:
    levels = summit.problem.levels
    force = np.linspace(levels.force.min(), min(1.05 * levels.force.max(), highest), _CURVE)
    ln_k = ln_stiffness(summit.problem, draws[:: max(1, len(draws) // _KEPT)], force)
    quantile = np.exp(np.quantile(ln_k, QUANTILES, axis=0)).transpose(1, 2, 0)
    dims = ("curve_force", "stiffness", "quantile")
    return xr.Dataset(
        {"curve_quantile": _var(dims, quantile, "N/m", "quantiles of k over axial force")},
        coords={
            "curve_force": ("curve_force", force, {"units": "N", "long_name": "axial force"}),
            "stiffness": list(STIFFNESS),
            "quantile": list(QUANTILES),
        },
    )


def _levels(summit: Summit, draws: ndarray) -> xr.Dataset:
    """What the posterior predicts at every level, for a new clamping, beside what was measured."""
    problem, levels = summit.problem, summit.problem.levels
    chosen = draws[:: max(1, len(draws) // 400)]
    said = predict(problem, (chosen - problem.mean) / problem.std)
    frequency = np.exp(said.ln_frequency)
    share = (said.slope[..., :2] ** 2).sum(axis=2) / levels.holds
    scatter = np.exp(2.0 * chosen[:, -1, None]) * share
    variance = np.var(said.ln_frequency, axis=0) + np.mean(scatter, axis=0) + levels.std**2
    middle = frequency.mean(axis=0)
    misfit = levels.ln_frequency - np.log(middle)
    return xr.Dataset(
        {
            "level_mode": _var("level", np.array(levels.modes)[levels.mode], "", "mode"),
            "level_force": _var("level", levels.force, "N", "axial force as read"),
            "level_frequency": _var(
                "level", np.exp(levels.ln_frequency), "Hz", "measured stick frequency"
            ),
            "level_predicted": _var("level", middle, "Hz", "mean of the posterior's prediction"),
            "level_misfit": _var("level", misfit, "1", "ln of measured over predicted"),
            "level_misfit_std": _var(
                "level", np.sqrt(variance), "1", "standard deviation of a predicted ln frequency"
            ),
        }
    )


def _variations(
    summit: Summit, stick: xr.Dataset, modes: tuple[str, ...], least_force: float
) -> xr.Dataset:
    """ln k at 12 kN and its std (Laplace) when what was assumed is changed."""
    problem = summit.problem
    names = problem.names
    biases = np.array([name.startswith(("bias_", "tilt_")) for name in names])
    levels_k = np.array([name in ("ln_kn", "ln_kt") for name in names])
    gauge = np.array([name.startswith("force_") for name in names])
    cases = {
        "as reported": problem,
        "model's bias half as large": replace(
            problem, std=np.where(biases, 0.5, 1.0) * problem.std
        ),
        "model's bias twice as large": replace(
            problem, std=np.where(biases, 2.0, 1.0) * problem.std
        ),
        "prior of kn, kt twice as wide": replace(
            problem, std=np.where(levels_k, 2.0, 1.0) * problem.std
        ),
        "gauge without error": replace(problem, std=np.where(gauge, 1e-3, 1.0) * problem.std),
    }
    every = levels_of(stick, modes)
    if len(every.force) > len(problem.levels.force):
        cases["all forces"] = replace(problem, levels=every)
    elif len(np.unique(every.mode[every.force >= REFERENCE_FORCE])) == len(modes):
        cases["forces from 12 kN up"] = replace(problem, levels=_from(every, REFERENCE_FORCE))
    at = np.array([REFERENCE_FORCE])
    middle, std = [], []
    for changed in cases.values():
        found = summit if changed is problem else find_summit(changed, (-0.4, 0.4))
        middle.append(np.exp(ln_stiffness(changed, found.theta[None], at)[0, 0]))
        std.append(np.sqrt(np.diag(_laplace(found, at)[0])))
    dims = ("variation", "stiffness")
    return xr.Dataset(
        {
            "variation_k": _var(dims, np.array(middle), "N/m", "most probable k at 12 kN"),
            "variation_ln_std": _var(
                dims, np.array(std), "1", "standard deviation of ln k there (Laplace)"
            ),
        },
        coords={"variation": list(cases), "stiffness": list(STIFFNESS)},
    )
