"""A posterior of (ln kn, ln kt) over the axial force, by draws and by curvature.

In: a fit and the function from its parameters to (ln kn, ln kt). Out: the variables of a joint
artifact that describe the posterior.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.inference.gaussian import Fit
from bladeroot.inference.sampling import DRAWS, Draws, sample
from bladeroot.stiffness.priors import REFERENCE_FORCE
from bladeroot.variables import dataset

QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)
COMBINATIONS = ("stiff", "sloppy")
STIFFNESS = ("kn", "kt")
REGION_SHARES = (0.68, 0.95)  # of the draws, within the regions of (ln kn, ln kt) that are drawn
_BENT_PARAMETERS = (0, 1)  # ln kn and ln kt: along them the posterior bends
_KEPT_DRAWS = 2000  # in the artifact
_LEVEL_DRAWS = 400  # behind a level's prediction
_CURVE_POINTS = 60  # forces of the curve of kn and kt
_PLANE_POINTS = 80  # along each axis of the plane of (ln kn, ln kt)
_TABLE = "stiffness/posterior"

LnStiffness = Callable[[ndarray, ndarray], ndarray]


@dataclass(frozen=True)
class Law:
    """A fit under a law of stiffness.

    ln_k: (ln kn, ln kt) of draws of the parameters at axial forces (N), shape (draw, force, 2).
    names, origins: of the parameters, then the scales; and where their priors come from.
    """

    fit: Fit
    ln_k: LnStiffness
    names: tuple[str, ...]
    origins: tuple[str, ...]

    @property
    def k(self) -> Float[ndarray, " 2"]:
        """kn and kt at the reference force by the MAP estimate, N/m."""
        at = np.array([REFERENCE_FORCE])
        return np.exp(self.ln_k(self.fit.parameters[None], at)[0, 0])

    def covariance(self, force: Float[ndarray, " force"]) -> Float[ndarray, "force 2 2"]:
        """Covariance of (ln kn, ln kt) by the curvature at the MAP estimate (Laplace)."""
        std = self.fit.std
        steps = 1e-4 * np.diag(std)
        ends = self.ln_k(
            np.vstack([self.fit.parameters + steps, self.fit.parameters - steps]), force
        )
        up, down = np.split(ends, 2)
        rows = ((up - down) / (2e-4 * std[:, None, None])).transpose(1, 2, 0)
        return rows @ self.fit.covariance @ rows.transpose(0, 2, 1)


def combinations(covariance: Float[ndarray, "2 2"]) -> tuple[ndarray, ndarray]:
    """Std of the stiff and the sloppy combination of (ln kn, ln kt), and their unit weights.

    Rows of the weights are combinations; the weight of larger size is positive.
    """
    values, vectors = np.linalg.eigh(covariance)
    weights = vectors.T
    largest = np.abs(weights).argmax(axis=1)
    return np.sqrt(np.maximum(values, 0.0)), weights * np.sign(weights[[0, 1], largest])[:, None]


def posterior(
    laws: Mapping[str, Law],
    chosen: str,
    forces: Sequence[float],
    range_N: tuple[float, float],
    levels: Mapping[str, ndarray],
    count: int = DRAWS,
) -> xr.Dataset:
    """Every law beside the others, and the chosen one in full.

    forces: N, where kn and kt are wanted. range_N: of the curve over the force. levels: mode,
    force (N) and ln frequency of the data's first entries. count: of draws.
    """
    law = laws[chosen]
    draws = sample(law.fit, _BENT_PARAMETERS, count)
    parts = [
        _laws(laws),
        _parameters(law, draws),
        _at_forces(law, draws, np.asarray(forces, float)),
        _plane(law, draws),
        _curve(law, draws, np.linspace(*range_N, _CURVE_POINTS)),
        _levels(law, draws, levels),
    ]
    whole = xr.merge(parts, compat="equals", join="exact", combine_attrs="drop_conflicts")
    return whole.assign_attrs(
        law=chosen, reference_force_N=REFERENCE_FORCE, independent_draws=draws.effective
    )


def at_forces(law: Law, forces: Sequence[float]) -> xr.Dataset:
    """What `posterior` says of kn and kt at each wanted force alone; arguments as there."""
    return _at_forces(law, sample(law.fit, _BENT_PARAMETERS), np.asarray(forces, float))


def _some(draws: Float[ndarray, "draw parameter"], count: int) -> ndarray:
    return draws[:: max(1, len(draws) // count)]


def _laws(laws: Mapping[str, Law]) -> xr.Dataset:
    covariance = [law.covariance(np.array([REFERENCE_FORCE]))[0] for law in laws.values()]
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    made = {
        "log_evidence": [law.fit.log_evidence for law in laws.values()],
        "law_k": [law.k for law in laws.values()],
        "law_ln_std": std,
        "law_correlation": [c[0, 1] for c in covariance] / std.prod(axis=1),
        "law_scatter": [np.exp(law.fit.scales[0]) for law in laws.values()],
        "law": list(laws),
        "stiffness": list(STIFFNESS),
    }
    return dataset(_TABLE, made)


def _parameters(law: Law, draws: Draws) -> xr.Dataset:
    fit, problem = law.fit, law.fit.problem
    drawn = np.hstack([draws.parameters, draws.scales])

    made = {
        "prior_mean": np.concatenate([problem.prior.mean, problem.scales.mean]),
        "prior_std": np.concatenate([problem.prior.std, problem.scales.std]),
        "prior_origin": list(law.origins),
        "mode_value": np.concatenate([fit.parameters, fit.scales]),
        "laplace_std": np.concatenate([fit.std, np.sqrt(np.diag(fit.scales_covariance))]),
        "posterior_mean": drawn.mean(axis=0),
        "posterior_std": drawn.std(axis=0),
        "parameter": list(law.names),
    }
    return dataset(_TABLE, made)


def _at_forces(law: Law, draws: Draws, forces: Float[ndarray, " force"]) -> xr.Dataset:
    """kn, kt at each wanted force; by the draws and by curvature."""
    at = np.append(forces, REFERENCE_FORCE)
    ln_k = law.ln_k(draws.parameters, at)
    covariance = np.array([np.cov(ln_k[:, f].T) for f in range(len(at))])
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    laplace = np.sqrt(np.diagonal(law.covariance(at), axis1=1, axis2=2))
    size, weights = zip(*(combinations(one) for one in covariance), strict=True)
    quantile = np.exp(np.quantile(ln_k, QUANTILES, axis=0)).transpose(1, 2, 0)
    made = {
        "k_quantile": quantile[:-1],
        "ln_std": std[:-1],
        "ln_laplace_std": laplace[:-1],
        "correlation": covariance[:-1, 0, 1] / std[:-1].prod(axis=1),
        "combination_std": np.array(size)[:-1],
        "combination_weight": np.array(weights)[:-1],
        "reference_quantile": quantile[-1],
        "reference_draw": np.exp(_some(ln_k[:, -1], _KEPT_DRAWS)),
        "force": forces,
        "stiffness": list(STIFFNESS),
        "quantile": list(QUANTILES),
        "combination": list(COMBINATIONS),
    }
    return dataset(_TABLE, made)


def _plane(law: Law, draws: Draws) -> xr.Dataset:
    """Regions of (ln kn, ln kt) at 12 kN, by the share of the draws that lie denser."""
    ln_k = law.ln_k(_some(draws.parameters, _KEPT_DRAWS), np.array([REFERENCE_FORCE]))[:, 0]
    low, high = np.quantile(ln_k, (0.005, 0.995), axis=0)
    margin = 0.2 * (high - low)
    axes = np.linspace(low - margin, high + margin, _PLANE_POINTS).T
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    share = share_within(ln_k, points.reshape(-1, 2)).reshape(points.shape[:2])
    made = {"region_share": share, "region_kn": np.exp(axes[0]), "region_kt": np.exp(axes[1])}
    return dataset(_TABLE, made)


def _curve(law: Law, draws: Draws, force: Float[ndarray, " force"]) -> xr.Dataset:
    ln_k = law.ln_k(_some(draws.parameters, _KEPT_DRAWS), force)
    quantile = np.exp(np.quantile(ln_k, QUANTILES, axis=0)).transpose(1, 2, 0)
    made = {
        "curve_quantile": quantile,
        "curve_force": force,
        "stiffness": list(STIFFNESS),
        "quantile": list(QUANTILES),
    }
    return dataset(_TABLE, made)


def _levels(law: Law, draws: Draws, levels: Mapping[str, ndarray]) -> xr.Dataset:
    """The posterior's prediction of every level for a new clamping, beside what was measured."""
    problem, own = law.fit.problem, slice(0, len(levels["force"]))
    states = problem.states(_some(draws.parameters, _LEVEL_DRAWS))
    scales = _some(draws.scales, _LEVEL_DRAWS)
    ln_f = np.array([state.mean[own] for state in states])
    scatter = [
        np.diag(problem.covariance(state, one)[0])[own]
        for state, one in zip(states, scales, strict=True)
    ]
    middle = np.exp(ln_f).mean(axis=0)
    made = {
        "level_mode": levels["mode"],
        "level_force": levels["force"],
        "level_frequency": np.exp(levels["ln_frequency"]),
        "level_predicted": middle,
        "level_misfit": levels["ln_frequency"] - np.log(middle),
        "level_misfit_std": np.sqrt(np.var(ln_f, axis=0) + np.mean(scatter, axis=0)),
    }
    return dataset(_TABLE, made)


