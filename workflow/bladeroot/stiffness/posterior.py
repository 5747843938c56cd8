"""The joint posterior of a law of contact stiffness, given all measured stick frequencies.

    ln f_i = ln f_model(ln kn(F_i), ln kt(F_i), F_i) - bias(F_i) of the mode + clamping + noise
    bias(F) = bias + tilt ln(F / 12 kN)
    F_i = (1 + gain) * reading + offset

Unknown are the law's parameters, the model's bias of each mode, gain and offset of the gauge, which
all its readings share, and by how much ln kn and ln kt scatter from clamping to clamping; the
slopes of the model carry that to the frequencies. All are counted in standard deviations of their
priors, which makes the prior a unit normal. Amplitude curves, where there are any, add what they
say of (ln kn, ln kt, ln F) of the levels.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.rom import chebyshev
from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.curve_term import CurveTerm, log_likelihood
from bladeroot.stiffness.laws import REFERENCE_FORCE, Law
from bladeroot.stiffness.levels import Levels

LEAST_FORCE = 100.0  # N; a law in ln F ends before zero force
# A model that is wrong by so much at 12 kN is wrong by this part of it more a unit of ln F: 1 % of
# modulus moves 1B by 0.39 to 0.44 % between 1.8 and 24 kN.
BIAS_TILT = 0.05
SCATTER = (np.log(0.05), 1.0)  # ln of the scatter of ln k between clampings: 2 to 14 %
# Standard deviations from there where it ends (a factor of e^20 in k): a sampler's far proposals
# would drown a covariance in rounding.
FAR_SCATTER = 6.0


@dataclass(frozen=True)
class Problem:
    """Model, data and priors.

    surface: ln f of the modes of `levels`, in their order. curves: what amplitude curves say of the
    levels; None without any.
    """

    surface: Surface
    levels: Levels
    law: Law
    names: tuple[str, ...]
    mean: Float[ndarray, " parameter"]
    std: Float[ndarray, " parameter"]
    curves: CurveTerm | None = None


def problem_of(
    surface: Surface,
    levels: Levels,
    law: Law,
    bias: Float[ndarray, " mode"],
    offset: Float[ndarray, " mode"],
    gauge: tuple[float, float],
) -> Problem:
    """The posterior's ingredients.

    bias: standard deviation of the model's relative error in frequency, by mode. offset: its mean.
    gauge: standard deviations of the gauge's offset (N) and gain.
    """
    biases = tuple(f"{part}_{mode}" for part in ("bias", "tilt") for mode in levels.modes)
    names = (*law.parameters, *biases, "force_offset", "force_gain", "ln_scatter")
    of_law = np.array([law.priors[name][:2] for name in law.parameters])
    mean = np.concatenate([of_law[:, 0], offset, np.zeros(len(offset)), [0.0, 0.0, SCATTER[0]]])
    known = np.maximum(gauge, (1e-3, 1e-9))  # a gauge without an offset still has a parameter
    std = np.concatenate([of_law[:, 1], bias, BIAS_TILT * np.asarray(bias), known, [SCATTER[1]]])
    return Problem(surface, levels, law, names, mean, std)


@dataclass(frozen=True)
class Prediction:
    """What the model says of every level at several points of the parameters.

    ln_k by (kn, kt), true axial force N, ln_frequency as it would be measured without noise;
    slope and bend: first and second derivatives of ln f by (ln kn, ln kt, F). allowed: within the
    model's box.
    """

    ln_k: Float[ndarray, "point level 2"]
    force: Float[ndarray, "point level"]
    ln_frequency: Float[ndarray, "point level"]
    slope: Float[ndarray, "point level 3"]
    bend: Float[ndarray, "point level 3 3"] | None
    allowed: Bool[ndarray, " point"]


def biases(problem: Problem) -> slice:
    """Where the biases and their tilts stand among the parameters."""
    first = len(problem.law.parameters)
    return slice(first, first + 2 * len(problem.levels.modes))


def bias_rows(levels: Levels) -> Float[ndarray, "bias level"]:
    """What each bias, then each tilt, does to the bias of every level."""
    of_mode = (levels.mode == np.arange(len(levels.modes))[:, None]).astype(float)
    return np.concatenate([of_mode, of_mode * np.log(levels.force / REFERENCE_FORCE)])


def predict(problem: Problem, u: Float[ndarray, "point parameter"], order: int = 1) -> Prediction:
    """The model at points u; order 2 adds second derivatives."""
    levels, surface = problem.levels, problem.surface
    theta = problem.mean + problem.std * u
    count = len(problem.law.parameters)
    bias = theta[:, biases(problem)] @ bias_rows(levels)
    offset, gain = theta[:, -3, None], theta[:, -2, None]
    read = (1.0 + gain) * levels.force + offset
    force = np.clip(read, max(LEAST_FORCE, surface.low[2]), surface.high[2])
    weights = problem.law.weights(theta[:, :count])
    ln_k = np.einsum("pib,pkb->pik", problem.law.functions(force), weights, optimize=True)
    inside = np.clip(ln_k, surface.low[:2], surface.high[:2])
    points = np.concatenate([inside, force[..., None]], axis=-1)
    value, slope = np.empty(force.shape), np.empty((*force.shape, 3))
    bend = np.empty((*force.shape, 3, 3)) if order > 1 else None
    for m in range(len(levels.modes)):
        own = levels.mode == m
        one = Surface(surface.coefficients[m : m + 1], surface.low, surface.high)
        parts = chebyshev.evaluate(one, points[:, own].reshape(-1, 3), order)
        shape = (len(u), int(own.sum()))
        value[:, own] = parts[0].reshape(shape) - bias[:, own]
        slope[:, own] = parts[1].reshape(*shape, 3)
        if bend is not None:
            bend[:, own] = parts[2].reshape(*shape, 3, 3)
    allowed = (inside == ln_k).all(axis=(1, 2)) & (force == read).all(axis=1)
    return Prediction(inside, force, value, slope, bend, allowed)


def log_posterior(problem: Problem, u: Float[ndarray, "point parameter"]) -> ndarray:
    """Log likelihood times prior at many points; minus infinity outside the model's box."""
    return _log_posterior(problem, u, predict(problem, u))


