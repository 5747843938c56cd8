"""Contact stiffness of one assembly from the frequencies measured at its force (sections 5.2, 5.3).

Two frequencies fix two unknowns exactly, so nothing is left over to tell how well the model fits;
all uncertainty is that of the frequencies. Measured ones have the errors of 5.14, the model's a
bias that is the same for all forces. Both go into the covariance of (ln kn, ln kt), and, as the map
bends and ends at bonded contact, into draws that may have no root at all. With a further mode there
is a chi-square; with one mode alone the prior decides what that mode does not tell.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float
from numpy import ndarray
from scipy.special import ndtri

from bladeroot.inference.least_squares import (
    FE_BIAS,
    LEAST_PROBABILITY,
    StiffnessFit,
    fit_stiffness,
    ln_range,
)
from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.grid_search import grid_search
from bladeroot.stiffness.roots import all_roots, nearest_point, newton
from bladeroot.stiffness.surface import MODES, all_frequencies, surface_of_map
from bladeroot.variables import dataset

SOURCES = ("measurement", "finite elements")
QUANTILES = (0.16, 0.5, 0.84)
STIFFNESS = ("kn", "kt")
_FEWEST_ROOTS = 20  # draws with a root; of fewer no quantiles are given
_EDGE_WIDTH = 1e-3  # of ln k: a point nearer to the box's edge counts as on it


def search(
    frequency_map: xr.Dataset,
    fe_forces: xr.Dataset,
    fe_bias: Mapping[str, float] | None = None,
    fe_offset: Mapping[str, float] | None = None,
    draws: int = 400,
) -> xr.Dataset:
    """Flank stiffness kn and kt that give the measured frequencies at the map's axial force.

    frequency_map: from `bladeroot.stiffness.map`. fe_forces: from
    `bladeroot.stiffness.interpolation`; its primary force error is used. fe_bias: standard
    deviation of the model's bias per mode, as a fraction of frequency. fe_offset: the part of that
    bias that is known, model over truth less one (zero unless given). draws: simulated errors.

    `status` is "root", "no root" (no stiffness in the box gives the pair: kn and kt are NaN and
    `needed_bias` says how far the model's frequencies would have to move), "fit" (more than two
    modes: weighted least squares with `chi_square` and each mode's `misfit`), "prior" (one mode:
    kn and kt are the MAP estimate, and `ln_kn_std`, `ln_kt_std` have the prior's doubt in them) or
    "no measurement". The modes are 1B, 2B and those that were measured besides.
    Of several roots the one with the smallest covariance of ln k is `kn`, `kt`; all are kept.
    Raises ValueError for a bias that is not positive or missing for a mode.
    """
    every = [str(mode) for mode in frequency_map["mode"].values]
    force = frequency_map.attrs["axial_force"]
    measured = _measured(fe_forces, every, force)
    usable = np.isfinite(measured["target_frequency"]) & np.isfinite(measured["target_std"])
    more = [m for m, known in zip(every, usable, strict=True) if known and m not in MODES]
    modes = [m for m in every if m in (*MODES, *more)]
    place = [every.index(mode) for mode in modes]
    measured = {name: values[place] for name, values in measured.items()}
    frequency_map, known = frequency_map.sel(mode=modes), usable[place]
    bias = np.array([(fe_bias or dict.fromkeys(modes, FE_BIAS)).get(m, np.nan) for m in modes])
    if not np.all(bias > 0.0):
        raise ValueError(f"fe_bias must be positive for modes {modes}, got {fe_bias}")
    offset = np.array([(fe_offset or {}).get(m, 0.0) for m in modes])
    target = measured["target_frequency"] * (1.0 + offset)  # what the model should give
    std = measured["target_std"] * (1.0 + offset)
    surface = surface_of_map(frequency_map)
    drawn = frequency_map["map_frequency"].values
    log_axis = np.log(frequency_map["map_kn"].values)
    pair = len(modes) == 2 and bool(known.all())
    roots = all_roots(surface, target, drawn, log_axis) if pair else np.empty((0, 2))
    rootless = pair and not len(roots)
    fitted = None
    if known.any() and not pair:
        fitted = fit_modes(surface, target, std, bias, known, log_axis)
    parts = [
        _said(measured | {"fe_bias_std": bias, "fe_offset": offset, "mode": modes}),
        _estimate(surface, roots, fitted, target, std, bias, known, modes),
        _miss(surface, target, std, bias, drawn, log_axis, modes, rootless),
        _scatter(surface, target, std, bias, drawn, log_axis, draws if pair else 0, fitted),
        _grid(surface, target, std, bias) if known[: len(MODES)].all() else xr.Dataset(),
        frequency_map[["map_frequency", "bonded_frequency"]],
    ]
    if fitted is not None:
        status = "fit" if known.sum() > 2 else "prior"
    else:
        status = "root" if len(roots) else "no root" if pair else "no measurement"
    parts.append(_said({"status": status}))
    whole = xr.merge(parts, compat="equals", join="exact", combine_attrs="drop_conflicts")
    return whole.assign_attrs(
        structure=frequency_map.attrs["structure"],
        axial_force=force,
        force_error=fe_forces.attrs["primary_force_error"],
        map_largest_relative_error=frequency_map.attrs["largest_relative_error"],
        box_low=float(np.exp(log_axis[0])),
        box_high=float(np.exp(log_axis[-1])),
    )


def fit_modes(
    surface: Surface,
    target: Float[ndarray, " mode"],
    std: Float[ndarray, " mode"],
    bias: Float[ndarray, " mode"],
    known: Bool[ndarray, " mode"],
    log_axis: Float[ndarray, " k"],
) -> StiffnessFit:
    """Weighted least squares of the modes that are known; the prior is as wide as the box.

    target, std: Hz. bias: fraction. log_axis: of the box, in ln k.
    """

    def frequencies(ln_k: ndarray) -> tuple[ndarray, ndarray, bool]:
        inside = np.clip(ln_k, log_axis[0], log_axis[-1])
        f, jacobian = all_frequencies(surface, inside[None])
        slope = jacobian[0] / f[0][:, None]
        value = np.log(f[0]) + slope @ (ln_k - inside)
        return value[known], slope[known], bool((inside == ln_k).all())

    total = np.hypot(std / target, bias)[known]
    prior = ln_range(*np.exp(log_axis[[0, -1]]), 2)
    return fit_stiffness(frequencies, np.log(target[known]), total, prior)


def _grid(surface, target, std, bias) -> xr.Dataset:
    """The source's search, of its two modes."""
    own = slice(0, len(MODES))
    two = Surface(surface.coefficients[own], surface.low, surface.high)
    return grid_search(two, target[own], std[own], (bias * target)[own])


def _measured(fe_forces: xr.Dataset, modes: list[str], force: float) -> dict[str, ndarray]:
    """Targets at one force, NaN where the campaign has none."""
    names = {"target_frequency": "frequency", "target_std": "frequency_std"}
    names |= {name: name for name in ("lower_force", "upper_force")}
    close = np.flatnonzero(np.isclose(fe_forces["force"].values, force, rtol=1e-9))
    if len(close) == 0:
        return {name: np.full(len(modes), np.nan) for name in names}
    here = fe_forces.isel(force=int(close[0])).sel(force_error=fe_forces.primary_force_error)
    here = here.reindex(mode=modes)
    return {name: here[original].values for name, original in names.items()}


def ln_covariance(
    jacobian: Float[ndarray, "mode 2"],
    target: Float[ndarray, " mode"],
    std: Float[ndarray, " mode"],
    bias: Float[ndarray, " mode"],
) -> Float[ndarray, "source 2 2"]:
    """Covariance of (ln kn, ln kt) from the measurement and from the model's bias (eq. 5.22).

    jacobian: by (ln kn, ln kt), Hz. target, std: Hz. bias: fraction. As many frequencies as
    unknowns, so (J^T S^-1 J)^-1 is J^-1 S J^-T. Both frequencies rise with both stiffnesses in
    nearly the same proportion, hence a correlation close to -1.
    """
    inverse = np.linalg.inv(jacobian)
    return np.stack([inverse @ np.diag(s**2) @ inverse.T for s in (std, bias * target)])


def _said(values: Mapping[str, object]) -> xr.Dataset:
    return dataset("stiffness/search", values)


def _estimate(surface, roots, fitted, target, std, bias, known, modes) -> xr.Dataset:
    """The chosen root or the fit with its covariance, and all roots."""
    count, none = len(roots), np.full(len(modes), np.nan)
    jacobians = all_frequencies(surface, roots)[1] if count else np.empty((0, len(modes), 2))
    parts = np.array([ln_covariance(j, target, std, bias) for j in jacobians]).reshape(-1, 2, 2, 2)
    whole = parts.sum(axis=1)
    jacobian, covariance = np.full((len(modes), 2), np.nan), np.full((2, 2, 2), np.nan)
    gain, misfit, chosen, total = jacobian.T.copy(), none, np.full(2, np.nan), None
    if count:
        best = int(np.argmin(np.trace(whole, axis1=1, axis2=2)))
        chosen, jacobian, covariance = np.exp(roots[best]), jacobians[best], parts[best]
        gain, misfit = np.linalg.inv(jacobian), np.zeros(len(modes))
    elif fitted is not None:
        found, misfit = fitted.fit, none.copy()
        chosen, total = np.exp(found.parameters), found.covariance
        jacobian[known] = found.state.slope * target[known, None]
        gain[:, known], misfit[known] = fitted.gain / target[known], fitted.misfit
        held = np.where(known, gain, 0.0)
        spreads = (np.nan_to_num(s) for s in (std, bias * target))
        covariance = np.stack([(held * s**2) @ held.T for s in spreads])
    if total is None:
        total = covariance.sum(axis=0)
    with np.errstate(invalid="ignore"):  # a source without error has no correlation
        correlations = [c[0, 1] / np.sqrt(c[0, 0] * c[1, 1]) for c in (*covariance, total)]
    made = {
        "ln_covariance": covariance,
        "correlation": correlations[2],
        "correlation_by_source": correlations[:2],
        "jacobian": jacobian,
        "gain": gain,
        "misfit": misfit,
        "chi_square": np.nan if fitted is None else fitted.chi_square,
        "freedom": 0 if fitted is None else max(fitted.freedom, 0),
        "probability": np.nan if fitted is None or fitted.freedom < 1 else fitted.probability,
        "fits": int(fitted is None or fitted.probability >= LEAST_PROBABILITY),
        "source": list(SOURCES),
        "stiffness": list(STIFFNESS),
        "mode": modes,
    }
    for i, name in enumerate(STIFFNESS):
        made |= {
            name: chosen[i],
            f"ln_{name}_std": np.sqrt(total[i, i]),
            f"root_{name}": np.exp(roots[:, i]),
            f"root_ln_{name}_std": np.sqrt(whole[:, i, i]),
        }
    return _said(made)


def _miss(surface, target, std, bias, drawn, log_axis, modes, rootless) -> xr.Dataset:
    """How far the model's frequencies would have to move for a root; zero where one exists."""
    needed, edge = target * 0.0, 0
    if rootless:
        spread = np.hypot(std, bias * target)
        point = nearest_point(surface, target, spread, drawn, log_axis)
        near = all_frequencies(surface, point[None])[0][0]
        needed = target / near - 1.0
        edge = int(np.any(np.abs(point[:, None] - log_axis[[0, -1]]) < _EDGE_WIDTH))
    return _said({"needed_bias": needed, "needed_bias_at_edge": edge, "mode": modes})


def _scatter(
    surface: Surface, target, std, bias, drawn, log_axis, draws: int, fitted: StiffnessFit | None
) -> xr.Dataset:
    """Roots of targets drawn with all errors: how many exist, and where they lie; of a fit its
    normal distribution's quantiles.
    """
    share, quantiles = np.nan, np.full((2, len(QUANTILES)), np.nan)
    if draws:
        noise = np.random.default_rng(20240612).standard_normal((draws, len(target)))
        spread = np.hypot(std, bias * target)
        aims = target + noise * spread
        flat = drawn.reshape(len(target), -1)
        miss = sum(((flat[m] - aims[:, m : m + 1]) / spread[m]) ** 2 for m in range(len(target)))
        start = np.stack(np.unravel_index(np.argmin(miss, axis=1), drawn.shape[1:]), axis=1)
        ends, good = newton(surface, aims, log_axis[start], (log_axis[0], log_axis[-1]))
        share = float(np.mean(good))
        if good.sum() >= _FEWEST_ROOTS:
            quantiles = np.exp(np.quantile(ends[good], QUANTILES, axis=0)).T
    elif fitted is not None:
        spread = np.outer(fitted.fit.std, ndtri(QUANTILES))
        quantiles = np.exp(fitted.fit.parameters[:, None] + spread)
    made = {"root_share": share, "quantile": list(QUANTILES)}
    return _said(made | dict(zip(("kn_quantile", "kt_quantile"), quantiles, strict=True)))