def share_within(
    draws: Float[ndarray, "draw axis"], points: Float[ndarray, "point axis"]
) -> Float[ndarray, " point"]:
    """Share of the region on whose edge each point lies: every larger region holds the point.

    The valley of (ln kn, ln kt) is bent and can end at the model's box, so that ellipses about a
    mean hold too little. The region of a share is where the density is above the value that this
    share of the draws exceeds. The density is a kernel estimate, which smooths a thin valley to a
    wider one; the share is counted among the draws, and stays right.
    """
    # Resampled draws have copies, which are left out: a draw's density is that of all other draws.
    draws, copies = np.unique(draws, axis=0, return_counts=True)
    weight = copies / copies.sum()
    # Scott's width; a density counts in units of a kernel's peak
    width = (weight**2).sum() ** (1.0 / (draws.shape[1] + 4))
    root = width * np.linalg.cholesky(np.cov(draws.T, aweights=weight))
    places, asked = (np.linalg.solve(root, some.T).T for some in (draws, points))
    own = (_density(places, weight, places) - weight) / (1.0 - weight)
    order = np.argsort(own)
    below = np.concatenate([[0.0], np.cumsum(weight[order])])
    return 1.0 - below[np.searchsorted(own[order], _density(places, weight, asked))]


def _density(
    draws: Float[ndarray, "draw axis"],
    weight: Float[ndarray, " draw"],
    points: Float[ndarray, "point axis"],
) -> Float[ndarray, " point"]:
    """Sum of the draws' unit Gaussian kernels at points."""
    parts = np.array_split(points, 1 + len(points) // 500)  # bounds the memory
    away = (((part[:, None] - draws) ** 2).sum(axis=2) for part in parts)
    return np.concatenate([np.exp(-0.5 * square) @ weight for square in away])
