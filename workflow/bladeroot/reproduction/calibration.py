"""Unpublished dimensions from published tables: the most probable ones and how sure they are.

The tables and priors are all Gaussian: the MAP estimate and its covariance are the engine's.
Derivatives come from `shape_gradient`, so that a step costs one solution of the model.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.inference.gaussian import fit
from bladeroot.inference.problem import LazyState, Prior, State, with_known_errors
from bladeroot.reproduction.cases import Mode, Model, build_model, solve_modes
from bladeroot.reproduction.parameters import Parameter, values_in, with_values
from bladeroot.reproduction.shape_gradient import adjoints, lagrangian
from bladeroot.reproduction.targets import Target

# Nearness of neighbours for derivatives, in prior standard deviations: carried modes are stiff, so
# that the second order shows already at 1e-4.
_NEAR = 1e-6
_LEAST_GAIN = 1e-4  # nats: some 0.01 posterior standard deviations
_CONVERGED = 0.02  # posterior standard deviations


@dataclass(frozen=True)
class Calibration:
    """A structure file's content, its free parameters and all targets, fitted or only judged."""

    start: Mapping[str, Any]
    parameters: Sequence[Parameter]
    targets: Sequence[Target]

    @property
    def prior(self) -> Prior:
        """Of all parameters, in the units of the structure file."""
        both = np.array([(one.prior_mean, one.prior_std) for one in self.parameters])
        return Prior(*both.T)

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

    def where(self, tables: Sequence[str]) -> Bool[ndarray, " target"]:
        """Which targets are of some tables."""
        return np.isin(self.tables, tables)

    def of(self, tables: Sequence[str]) -> "Calibration":
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

    def of(self, used: Bool[ndarray, " target"]) -> "Linear":
        """The same of some targets."""
        return Linear(self.point, self.values[used], self.jacobian[used])


Solved = list[tuple[Model, dict]]


def predict(asked: Calibration, point: Float[ndarray, " parameter"]) -> Float[ndarray, " target"]:
    """The targets' values by solving the whole model."""
    return _state(asked, point).mean


def linearise(asked: Calibration, point: Float[ndarray, " parameter"]) -> Linear:
    """Values and derivatives of all targets at one point."""
    state = _state(asked, point)
    return Linear(point, state.mean, state.slope)


def calibrate(asked: Calibration, fitted: Sequence[str]) -> Linear:
    """The whole model at the most probable parameters by the tables that are fitted.

    ValueError if the fit does not settle.
    """
    used = asked.where(fitted)

    def predict_used(point: ndarray) -> State:
        try:
            whole = _state(asked, point)
        except ValueError:  # a shape that cannot be, or that loses a mode
            nowhere = np.full(used.sum(), np.nan)
            return LazyState(nowhere, lambda: nowhere, {})
        return LazyState(whole.mean[used], lambda: whole.slope[used], {"whole": whole})

    errors = asked.covariance[np.ix_(used, used)]
    inverse = with_known_errors(asked.reference[used], predict_used, errors, asked.prior)
    found = fit(inverse, values_in(asked.start, asked.parameters), least=_LEAST_GAIN)
    whole = found.state.facts["whole"]
    linear = Linear(found.parameters, whole.mean, whole.slope)
    mean, covariance = posterior(asked, linear, used)
    if np.any(np.abs(mean - found.parameters) > _CONVERGED * np.sqrt(np.diag(covariance))):
        raise ValueError(f"{asked.start['name']}: the calibration did not settle")
    return linear


def posterior(
    asked: Calibration, linear: Linear, used: Bool[ndarray, " target"]
) -> tuple[Float[ndarray, " parameter"], Float[ndarray, "parameter parameter"]]:
    """Mean and covariance from priors and the targets that are used, by the linear model."""
    part = linear.of(used)

    def straight(point: ndarray) -> State:
        return State(part.at(point), part.jacobian, {})

    errors = asked.covariance[np.ix_(used, used)]
    found = fit(with_known_errors(asked.reference[used], straight, errors, asked.prior))
    return found.parameters, found.covariance


def _state(asked: Calibration, point: ndarray) -> LazyState:
    """All targets by the whole model; their derivatives when they are asked for."""
    solved = _solve(asked, point)
    every = {key: mode for _, modes in solved for key, mode in modes.items()}

    def jacobian() -> ndarray:
        slopes: dict = {}
        for model, modes in solved:
            slopes |= _eigenvalue_slopes(asked, point, model, modes)
        return np.array([one.derivative(every, slopes) for one in asked.targets])

    return LazyState(np.array([one.value(every) for one in asked.targets]), jacobian, {})


def _solve(asked: Calibration, point: ndarray) -> Solved:
    structure = with_values(asked.start, asked.parameters, point)
    wanted = [key for one in asked.targets for key, _ in one.terms]
    solved = []
    for pad in sorted({case.pad for case, _ in wanted}):
        model = build_model(structure, pad)
        mine = [key for key in dict.fromkeys(wanted) if key[0].pad == pad]
        solved.append((model, solve_modes(model, mine)))
    return solved


def _eigenvalue_slopes(asked: Calibration, point: ndarray, model: Model, modes: dict) -> dict:
    """Derivatives of the modes' eigenvalues by each parameter."""
    listed: list[Mode] = list(modes.values())
    static = model.prestress.displacement.values
    adjoint = adjoints(model, listed)
    pad = bool(model.mesh.attrs["with_pad"])
    base = lagrangian(model.structure, pad, listed, static, adjoint)
    columns = []
    for k, near in enumerate(_NEAR * asked.prior.std):
        other = point + near * np.eye(len(point))[k]
        structure = with_values(asked.start, asked.parameters, other)
        columns.append((lagrangian(structure, pad, listed, static, adjoint) - base) / near)
    return dict(zip(modes, np.array(columns).T, strict=True))
