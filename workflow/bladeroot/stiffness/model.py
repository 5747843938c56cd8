"""The model of all measured stick frequencies under a law of contact stiffness.

    ln f_i = ln f_model(ln kn(F_i), ln kt(F_i), F_i) - bias(F_i) of the mode + clamping + noise
    bias(F) = bias + tilt ln(F / 12 kN)
    F_i = (1 + gain) * reading + offset

Unknown are the law's parameters, the model's bias of each mode, gain and offset of the gauge, which
all its readings share, and by how much ln kn and ln kt scatter from clamping to clamping; the
slopes of the model carry that to the frequencies. Amplitude curves, where there are any, add rows
that are linear in (ln kn, ln kt, ln F) of the levels; what else they depend on, the friction, is
integrated out before: it only makes their covariance wider.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.inference.gaussian import Fit, best_fit, fit
from bladeroot.inference.problem import Prior, Problem, Repeats, State
from bladeroot.rom import chebyshev
from bladeroot.rom.chebyshev import Surface
from bladeroot.stiffness.laws import Law, powers, slopes
from bladeroot.stiffness.levels import Levels
from bladeroot.stiffness.priors import BIAS_TILT, PRIORS, REFERENCE_FORCE, SCATTER

LEAST_FORCE = 100.0  # N, the smallest true force at which a law in ln F is evaluated
_START_OFFSETS = (-0.7, 0.0, 0.7)  # of ln kn and ln kt from their priors' means, in std
_LEAST_GAIN = 1e-6  # nats: a fit ends with a step that gains less; laws are compared by their fits


@dataclass(frozen=True)
class CurveTerm:
    """What curves say of z = (ln kn, ln kt, ln F) of all levels, F the true axial force in N.

    rest = slope (z - center) + errors of unit variance, in as few rows as hold all information on
    z, flattened. constant: the part of the log-likelihood that does not depend on z. points: number
    of measured values.
    """

    center: Float[ndarray, "level 3"]
    rest: Float[ndarray, " row"]
    slope: Float[ndarray, "row coordinate"]
    constant: float
    points: int


def curve_term(
    center: Float[ndarray, "level 3"],
    rest: Float[ndarray, " point"],
    slope: Float[ndarray, "point coordinate"],
    covariance: Float[ndarray, "point point"],
) -> CurveTerm:
    """The term of measured minus simulated curves, `rest`, whose simulation has `slope`."""
    factor = np.linalg.cholesky(covariance)
    whitened = np.linalg.solve(factor, np.column_stack([rest, slope]))
    rest, slope = whitened[:, 0], whitened[:, 1:]
    across, rows = np.linalg.qr(slope)
    kept = across.T @ rest
    spare = len(rest) - len(kept)
    volume = np.log(np.diag(factor)).sum() + 0.5 * spare * np.log(2.0 * np.pi)
    constant = float(-0.5 * (rest @ rest - kept @ kept) - volume)
    return CurveTerm(center, kept, rows, constant, len(rest))


@dataclass(frozen=True)
class LevelModel:
    """Surface (ln f of the modes of `levels`, in their order), data, law and priors.

    names: of the parameters. curves: what amplitude curves tell of the levels; None without any.
    """

    surface: Surface
    levels: Levels
    law: Law
    names: tuple[str, ...]
    prior: Prior
    curves: CurveTerm | None = None

    @property
    def biases(self) -> slice:
        """Where the biases and their tilts stand among the parameters."""
        first = len(self.law.parameters)
        return slice(first, first + 2 * len(self.levels.modes))

    def ln_k(
        self, theta: Float[ndarray, "draw parameter"], force: Float[ndarray, " force"]
    ) -> Float[ndarray, "draw force 2"]:
        """(ln kn, ln kt) of draws of the parameters at axial forces (N)."""
        return self.law.ln_k(theta[:, : len(self.law.parameters)], force)

    def stiffness_rows(
        self, force: Float[ndarray, " force"]
    ) -> Float[ndarray, "force 2 parameter"]:
        """Derivatives of (ln kn, ln kt) at axial forces by all parameters."""
        rows = np.zeros((len(force), 2, len(self.names)))
        rows[:, :, : len(self.law.parameters)] = self.law.rows(force)
        return rows


def level_model(
    surface: Surface,
    levels: Levels,
    law: Law,
    bias: Float[ndarray, " mode"],
    offset: Float[ndarray, " mode"],
    gauge: tuple[float, float],
) -> LevelModel:
    """The model with its priors.

    bias: standard deviation of the model's relative error in frequency, by mode. offset: its mean.
    gauge: standard deviations of the gauge's offset (N) and gain.
    """
    biases = tuple(f"{part}_{mode}" for part in ("bias", "tilt") for mode in levels.modes)
    of_law = np.array([PRIORS[name][:2] for name in law.parameters])
    known = np.maximum(gauge, (1e-3, 1e-9))  # the parameters stay where a gauge has no error
    prior = Prior(
        np.concatenate([of_law[:, 0], offset, np.zeros(len(offset)), [0.0, 0.0]]),
        np.concatenate([of_law[:, 1], bias, BIAS_TILT * np.asarray(bias), known]),
    )
    names = (*law.parameters, *biases, "force_offset", "force_gain")
    return LevelModel(surface, levels, law, names, prior)


@dataclass(frozen=True)
class Prediction:
    """What the model predicts for every level at several points of the parameters.

    coordinates: (ln kn, ln kt, F), F the true axial force in N. design: their derivatives by the
    parameters. ln_frequency: as measured without noise. slope: of ln f by the coordinates.
    allowed: whether all coordinates lie within the model's box.
    """

    coordinates: Float[ndarray, "point level 3"]
    design: Float[ndarray, "point level 3 parameter"]
    ln_frequency: Float[ndarray, "point level"]
    slope: Float[ndarray, "point level 3"]
    allowed: Bool[ndarray, " point"]

    @property
    def logarithms(self) -> Float[ndarray, "point level 3"]:
        """(ln kn, ln kt, ln F) of every level."""
        return np.concatenate(
            [self.coordinates[..., :2], np.log(self.coordinates[..., 2:])], axis=2
        )


def bias_rows(levels: Levels) -> Float[ndarray, "bias level"]:
    """Derivatives of every level's bias by each mode's bias, then by each mode's tilt."""
    of_mode = (levels.mode == np.arange(len(levels.modes))[:, None]).astype(float)
    return np.concatenate([of_mode, of_mode * np.log(levels.force / REFERENCE_FORCE)])


