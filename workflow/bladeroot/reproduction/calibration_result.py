"""A calibration from tables to artifact: dimensions, what they predict, tables in contradiction."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.reproduction.calibration import (
    Linear,
    Problem,
    calibrate,
    linearise,
    posterior,
    predict,
)
from bladeroot.reproduction.joint_spread import MODES, JointSpread, joint_spread
from bladeroot.reproduction.parameters import values_in
from bladeroot.reproduction.tension import (
    Incompatible,
    LeftOut,
    incompatible_sets,
    left_out,
    pair_inflation,
)

# The joint's spread is taken at Table 5.2's first force and stiffness (N, N/m a flank).
JOINT = (12.0e3, (33 * 41428.6e3, 33 * 64285.7e3))
# A combination is seen if the tables narrow it to this part of its prior deviation.
_SEEN = 0.99


def calibration(problem: Problem, fitted: Sequence[str], refinements: int = 3) -> xr.Dataset:
    """Fit the tables named by `fitted`, judge all of the problem's: `calibration.nc`.

    ValueError if the fit does not settle or leads to a shape that cannot be.
    """
    point, steps = calibrate(problem.of(fitted))
    linear = linearise(problem, point)
    used = np.isin(problem.tables, fitted)
    _, covariance = posterior(problem, linear, used)
    joint = joint_spread(problem, point, *JOINT)
    parts = [
        _parameters(problem, point, covariance),
        _targets(problem, linear, covariance, used),
        _directions(problem.of(fitted), linear, covariance, used, joint),
        _tables(left_out(problem, linear, fitted), pair_inflation(problem, linear), fitted),
        _sets(problem, incompatible_sets(problem, linear, refinements)),
        _joint(joint, covariance),
    ]
    return xr.merge(parts).assign_attrs(
        structure=problem.start["name"], fitted=", ".join(fitted), steps=steps
    )


def _sizes(problem: Problem) -> Float[ndarray, " parameter"]:
    return np.array([one.unit[1] for one in problem.parameters])


def _parameters(problem: Problem, point: ndarray, covariance: ndarray) -> xr.Dataset:
    std, size = np.sqrt(np.diag(covariance)), _sizes(problem)
    shipped = values_in(problem.start, problem.parameters)
    away = shipped - point

    def of(values: ndarray, label: str) -> tuple:
        return "parameter", values, {"units": "see unit", "long_name": label}

    return xr.Dataset(
        {
            "unit": (
                "parameter",
                [one.unit[0] for one in problem.parameters],
                {"units": "", "long_name": "unit of the parameter"},
            ),
            "most_probable": of(point * size, "most probable value"),
            "std": of(std * size, "posterior standard deviation (Laplace)"),
            "prior_mean": of(problem.prior_mean * size, "prior mean"),
            "prior_std": of(problem.prior_std * size, "prior standard deviation"),
            "shipped": of(shipped * size, "value in the structure file"),
            "shipped_distance": (
                (),
                np.sqrt(away @ np.linalg.solve(covariance, away)),
                {
                    "units": "1",
                    "long_name": "Mahalanobis distance of the structure file from the most "
                    "probable; the square root of the number of parameters is usual",
                },
            ),
            "correlation": (
                ("parameter", "parameter_"),
                covariance / np.outer(std, std),
                {"units": "1", "long_name": "posterior correlation"},
            ),
        },
        coords={"parameter": [one.name for one in problem.parameters]},
    )


def _targets(problem: Problem, linear: Linear, covariance: ndarray, used: ndarray) -> xr.Dataset:
    spread = np.sqrt(np.einsum("ij,jk,ik->i", linear.jacobian, covariance, linear.jacobian))
    residual = (linear.values - problem.reference) / problem.tolerance

    def of(values: object, unit: str, label: str) -> tuple:
        return "target", values, {"units": unit, "long_name": label}

    own = "Hz, or Hz2/N for slopes"
    return xr.Dataset(
        {
            "target_table": of(problem.tables, "", "table of the thesis"),
            "target_mode": of([one.mode for one in problem.targets], "", "mode"),
            "target_force": of([one.case.force for one in problem.targets], "N", "axial force"),
            "target_fitted": of(used.astype(np.int8), "1", "1 where the table was fitted"),
            "target_is_slope": of(
                np.array([one.slope for one in problem.targets], np.int8),
                "1",
                "1 for a slope of f^2 over the force, 0 for a frequency",
            ),
            "reference": of(problem.reference, own, "published value"),
            "tolerance": of(problem.tolerance, own, "standard deviation of model and rounding"),
            "predicted": of(linear.values, own, "value of the model at the most probable geometry"),
            "predicted_std": of(spread, own, "its standard deviation over the posterior"),
            "residual_z": of(residual, "1", "predicted minus published over the tolerance"),
            "jacobian": (
                ("target", "parameter"),
                linear.jacobian / _sizes(problem),
                {"units": "per unit of the parameter", "long_name": "derivative of predicted"},
            ),
        }
    )


def _directions(
    problem: Problem, linear: Linear, covariance: ndarray, used: ndarray, joint: JointSpread
) -> xr.Dataset:
    """Stiffest and sloppiest combination that the fitted tables see, relative to the priors.

    With them how linear the model is, and what they do to the bonded joint.
    """
    part = Linear(linear.point, linear.values[used], linear.jacobian[used])
    scale = problem.prior_std
    variances, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    chosen = [0, int(np.flatnonzero(variances < _SEEN**2)[-1])]
    steps = (axes * np.sqrt(variances)).T[chosen] * scale
    misfit = np.empty((2, 2))
    for row, step in enumerate(steps):
        for column, sign in enumerate((-1, 1)):
            there = linear.point + sign * step
            misfit[row, column] = np.abs(
                (predict(problem, there) - part.at(there)) / problem.tolerance
            ).max()
    return xr.Dataset(
        {
            "direction_step": (
                ("direction", "parameter"),
                steps * _sizes(problem),
                {"units": "see unit", "long_name": "one standard deviation along the combination"},
            ),
            "direction_share": (
                "direction",
                np.sqrt(variances[chosen]),
                {"units": "1", "long_name": "posterior over prior standard deviation"},
            ),
            "direction_error": (
                ("direction", "sign"),
                misfit,
                {
                    "units": "1",
                    "long_name": "largest error of the linear model one standard deviation away, "
                    "over the tolerance",
                },
            ),
            "direction_bonded": (
                ("direction", "joint_mode"),
                steps @ joint.bonded_jacobian.T,
                {"units": "Hz", "long_name": "what the step adds to the bonded frequencies"},
            ),
        },
        coords={"direction": ["stiffest", "sloppiest"], "sign": [-1, 1], "joint_mode": list(MODES)},
    )


def _tables(judged: Sequence[LeftOut], pairs: ndarray, fitted: Sequence[str]) -> xr.Dataset:
    def of(values: object, label: str) -> tuple:
        return "table", values, {"units": "1", "long_name": label}

    return xr.Dataset(
        {
            "table_fitted": of(
                np.array([one.table in fitted for one in judged], np.int8), "1 where fitted"
            ),
            "left_out_count": of([len(one.z) for one in judged], "numbers in the table"),
            "left_out_z": of(
                [one.z[np.argmax(np.abs(one.z))] for one in judged],
                "largest z of the table as the other fitted tables predict it",
            ),
            "left_out_chi_square": of(
                [one.chi_square for one in judged], "chi square of that prediction"
            ),
            "left_out_chance": of(
                [one.chance for one in judged], "chance of a chi square at least as large"
            ),
            "pair_inflation": (
                ("table", "table_"),
                pairs,
                {
                    "units": "1",
                    "long_name": "least factor on the tolerances at which both tables are met, "
                    "by the linear model; above 1 they contradict each other",
                },
            ),
        },
        coords={"table": [one.table for one in judged]},
    )


def _sets(problem: Problem, sets: Sequence[Incompatible]) -> xr.Dataset:
    points = np.array([one.point for one in sets]).reshape(len(sets), len(problem.parameters))
    return xr.Dataset(
        {
            "set_tables": (
                "set",
                np.array(["; ".join(one.tables) for one in sets], dtype=str),
                {"units": "", "long_name": "tables that no geometry meets together"},
            ),
            "set_inflation": (
                "set",
                np.array([one.inflation for one in sets], float),
                {"units": "1", "long_name": "factor on all tolerances at which one geometry would"},
            ),
            "set_inflation_linear": (
                "set",
                np.array([one.linear for one in sets], float),
                {"units": "1", "long_name": "the same by the linear model alone"},
            ),
            "set_nearest": (
                ("set", "parameter"),
                points * _sizes(problem),
                {"units": "see unit", "long_name": "that geometry"},
            ),
        }
    )


def _joint(joint: JointSpread, covariance: ndarray) -> xr.Dataset:
    spread = joint.bonded_jacobian @ covariance @ joint.bonded_jacobian.T
    stiffness = joint.ln_stiffness @ covariance @ joint.ln_stiffness.T
    std = np.sqrt(np.diag(stiffness))
    return xr.Dataset(
        {
            "bonded_frequency": (
                "joint_mode",
                joint.bonded,
                {"units": "Hz", "long_name": "frequency with bonded flanks"},
            ),
            "bonded_frequency_std": (
                "joint_mode",
                np.sqrt(np.diag(spread)),
                {"units": "Hz", "long_name": "its standard deviation over the geometries"},
            ),
            "ln_stiffness_std": (
                "contact",
                std,
                {
                    "units": "1",
                    "long_name": "standard deviation of ln kn, ln kt over the geometries, "
                    "frequencies kept",
                },
            ),
            "ln_stiffness_correlation": (
                (),
                stiffness[0, 1] / (std[0] * std[1]),
                {"units": "1", "long_name": "correlation of ln kn and ln kt over the geometries"},
            ),
            "joint_force": ((), joint.force, {"units": "N", "long_name": "axial force"}),
        },
        coords={"joint_mode": list(MODES), "contact": ["kn", "kt"]},
    )
