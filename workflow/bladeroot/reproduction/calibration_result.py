"""A calibration from tables to artifact: dimensions, what they predict, tables in contradiction."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.reproduction.calibration import (
    Calibration,
    Linear,
    calibrate,
    linearise,
    posterior,
    predict,
)
from bladeroot.reproduction.cases import Case
from bladeroot.reproduction.parameters import values_in
from bladeroot.reproduction.targets import Target
from bladeroot.reproduction.tension import (
    Incompatible,
    LeftOut,
    incompatible_sets,
    left_out,
    pair_inflation,
)
from bladeroot.stiffness.grid_search import FLANK_NODES
from bladeroot.stiffness.surface import MODES
from bladeroot.variables import dataset

_TABLE = "reproduction/calibration"
# The joint's spread is taken at Table 5.2's first force and stiffness (N, N/m a flank).
JOINT = (12.0e3, (FLANK_NODES * 41428.6e3, FLANK_NODES * 64285.7e3))
# A combination is seen if the tables narrow it to this part of its prior deviation.
_SEEN = 0.99


# N/m a flank: no gap opens or slips, yet modes far from it still converge.
BONDED = 1.0e12
_NEAR = 1e-3  # of ln k, between neighbours


@dataclass(frozen=True)
class JointSpread:
    """At one axial force: bonded frequencies and their derivatives; ln kn, ln kt by parameter.

    `ln_stiffness` is how ln kn and ln kt move per unit of a parameter if the frequencies are kept.
    """

    force: float
    bonded: Float[ndarray, " mode"]
    bonded_jacobian: Float[ndarray, "mode parameter"]
    ln_stiffness: Float[ndarray, "2 parameter"]


def joint_spread(
    asked: Calibration,
    point: Float[ndarray, " parameter"],
    force: float,
    stiffness: tuple[float, float],
) -> JointSpread:
    """The joint at a calibrated geometry, at `force` (N) and near kn, kt (N/m a flank)."""
    kn, kt = stiffness
    near = np.exp(_NEAR)
    contacts = [(BONDED, BONDED), (kn, kt), (kn * near, kt), (kn, kt * near)]
    targets = [
        Target("joint", mode, Case(True, force, *contact, slots=True), 0.0, 0.0, 1.0)
        for contact in contacts
        for mode in MODES
    ]
    linear = linearise(replace(asked, targets=targets), point)
    bonded, soft, normal, tangential = linear.values.reshape(4, -1)
    jacobian = linear.jacobian.reshape(4, len(MODES), -1)
    by_stiffness = np.stack([normal - soft, tangential - soft], axis=1) / _NEAR
    return JointSpread(force, bonded, jacobian[0], -np.linalg.solve(by_stiffness, jacobian[1]))


def calibration(asked: Calibration, fitted: Sequence[str], refinements: int = 3) -> xr.Dataset:
    """Fit the tables named by `fitted`, judge all of all tables: `calibration.nc`.

    ValueError if the fit does not settle or leads to a shape that cannot be.
    """
    linear, used = calibrate(asked, fitted), asked.where(fitted)
    point, (_, covariance) = linear.point, posterior(asked, linear, used)
    joint = joint_spread(asked, point, *JOINT)
    parts = [
        _parameters(asked, point, covariance),
        _targets(asked, linear, covariance, used),
        _directions(asked.of(fitted), linear, covariance, used, joint),
        _tables(left_out(asked, linear, fitted), pair_inflation(asked, linear), fitted),
        _sets(asked, incompatible_sets(asked, linear, refinements)),
        _joint(joint, covariance),
    ]
    return xr.merge(parts).assign_attrs(structure=asked.start["name"], fitted=", ".join(fitted))


def _sizes(asked: Calibration) -> Float[ndarray, " parameter"]:
    return np.array([one.unit[1] for one in asked.parameters])


def _parameters(asked: Calibration, point: ndarray, covariance: ndarray) -> xr.Dataset:
    std, size = np.sqrt(np.diag(covariance)), _sizes(asked)
    shipped = values_in(asked.start, asked.parameters)
    away = shipped - point

    made = {
        "unit": [one.unit[0] for one in asked.parameters],
        "most_probable": point * size,
        "std": std * size,
        "prior_mean": asked.prior.mean * size,
        "prior_std": asked.prior.std * size,
        "shipped": shipped * size,
        "shipped_distance": np.sqrt(away @ np.linalg.solve(covariance, away)),
        "correlation": covariance / np.outer(std, std),
        "parameter": [one.name for one in asked.parameters],
    }
    return dataset(_TABLE, made)


def _targets(asked: Calibration, linear: Linear, covariance: ndarray, used: ndarray) -> xr.Dataset:
    spread = np.sqrt(np.einsum("ij,jk,ik->i", linear.jacobian, covariance, linear.jacobian))
    made = {
        "target_table": asked.tables,
        "target_mode": [one.mode for one in asked.targets],
        "target_force": [one.case.force for one in asked.targets],
        "target_fitted": used.astype(np.int8),
        "target_is_slope": np.array([one.slope for one in asked.targets], np.int8),
        "reference": asked.reference,
        "tolerance": asked.tolerance,
        "predicted": linear.values,
        "predicted_std": spread,
        "residual_z": (linear.values - asked.reference) / asked.tolerance,
        "jacobian": linear.jacobian / _sizes(asked),
    }
    return dataset(_TABLE, made)


def _directions(
    asked: Calibration, linear: Linear, covariance: ndarray, used: ndarray, joint: JointSpread
) -> xr.Dataset:
    """Stiffest and sloppiest combination that the fitted tables see, relative to the priors.

    With them how linear the model is, and what they do to the bonded joint.
    """
    part = linear.of(used)
    scale = asked.prior.std
    variances, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    chosen = [0, int(np.flatnonzero(variances < _SEEN**2)[-1])]
    steps = (axes * np.sqrt(variances)).T[chosen] * scale
    misfit = np.empty((2, 2))
    for row, step in enumerate(steps):
        for column, sign in enumerate((-1, 1)):
            there = linear.point + sign * step
            misfit[row, column] = np.abs(
                (predict(asked, there) - part.at(there)) / asked.tolerance
            ).max()
    made = {
        "direction_step": steps * _sizes(asked),
        "direction_share": np.sqrt(variances[chosen]),
        "direction_error": misfit,
        "direction_bonded": steps @ joint.bonded_jacobian.T,
        "direction": ["stiffest", "sloppiest"],
        "sign": [-1, 1],
        "joint_mode": list(MODES),
    }
    return dataset(_TABLE, made)


def _tables(judged: Sequence[LeftOut], pairs: ndarray, fitted: Sequence[str]) -> xr.Dataset:
    made = {
        "table_fitted": np.array([one.table in fitted for one in judged], np.int8),
        "left_out_count": [len(one.z) for one in judged],
        "left_out_z": [one.z[np.argmax(np.abs(one.z))] for one in judged],
        "left_out_chi_square": [one.chi_square for one in judged],
        "left_out_chance": [one.chance for one in judged],
        "pair_inflation": pairs,
        "table": [one.table for one in judged],
    }
    return dataset(_TABLE, made)


def _sets(asked: Calibration, sets: Sequence[Incompatible]) -> xr.Dataset:
    points = np.array([one.point for one in sets]).reshape(len(sets), len(asked.parameters))
    made = {
        "set_tables": np.array(["; ".join(one.tables) for one in sets], dtype=str),
        "set_inflation": np.array([one.inflation for one in sets], float),
        "set_inflation_linear": np.array([one.linear for one in sets], float),
        "set_nearest": points * _sizes(asked),
    }
    return dataset(_TABLE, made)


def _joint(joint: JointSpread, covariance: ndarray) -> xr.Dataset:
    spread = joint.bonded_jacobian @ covariance @ joint.bonded_jacobian.T
    stiffness = joint.ln_stiffness @ covariance @ joint.ln_stiffness.T
    std = np.sqrt(np.diag(stiffness))
    made = {
        "bonded_frequency": joint.bonded,
        "bonded_frequency_std": np.sqrt(np.diag(spread)),
        "ln_stiffness_std": std,
        "ln_stiffness_correlation": stiffness[0, 1] / (std[0] * std[1]),
        "joint_force": joint.force,
        "joint_mode": list(MODES),
        "contact": ["kn", "kt"],
    }
    return dataset(_TABLE, made)