def predict(model: LevelModel, theta: Float[ndarray, "point parameter"]) -> Prediction:
    """The model at points of its parameters, in their own units."""
    levels, surface, law = model.levels, model.surface, model.law
    count = len(law.parameters)
    read = (1.0 + theta[:, -1:]) * levels.force + theta[:, -2:-1]
    force = np.clip(read, max(LEAST_FORCE, surface.low[2]), surface.high[2])
    weights = np.einsum("kbt,pt->pkb", law.matrix, theta[:, :count])
    basis = powers(force)
    ln_k = np.einsum("pib,pkb->pik", basis, weights, optimize=True)
    inside = np.clip(ln_k, surface.low[:2], surface.high[:2])
    places = np.concatenate([inside, force[..., None]], axis=-1)
    value, slope = np.empty(force.shape), np.empty((*force.shape, 3))
    for m in range(len(levels.modes)):
        own = levels.mode == m
        one = Surface(surface.coefficients[m : m + 1], surface.low, surface.high)
        parts = chebyshev.evaluate(one, places[:, own].reshape(-1, 3), 1)
        value[:, own] = parts[0].reshape(len(theta), -1)
        slope[:, own] = parts[1].reshape(len(theta), -1, 3)
    design = np.zeros((*places.shape, len(model.names)))
    design[..., :2, :count] = np.einsum("pib,kbt->pikt", basis, law.matrix, optimize=True)
    rise = np.einsum("pib,pkb->pik", slopes(force), weights, optimize=True)
    for column, weight in ((-2, np.ones_like(levels.force)), (-1, levels.force)):
        design[..., :2, column] = rise * weight[:, None]
        design[..., 2, column] = weight
    value += ((ln_k - inside) * slope[..., :2]).sum(axis=2) + (read - force) * slope[..., 2]
    value -= theta[:, model.biases] @ bias_rows(levels)
    allowed = (inside == ln_k).all(axis=(1, 2)) & (force == read).all(axis=1)
    return Prediction(places, design, value, slope, allowed)