def _log_posterior(problem: Problem, u: ndarray, said: Prediction) -> ndarray:
    misfit = (problem.levels.ln_frequency - said.ln_frequency)[:, None]
    product, determinant = inner_products(problem, said.slope, u[:, -1], misfit)
    log = -0.5 * (product[:, 0, 0] + determinant + (u**2).sum(axis=1))
    log = log - 0.5 * (misfit.shape[2] + u.shape[1]) * np.log(2.0 * np.pi)
    log = log + of_repeats(problem, said.slope, u[:, -1]) + of_curves(problem, said)
    return np.where(said.allowed, log, -np.inf)


def inner_products(
    problem: Problem,
    slope: Float[ndarray, "point level 3"],
    u_scatter: Float[ndarray, " point"],
    columns: Float[ndarray, "point column level"],
) -> tuple[Float[ndarray, "point column column"], Float[ndarray, " point"]]:
    """Columns' products by the inverse covariance of the measured ln f, and its ln determinant.

    The scatter of a clamping is of rank two, for ln kn and ln kt, in the frequencies that share it.
    """
    levels = problem.levels
    square = _scatter_square(problem, u_scatter)[:, None]
    member = (levels.clamping[:, None] == np.arange(levels.clamping.max() + 1)).astype(float)
    part = slope[..., :2] / (np.sqrt(levels.holds) * levels.std)[:, None]
    n, t = part[..., 0], part[..., 1]
    # Along the principal axes of each clamping's two directions nothing cancels, not even where one
    # frequency stands alone in its clamping, or the scatter is large beside its error.
    turn = 0.5 * np.arctan2(2.0 * (n * t) @ member, (n * n - t * t) @ member)[:, levels.clamping]
    axes = np.cos(turn) * n + np.sin(turn) * t, np.cos(turn) * t - np.sin(turn) * n
    columns = columns / levels.std
    whole = columns @ columns.transpose(0, 2, 1)
    log_determinant = np.full(len(slope), 2.0 * np.log(levels.std).sum())
    for axis in axes:
        grown = 1.0 + square * ((axis * axis) @ member)
        along = (axis[:, None] * columns) @ member
        whole = whole - (square / grown)[:, None] * along @ along.transpose(0, 2, 1)
        log_determinant += np.log(grown).sum(axis=1)
    return whole, log_determinant


def _scatter_square(problem: Problem, u_scatter: Float[ndarray, " point"]) -> ndarray:
    """Variance of ln k between clampings."""
    u = np.clip(u_scatter, -FAR_SCATTER, FAR_SCATTER)
    return np.exp(2.0 * (problem.mean[-1] + problem.std[-1] * u))


def of_curves(problem: Problem, said: Prediction) -> Float[ndarray, " point"]:
    """Log-likelihood of the amplitude curves; zero without any."""
    if problem.curves is None:
        return np.zeros(len(said.force))
    return log_likelihood(problem.curves, coordinates(said))


def coordinates(said: Prediction) -> Float[ndarray, "point level 3"]:
    """(ln kn, ln kt, ln F) of every level."""
    return np.concatenate([said.ln_k, np.log(said.force)[..., None]], axis=2)


