"""What a further measurement would be worth: the expected doubt of ln kn and ln kt with it.

Fisher's information at the mode of the posterior, with the design changed. Nothing is measured; it
says how much better (ln kn, ln kt) would be known, were the model as it is thought to be.
"""

from dataclasses import replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.laws import Law
from bladeroot.stiffness.levels import Levels
from bladeroot.stiffness.posterior import Problem, local


def stiffness_rows(
    law: Law, parameters: int, force: Float[ndarray, " force"]
) -> Float[ndarray, "force 2 parameter"]:
    """Derivatives of (ln kn, ln kt) at axial forces by all parameters in their own units."""
    rows = np.zeros((len(force), 2, parameters))
    rows[:, :, : len(law.parameters)] = np.einsum("fb,kbt->fkt", law.functions(force), law.matrix)
    return rows


def worth(
    problem: Problem,
    theta: Float[ndarray, " parameter"],
    force: float,
    extra: Surface,
    names: tuple,
) -> xr.Dataset:
    """Expected std of ln kn, ln kt at an axial force (N) as measured, and with one thing better.

    extra: surface of further modes, `names`; each would be measured where the mode with the most
    levels was, with that mode's errors, on the same clampings, and has a bias of the model of its
    own, as large as the others' on average.
    """
    biases = tuple(name for name in problem.names if name.startswith(("bias_", "tilt_")))
    gauge = ("force_offset", "force_gain")
    better = _scaled(problem, biases, 0.2)
    both = _scaled(better, gauge, 0.1)
    cases = {
        "as measured": (problem, theta),
        "force gauge ten times better": (_scaled(problem, gauge, 0.1), theta),
        "model's frequencies five times better": (better, theta),
        "nine times the clampings": (
            replace(problem, levels=replace(problem.levels, holds=9.0 * problem.levels.holds)),
            theta,
        ),
        "gauge and model better": (both, theta),
    }
    for k, name in enumerate(names):
        one = Surface(extra.coefficients[k : k + 1], extra.low, extra.high)
        cases[f"mode {name} measured too"] = _with_mode(problem, theta, one, name)
        cases[f"mode {name}, gauge and model better"] = _with_mode(both, theta, one, name)
    std, combined, correlation = [], [], []
    for changed, point in cases.values():
        here = local(changed, (point - changed.mean) / changed.std)
        covariance = np.linalg.inv(here.information)
        rows = stiffness_rows(problem.law, len(point), np.array([force]))[0] * changed.std
        of_k = rows @ covariance @ rows.T
        std.append(np.sqrt(np.diag(of_k)))
        combined.append(np.sqrt(np.linalg.eigvalsh(of_k)))
        correlation.append(of_k[0, 1] / np.sqrt(of_k[0, 0] * of_k[1, 1]))

    def var(dims, values, text: str) -> tuple:
        return (dims, np.array(values), {"units": "1", "long_name": text})

    return xr.Dataset(
        {
            "worth_ln_std": var(
                ("option", "stiffness"), std, "expected standard deviation of ln k at 12 kN"
            ),
            "worth_combination_std": var(
                ("option", "combination"), combined, "the same of the stiff and sloppy combination"
            ),
            "worth_correlation": var("option", correlation, "expected correlation"),
        },
        coords={
            "option": list(cases), "stiffness": ["kn", "kt"], "combination": ["stiff", "sloppy"],
        },
    )  # fmt: skip


def _scaled(problem: Problem, names: tuple[str, ...], factor: float) -> Problem:
    std = problem.std * np.where(np.isin(problem.names, names), factor, 1.0)
    return replace(problem, std=std)


def _with_mode(
    problem: Problem, theta: ndarray, surface: Surface, name: str
) -> tuple[Problem, ndarray]:
    """The problem with another mode, and the point in it; its measured values do not matter."""
    levels = problem.levels
    like = int(np.bincount(levels.mode).argmax())
    own = np.flatnonzero(levels.mode == like)
    number = len(levels.modes)

    def grown(values: ndarray) -> ndarray:
        return np.concatenate([values, values[own]])

    more = Levels(
        (*levels.modes, name),
        np.concatenate([levels.mode, np.full(len(own), number)]),
        *(grown(values) for values in (
            levels.force, levels.ln_frequency, levels.std, levels.clamping, levels.holds
        )),
        np.append(levels.hold_std, levels.hold_std[like]),
        np.append(levels.hold_freedom, 0.0),
    )  # fmt: skip
    first = len(problem.law.parameters)
    places = [first + number, first + 2 * number]  # behind the other modes' biases, and their tilts
    usual = [float(np.sqrt(np.mean(problem.std[place - number : place] ** 2))) for place in places]
    return replace(
        problem,
        surface=Surface(
            np.concatenate([problem.surface.coefficients, surface.coefficients]),
            surface.low,
            surface.high,
        ),
        levels=more,
        names=(
            *problem.names[: places[0]],
            f"bias_{name}",
            *problem.names[places[0] : places[1]],
            f"tilt_{name}",
            *problem.names[places[1] :],
        ),
        mean=np.insert(problem.mean, places, 0.0),
        std=np.insert(problem.std, places, usual),
    ), np.insert(theta, places, 0.0)
