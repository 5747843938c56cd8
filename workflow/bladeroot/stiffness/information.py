"""Expected information of a further measurement: how well ln kn and ln kt would be known with it.

Fisher's, at the MAP estimate, with the design changed. Nothing is measured; it says how much better
(ln kn, ln kt) would be known, were the model as it is thought to be.
"""

from dataclasses import replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.inference.gaussian import Fit, information
from bladeroot.inference.problem import Prior
from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.levels import Levels
from bladeroot.stiffness.model import LevelModel, problem_of
from bladeroot.variables import dataset


def expected_information(
    model: LevelModel, fit: Fit, force: float, extra: Surface, names: tuple[str, ...]
) -> xr.Dataset:
    """Expected std of ln kn, ln kt at an axial force (N) as measured, and with one thing better.

    extra: surface of further modes, `names`; each would be measured where the mode with the most
    levels was, with that mode's errors, on the same clampings, and has a bias of the model of its
    own, as large as the others' on average.
    """
    theta = fit.parameters
    biases = tuple(name for name in model.names if name.startswith(("bias_", "tilt_")))
    gauge = ("force_offset", "force_gain")
    better = scaled(model, biases, 0.2)
    both = scaled(better, gauge, 0.1)
    more = replace(model, levels=replace(model.levels, clampings=9.0 * model.levels.clampings))
    cases = {
        "as measured": (model, theta),
        "force gauge ten times better": (scaled(model, gauge, 0.1), theta),
        "model's frequencies five times better": (better, theta),
        "nine times the clampings": (more, theta),
        "gauge and model better": (both, theta),
    }
    for k, name in enumerate(names):
        one = Surface(extra.coefficients[k : k + 1], extra.low, extra.high)
        cases[f"mode {name} measured too"] = _with_mode(model, theta, one, name)
        cases[f"mode {name}, gauge and model better"] = _with_mode(both, theta, one, name)
    covariances = np.array(
        [covariance_of_k(changed, point, fit.scales, force) for changed, point in cases.values()]
    )
    std = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))

    made = {
        "worth_ln_std": std,
        "worth_combination_std": np.sqrt(np.linalg.eigvalsh(covariances)),
        "worth_correlation": covariances[:, 0, 1] / std.prod(axis=1),
        "option": list(cases),
        "stiffness": ["kn", "kt"],
        "combination": ["stiff", "sloppy"],
    }
    return dataset("stiffness/joint", made)


def covariance_of_k(
    model: LevelModel, theta: ndarray, scales: ndarray, force: float
) -> Float[ndarray, "2 2"]:
    """Covariance of (ln kn, ln kt) at an axial force (N), by expected information at a point."""
    rows = model.stiffness_rows(np.array([force]))[0]
    return rows @ np.linalg.solve(information(problem_of(model), theta, scales), rows.T)


def scaled(model: LevelModel, names: tuple[str, ...], factor: float) -> LevelModel:
    """The model with wider or narrower priors of some parameters."""
    std = model.prior.std * np.where(np.isin(model.names, names), factor, 1.0)
    return replace(model, prior=Prior(model.prior.mean, std))


def _with_mode(
    model: LevelModel, theta: ndarray, surface: Surface, name: str
) -> tuple[LevelModel, ndarray]:
    """The model with another mode, and the point in it; its measured values do not matter."""
    levels, prior = model.levels, model.prior
    like = int(np.bincount(levels.mode).argmax())
    own = np.flatnonzero(levels.mode == like)
    number = len(levels.modes)

    def grown(values: ndarray) -> ndarray:
        return np.concatenate([values, values[own]])

    more = Levels(
        (*levels.modes, name),
        np.concatenate([levels.mode, np.full(len(own), number)]),
        *(grown(values) for values in (
            levels.force, levels.ln_frequency, levels.std, levels.clamping, levels.clampings
        )),
        np.append(levels.clamping_std, levels.clamping_std[like]),
        np.append(levels.clamping_freedom, 0.0),
    )  # fmt: skip
    first = len(model.law.parameters)
    places = [first + number, first + 2 * number]  # behind the other modes' biases, and their tilts
    usual = [float(np.sqrt(np.mean(prior.std[place - number : place] ** 2))) for place in places]
    coefficients = np.concatenate([model.surface.coefficients, surface.coefficients])
    grown_model = replace(
        model,
        surface=replace(surface, coefficients=coefficients),
        levels=more,
        names=tuple(
            np.insert(np.array(model.names, object), places, [f"bias_{name}", f"tilt_{name}"])
        ),
        prior=Prior(np.insert(prior.mean, places, 0.0), np.insert(prior.std, places, usual)),
    )
    return grown_model, np.insert(theta, places, 0.0)
