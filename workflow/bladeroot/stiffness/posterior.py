"""The joint posterior of a law of contact stiffness, given all measured stick frequencies.

    ln f_i = ln f_model(ln kn(F_i), ln kt(F_i), F_i) - ln(1 + bias of the mode) + clamping + noise
    F_i = (1 + gain) * reading + offset

Unknown are the law's parameters, the model's bias of each mode, gain and offset of the gauge, which
all its readings share, and by how much ln kn and ln kt scatter from clamping to clamping; the
slopes of the model carry that to the frequencies. All are counted in standard deviations of their
priors, which makes the prior a unit normal.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.stiffness.laws import PRIORS, Law, powers, slopes
from bladeroot.stiffness.levels import Levels
from bladeroot.structure import chebyshev
from bladeroot.structure.chebyshev import Surface

LEAST_FORCE = 100.0  # N; a law in ln F ends before zero force
SCATTER = (np.log(0.05), 1.0)  # ln of the scatter of ln k between clampings: 2 to 14 %


@dataclass(frozen=True)
class Problem:
    """Model, data and priors. surface: ln f of the modes of `levels`, in their order."""

    surface: Surface
    levels: Levels
    law: Law
    names: tuple[str, ...]
    mean: Float[ndarray, " parameter"]
    std: Float[ndarray, " parameter"]


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
    biases = tuple(f"bias_{mode}" for mode in levels.modes)
    names = (*law.parameters, *biases, "force_offset", "force_gain", "ln_scatter")
    of_law = np.array([PRIORS[name][:2] for name in law.parameters])
    mean = np.concatenate([of_law[:, 0], offset, [0.0, 0.0, SCATTER[0]]])
    known = np.maximum(gauge, (1e-3, 1e-9))  # a gauge without an offset still has a parameter
    std = np.concatenate([of_law[:, 1], bias, known, [SCATTER[1]]])
    return Problem(surface, levels, law, names, mean, std)


@dataclass(frozen=True)
class Prediction:
    """What the model says of every level at several points of the parameters.

    ln_k by (kn, kt), true axial force N, ln_frequency as it would be measured without noise;
    slope and bend: first and second derivatives of ln f by (ln kn, ln kt, F). allowed: within the
    model's box.
    """

    force: Float[ndarray, "point level"]
    ln_frequency: Float[ndarray, "point level"]
    slope: Float[ndarray, "point level 3"]
    bend: Float[ndarray, "point level 3 3"] | None
    allowed: Bool[ndarray, " point"]


def predict(problem: Problem, u: Float[ndarray, "point parameter"], order: int = 1) -> Prediction:
    """The model at points u; order 2 adds second derivatives."""
    levels, surface = problem.levels, problem.surface
    theta = problem.mean + problem.std * u
    count = len(problem.law.parameters)
    biases = theta[:, count : count + len(levels.modes)]
    offset, gain = theta[:, -3, None], theta[:, -2, None]
    read = (1.0 + gain) * levels.force + offset
    force = np.clip(read, max(LEAST_FORCE, surface.low[2]), surface.high[2])
    ln_k = np.einsum(
        "pib,kbt,pt->pik", powers(force), problem.law.matrix, theta[:, :count], optimize=True
    )
    inside = np.clip(ln_k, surface.low[:2], surface.high[:2])
    points = np.concatenate([inside, force[..., None]], axis=-1)
    value, slope = np.empty(force.shape), np.empty((*force.shape, 3))
    bend = np.empty((*force.shape, 3, 3)) if order > 1 else None
    for m in range(len(levels.modes)):
        own = levels.mode == m
        one = Surface(surface.coefficients[m : m + 1], surface.low, surface.high)
        parts = chebyshev.evaluate(one, points[:, own].reshape(-1, 3), order)
        shape = (len(u), int(own.sum()))
        value[:, own] = parts[0].reshape(shape) - np.log1p(biases[:, m, None])
        slope[:, own] = parts[1].reshape(*shape, 3)
        if bend is not None:
            bend[:, own] = parts[2].reshape(*shape, 3, 3)
    allowed = (inside == ln_k).all(axis=(1, 2)) & (force == read).all(axis=1)
    return Prediction(force, value, slope, bend, allowed)


def log_posterior(problem: Problem, u: Float[ndarray, "point parameter"]) -> ndarray:
    """Logarithm of likelihood times prior at many points; minus infinity outside the model's box.

    The scatter of a clamping is of rank two, for ln kn and ln kt, in the frequencies that share it.
    """
    levels, said = problem.levels, predict(problem, u)
    size, root_holds = len(levels.force), np.sqrt(levels.holds)
    square = np.exp(2.0 * (problem.mean[-1] + problem.std[-1] * u[:, -1]))
    member = (levels.clamping[:, None] == np.arange(levels.clamping.max() + 1)).astype(float)
    rest = (levels.ln_frequency - said.ln_frequency) / levels.std
    part = said.slope[..., :2] / (root_holds * levels.std)[:, None]
    n, t = part[..., 0], part[..., 1]
    a, b, c = (1.0 + square[:, None] * (n * n @ member), square[:, None] * (n * t @ member),
               1.0 + square[:, None] * (t * t @ member))  # fmt: skip
    v, w = (n * rest) @ member, (t * rest) @ member
    determinant = a * c - b * b
    taken = square[:, None] * (c * v * v - 2.0 * b * v * w + a * w * w) / determinant
    log = -0.5 * ((rest**2).sum(axis=1) - taken.sum(axis=1) + np.log(determinant).sum(axis=1))
    log = log - 0.5 * (size + u.shape[1]) * np.log(2.0 * np.pi) - np.log(levels.std).sum()
    log = log + _of_repeats(problem, said.slope, square) - 0.5 * (u**2).sum(axis=1)
    return np.where(said.allowed, log, -np.inf)


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


def _of_repeats(problem: Problem, slope: ndarray, square: ndarray) -> ndarray:
    """Log-likelihood of the scatter that repeats show, chi-square about the one expected."""
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
    basis, basis_slope = powers(force), slopes(force)
    # x = (ln kn, ln kt, F) of each level, and its derivatives by the parameters
    x = np.zeros((len(force), 3, len(u)))
    x[:, :2, :count] = np.einsum("ib,kbt->ikt", basis, law.matrix)
    rise = np.einsum("ib,kbt,t->ik", basis_slope, law.matrix, theta[:count])
    for column, weight in ((-3, np.ones_like(force)), (-2, levels.force)):
        x[:, :2, column] = rise * weight[:, None]
        x[:, 2, column] = weight
    x *= problem.std
    design = np.einsum("ix,ixp->ip", slope, x)
    for m in range(len(levels.modes)):
        own = levels.mode == m
        design[own, count + m] -= problem.std[count + m] / (1.0 + theta[count + m])
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
    value = float(log_posterior(problem, u[None])[0])
    return Local(value, gradient, information, design, covariance)