def _repeats(problem: Problem) -> list[tuple[ndarray, float, float]]:
    """Levels, degrees of freedom and observed variance of the modes whose clampings repeat.

    The modes are measured on the same clampings, so their repeats together count as one mode's.
    """
    levels = problem.levels
    known = np.flatnonzero(levels.hold_freedom > 0)
    return [
        (levels.mode == m, levels.hold_freedom[m] / len(known), levels.hold_std[m] ** 2)
        for m in known
        if (levels.mode == m).any()
    ]


def of_repeats(
    problem: Problem,
    slope: Float[ndarray, "point level 3"],
    u_scatter: Float[ndarray, " point"],
) -> Float[ndarray, " point"]:
    """Log-likelihood of the scatter that repeats show, chi-square about the one expected."""
    square = _scatter_square(problem, u_scatter)
    log = np.zeros_like(square)
    for own, freedom, observed in _repeats(problem):
        expected = square * (slope[:, own, :2] ** 2).sum(axis=2).mean(axis=1)
        log -= 0.5 * freedom * (np.log(expected) + observed / expected)
    return log


@dataclass(frozen=True)
class Local:
    """Log posterior at one point with its gradient and the expected information (Fisher's).

    design: derivatives of the predicted ln f by the parameters; covariance: of the measured ln f.
    Both with parameters in units of their priors' std.
    """

    value: float
    gradient: Float[ndarray, " parameter"]
    information: Float[ndarray, "parameter parameter"]
    design: Float[ndarray, "level parameter"]
    covariance: Float[ndarray, "level level"]


def local(problem: Problem, u: Float[ndarray, " parameter"]) -> Local:
    """The posterior around one point, for Gauss-Newton (Fisher's scoring)."""
    levels, law = problem.levels, problem.law
    said = predict(problem, u[None], order=2)
    theta = problem.mean + problem.std * u
    count, force, slope, bend = len(law.parameters), said.force[0], said.slope[0], said.bend[0]
    basis, basis_slope = law.functions(force), law.slopes(force)
    # x = (ln kn, ln kt, F) of each level, and its derivatives by the parameters
    x = np.zeros((len(force), 3, len(u)))
    x[:, :2, :count] = np.einsum("ib,kbt->ikt", basis, law.matrix)
    rise = basis_slope @ law.weights(theta[:count]).T
    for column, weight in ((-3, np.ones_like(force)), (-2, levels.force)):
        x[:, :2, column] = rise * weight[:, None]
        x[:, 2, column] = weight
    x *= problem.std
    design = np.einsum("ix,ixp->ip", slope, x)
    place = biases(problem)
    design[:, place] -= bias_rows(levels).T * problem.std[place]
    place = 2 * levels.clamping[:, None] + np.arange(2)
    rows = np.arange(len(force))[:, None]
    part = np.zeros((len(force), place.max() + 1))
    by_u = np.zeros((len(u), *part.shape))
    root_holds = np.sqrt(levels.holds)[:, None]
    part[rows, place] = slope[:, :2] / root_holds
    by_u[:, rows, place] = np.einsum("ikx,ixp->pik", bend[:, :2], x) / root_holds
    square = np.exp(2.0 * theta[-1])
    scattered = square * part @ part.T
    covariance = np.diag(levels.std**2) + scattered
    inverse = np.linalg.inv(covariance)
    rest = inverse @ (levels.ln_frequency - said.ln_frequency[0])
    turns = square * by_u @ part.T
    turns = turns + turns.transpose(0, 2, 1)  # derivatives of the covariance
    turns[-1] += 2.0 * problem.std[-1] * scattered
    gradient = (
        design.T @ rest
        - u
        + 0.5
        * (np.einsum("i,pij,j->p", rest, turns, rest) - np.einsum("ij,pji->p", inverse, turns))
    )
    through = (inverse @ turns).reshape(len(u), -1)
    across = (turns @ inverse).reshape(len(u), -1)
    information = design.T @ inverse @ design + 0.5 * through @ across.T + np.eye(len(u))
    for own, freedom, observed in _repeats(problem):
        gain = (slope[own, :2] ** 2).sum(axis=1).mean()
        grows = 2.0 * np.einsum("ik,ikx,ixp->ip", slope[own, :2], bend[own, :2], x[own])
        relative = grows.mean(axis=0) / gain
        relative[-1] += 2.0 * problem.std[-1]
        gradient = gradient + 0.5 * freedom * (observed / (square * gain) - 1.0) * relative
        information = information + 0.5 * freedom * np.outer(relative, relative)
    if problem.curves is not None:
        turn = (x / np.where(np.arange(3) == 2, force[:, None], 1.0)[:, :, None]).reshape(
            -1, len(u)
        )
        away = (coordinates(said)[0] - problem.curves.center).ravel()
        pull = problem.curves.gradient - problem.curves.information @ away
        gradient = gradient + turn.T @ pull
        information = information + turn.T @ problem.curves.information @ turn
    value = float(_log_posterior(problem, u[None], said)[0])
    return Local(value, gradient, information, design, covariance)
