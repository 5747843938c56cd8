"""Unpublished dimensions from published tables: the most probable ones and how sure they are.

Gauss-Newton on tables and priors, all Gaussian; the posterior is Laplace's at its end. Derivatives
come from `shape_gradient`, so that a step costs one solution of the model.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.reproduction.cases import Mode, Model, build_model, solve_modes
from bladeroot.reproduction.parameters import Parameter, values_in, with_values
from bladeroot.reproduction.shape_gradient import adjoints, lagrangian
from bladeroot.reproduction.targets import Target

# Largest step of one parameter, in prior standard deviations.
_STEP = 1.0
# Nearness of neighbours for derivatives, in prior standard deviations: carried modes are stiff, so
# that the second order shows already at 1e-4.
_NEAR = 1e-6
_CONVERGED = 0.02  # posterior standard deviations
_STEPS = 12


@dataclass(frozen=True)
class Problem:
    """A structure file's content, its free parameters and all targets, fitted or only judged."""

    start: Mapping[str, Any]
    parameters: Sequence[Parameter]
    targets: Sequence[Target]

    @property
    def prior_mean(self) -> Float[ndarray, " parameter"]:
        """Of each parameter, in the unit of the structure file."""
        return np.array([one.prior_mean for one in self.parameters])

    @property
    def prior_std(self) -> Float[ndarray, " parameter"]:
        """Of each parameter, in the unit of the structure file."""
        return np.array([one.prior_std for one in self.parameters])

    @property
    def reference(self) -> Float[ndarray, " target"]:
        """Published value of each target."""
        return np.array([one.reference for one in self.targets])

    @property
    def tolerance(self) -> Float[ndarray, " target"]:
        """Standard deviation of each target."""
        return np.array([one.tolerance for one in self.targets])

    @property
    def covariance(self) -> Float[ndarray, "target target"]:
        """Of the targets' errors: the model's is common to the numbers of one mode in a table."""
        kind = [(one.table, one.mode) for one in self.targets]
        common = np.array([[one == other for other in kind] for one in kind])
        model = np.array([one.model_std for one in self.targets])
        own = np.array([one.own_std for one in self.targets])
        return common * np.outer(model, model) + np.diag(own**2)

    @property
    def tables(self) -> list[str]:
        """The table of each target."""
        return [one.table for one in self.targets]

    def of(self, tables: Sequence[str]) -> "Problem":
        """The same with the targets of some tables only."""
        return replace(self, targets=[one for one in self.targets if one.table in tables])


@dataclass(frozen=True)
class Linear:
    """The model near one point: values of all targets there and their derivatives."""

    point: Float[ndarray, " parameter"]
    values: Float[ndarray, " target"]
    jacobian: Float[ndarray, "target parameter"]

    def at(self, point: Float[ndarray, " parameter"]) -> Float[ndarray, " target"]:
        """Values at another point, to first order."""
        return self.values + self.jacobian @ (point - self.point)


Solved = list[tuple[Model, dict]]


def predict(problem: Problem, point: Float[ndarray, " parameter"]) -> Float[ndarray, " target"]:
    """The targets' values by solving the whole model."""
    return _values(problem, _solve(problem, point))


def linearise(problem: Problem, point: Float[ndarray, " parameter"]) -> Linear:
    """Values and derivatives of all targets at one point."""
    solved = _solve(problem, point)
    slopes: dict = {}
    for model, modes in solved:
        slopes |= _eigenvalue_slopes(problem, point, model, modes)
    every = {key: mode for _, modes in solved for key, mode in modes.items()}
    jacobian = [one.derivative(every, slopes) for one in problem.targets]
    return Linear(point, _values(problem, solved), np.array(jacobian))


def calibrate(problem: Problem) -> tuple[Float[ndarray, " parameter"], int]:
    """The most probable parameters and the steps taken; ValueError if it does not settle."""
    point, std = values_in(problem.start, problem.parameters), problem.prior_std
    for step in range(1, _STEPS + 1):
        linear = linearise(problem, point)
        mean, covariance = posterior(problem, linear)
        change = np.clip(mean - point, -_STEP * std, _STEP * std)
        point = point + change
        if np.all(np.abs(change) < _CONVERGED * np.sqrt(np.diag(covariance))):
            return point, step
    raise ValueError(f"{problem.start['name']}: the calibration did not settle in {_STEPS} steps")


def posterior(
    problem: Problem, linear: Linear, used: ndarray | None = None
) -> tuple[Float[ndarray, " parameter"], Float[ndarray, "parameter parameter"]]:
    """Mean and covariance from priors and targets (where `used`, or all), by the linear model."""
    used = np.ones(len(problem.targets), bool) if used is None else used
    root = np.linalg.cholesky(problem.covariance[np.ix_(used, used)])
    scaled = np.linalg.solve(root, linear.jacobian[used] * problem.prior_std)
    offset = linear.at(problem.prior_mean)
    misfit = np.linalg.solve(root, (problem.reference - offset)[used])
    inverse = np.linalg.inv(np.eye(len(problem.parameters)) + scaled.T @ scaled)
    mean = problem.prior_mean + problem.prior_std * (inverse @ (scaled.T @ misfit))
    return mean, inverse * np.outer(problem.prior_std, problem.prior_std)


def _solve(problem: Problem, point: ndarray) -> Solved:
    structure = with_values(problem.start, problem.parameters, point)
    wanted = [key for one in problem.targets for key, _ in one.terms]
    solved = []
    for pad in sorted({case.pad for case, _ in wanted}):
        model = build_model(structure, pad)
        mine = [key for key in dict.fromkeys(wanted) if key[0].pad == pad]
        solved.append((model, solve_modes(model, mine)))
    return solved


def _values(problem: Problem, solved: Solved) -> Float[ndarray, " target"]:
    every = {key: mode for _, modes in solved for key, mode in modes.items()}
    return np.array([one.value(every) for one in problem.targets])


def _eigenvalue_slopes(problem: Problem, point: ndarray, model: Model, modes: dict) -> dict:
    """Derivatives of the modes' eigenvalues by each parameter."""
    listed: list[Mode] = list(modes.values())
    static = model.prestress.displacement.values
    adjoint = adjoints(model, listed)
    pad = bool(model.mesh.attrs["with_pad"])
    base = lagrangian(model.structure, pad, listed, static, adjoint)
    columns = []
    for k, near in enumerate(_NEAR * problem.prior_std):
        other = point + near * np.eye(len(point))[k]
        structure = with_values(problem.start, problem.parameters, other)
        columns.append((lagrangian(structure, pad, listed, static, adjoint) - base) / near)
    return dict(zip(modes, np.array(columns).T, strict=True))