def problem_of(model: LevelModel) -> Problem:
    """The problem that is fitted and sampled; its one scale is the scatter between clampings."""
    levels, curves = model.levels, model.curves
    rows = bias_rows(levels).T
    data = levels.ln_frequency
    if curves is not None:
        data = np.concatenate([data, curves.rest])

    def many(theta: ndarray) -> Sequence[State]:
        said = predict(model, theta)
        mean = said.ln_frequency
        slope = np.einsum("pix,pixt->pit", said.slope, said.design, optimize=True)
        slope[:, :, model.biases] -= rows
        if curves is not None:
            by_ln = said.design.copy()
            by_ln[:, :, 2] /= said.coordinates[:, :, 2, None]
            flat = (len(theta), -1)
            away = (said.logarithms - curves.center).reshape(flat)
            mean = np.concatenate([mean, away @ curves.slope.T], axis=1)
            bent = by_ln.reshape(*flat, theta.shape[1])
            slope = np.concatenate([slope, curves.slope @ bent], axis=1)
        return [
            State(mean[k], slope[k], {"slope": said.slope[k]}, bool(said.allowed[k]))
            for k in range(len(theta))
        ]

    noise = np.concatenate([levels.std**2, np.ones(len(data) - len(levels.std))])
    diagonal = np.arange(len(data))
    alike = levels.clamping[:, None] == levels.clamping
    alike = alike / np.sqrt(np.outer(levels.clampings, levels.clampings))
    own = slice(0, len(levels.std))

    def covariance(state: State, scales: ndarray) -> tuple[ndarray, Callable]:
        by_k = state.facts["slope"][:, :2]
        scattered = np.zeros((len(data), len(data)))
        scattered[own, own] = np.exp(2.0 * scales[0]) * (by_k @ by_k.T) * alike
        whole = scattered.copy()
        whole[diagonal, diagonal] += noise
        return whole, lambda: [2.0 * scattered]

    scales = Prior(np.array([SCATTER[0]]), np.array([SCATTER[1]]))
    return Problem(
        data, lambda theta: many(theta[None])[0], covariance, model.prior, scales,
        _repeats(levels), many,
    )  # fmt: skip


def _repeats(levels: Levels) -> Repeats | None:
    """What clampings that repeat say of their scatter.

    The modes are measured on the same clampings, so their repeats together count as one mode's.
    """
    known = [m for m in np.flatnonzero(levels.clamping_freedom > 0) if (levels.mode == m).any()]
    if not known:
        return None
    of_modes = [np.flatnonzero(levels.mode == m) for m in known]
    by_scale = np.full((len(known), 1), 2.0)

    def expected(state: State, scales: ndarray) -> tuple[ndarray, ndarray]:
        gain = (state.facts["slope"][:, :2] ** 2).sum(axis=1)
        mean = np.array([gain[own].sum() / own.size for own in of_modes])
        return np.exp(2.0 * scales[0]) * mean, by_scale

    return Repeats(
        levels.clamping_freedom[known] / len(known), levels.clamping_std[known] ** 2, expected
    )


def map_estimate(model: LevelModel, starts: tuple[float, ...] = _START_OFFSETS) -> Fit:
    """The MAP estimate, the best from several stiffnesses.

    starts: of ln kn and of ln kt, in standard deviations of their priors. Raises ValueError if no
    start lies in the model's box.
    """
    places = np.tile(model.prior.mean, (len(starts) ** 2, 1))
    places[:, :2] += model.prior.std[:2] * np.array([(a, b) for a in starts for b in starts])
    problem = problem_of(model)
    inside = [one for one in places if problem.predict(one).inside]
    if not inside:
        raise ValueError(
            "the measured forces and the prior of kn, kt lie outside the parametric model: "
            "widen parametric.stiffness_GN_per_m or parametric.force_kN"
        )
    return _whole(model, best_fit(problem, inside, least=_LEAST_GAIN))


def refit(model: LevelModel, start: Fit) -> Fit:
    """The MAP estimate from where another model's fit ended."""
    return _whole(model, fit(problem_of(model), start.parameters, start.scales, least=_LEAST_GAIN))


def _whole(model: LevelModel, found: Fit) -> Fit:
    """The fit with the evidence of the whole curves, not of the rows that were kept of them."""
    spare = 0.0 if model.curves is None else model.curves.constant
    return replace(found, log_evidence=found.log_evidence + spare)
