"""What the stick frequencies say of each interface's stiffness, by weighted draws.

Frequencies saturate towards soft and stiff contact, so that the posterior of several stiffnesses is
far from a normal distribution: Laplace's regions of 95 % held 79 of 100 drawn truths of the lap
joint. Here the model's biases are integrated out as the normal variables that they are, the causes'
parameters as if the fit were straight in them; scales of scatter stay at their most probable
values, and the stiffnesses are drawn: from their prior, then from a normal distribution about what
the draws before weigh.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis.causes import causes
from bladeroot.diagnosis.simulation.parametric import Parametric, of_clamping
from bladeroot.diagnosis.stick_model import StickData, problem
from bladeroot.diagnosis.structures import distinct
from bladeroot.inference.gaussian import Fit, State
from bladeroot.mechanisms.mechanism import Mechanism
from bladeroot.rom.parametric import ln_frequencies

QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)
# Draws of a round and rounds; the later proposal is wider than the draws' own spread by this, and
# this part of it stays the prior, so that no weight grows without bound.
DRAWS, ROUNDS, WIDER, OF_PRIOR = 1000, 5, 1.5, 0.2
# Effective draws that a proposal is learnt from at least: with fewer, weights are evened out.
LEARNT_FROM = 60
_CHUNK = 500  # draws at a time: bounds the memory

Density = Callable[[Float[ndarray, "draw parameter"]], Float[ndarray, " draw"]]


@dataclass(frozen=True)
class Weighted:
    """Draws of ln k with weights that sum to one, and their log density (unnormalised)."""

    ln_k: Float[ndarray, "draw parameter"]
    weight: Float[ndarray, " draw"]
    log_density: Float[ndarray, " draw"]

    @property
    def effective(self) -> float:
        """How many draws of equal weight are worth as much."""
        return _effective(self.weight)

    def quantiles(self, levels: tuple[float, ...] = QUANTILES) -> Float[ndarray, "parameter level"]:
        """Of each ln k."""
        found = []
        for column in self.ln_k.T:
            order = np.argsort(column)
            rising = np.cumsum(self.weight[order])
            found.append(np.interp(levels, rising, column[order]))
        return np.array(found)

    def share_denser(self, log_density: float) -> float:
        """Share of the posterior that is denser than a point: below 0.95 it is in that region."""
        return float(self.weight[self.log_density > log_density].sum())


def density(
    data: StickData, simulated: Parametric, fitted: Fit, mechanisms: list[Mechanism], base: int
) -> Density:
    """Log posterior density of the stiffnesses, up to a constant."""
    records = data.records
    here = simulated.of_records(records, data.hold, data.rounding)
    own = fitted.parameters[:base]
    made = causes(mechanisms, fitted.parameters[base:], records, partial(here.structures, own))
    changes, count = made.changes, len(simulated.parameters)
    load = (records.force + changes[:, 2]) / simulated.per_load - simulated.shift
    # The load's own effect on f is some per cent: its square is far below the model's bias.
    places, where = distinct(changes[:, :2])
    middle = load.mean()
    prior, scales = np.array(simulated.prior), fitted.scales
    nothing = np.zeros((records.force.size, 3))
    still = State(fitted.state.mean, fitted.state.slope, fitted.state.facts | {"gradient": nothing})
    fixed, _ = problem(data, simulated, mechanisms).covariance(still, scales)
    # Biases and the error of what the load does, which the fit's own slope has.
    off = np.hstack([here.bias_rows, fitted.state.slope[:, base - 1 : base]])
    fixed = fixed + (off * here.prior.std[count + 1 :] ** 2) @ off.T
    # The causes' own parameters are as unknown as their priors say, about where the fit has them.
    asked = problem(data, simulated, mechanisms).prior
    by_cause = fitted.state.slope[:, base:]
    fixed = fixed + (by_cause * asked.std[base:] ** 2) @ by_cause.T
    moved = by_cause @ (asked.mean - fitted.parameters)[base:]
    target = data.ln_f - changes[:, 3] - moved - off @ here.prior.mean[count + 1 :]
    spread = of_clamping(scales, data.rounding)
    same_hold = here.same_hold

    def some(ln_k: ndarray) -> ndarray:
        points = np.empty((len(places), len(ln_k), count + 1))
        points[:, :, :count] = ln_k + places[:, None, :2][:, :, here.kind]
        points[:, :, count] = middle
        value, slope = ln_frequencies(simulated.surface, points.reshape(-1, count + 1))
        shape = (len(places), len(ln_k), -1)
        g = slope.reshape(*shape, count + 1)[where, :, records.mode].transpose(1, 0, 2)
        mean = value.reshape(shape)[where, :, records.mode].T + g[:, :, count] * (load - middle)
        three = here.together(g)
        factor = np.linalg.cholesky(fixed + (three @ spread @ three.mT) * same_hold)
        rest = np.linalg.solve(factor, (target - mean)[..., None])[..., 0]
        log = -0.5 * (rest**2).sum(axis=1)
        log -= np.log(np.diagonal(factor, axis1=1, axis2=2)).sum(axis=1)
        return log - 0.5 * (((ln_k - prior[:, 0]) / prior[:, 1]) ** 2).sum(axis=1)

    def log_density(ln_k: Float[ndarray, "draw parameter"]) -> Float[ndarray, " draw"]:
        return np.concatenate([some(ln_k[k : k + _CHUNK]) for k in range(0, len(ln_k), _CHUNK)])

    return log_density


def weighted_draws(
    log_density: Density, prior: Float[ndarray, "parameter 2"], draws: int = DRAWS
) -> Weighted:
    """Importance sampling in rounds; the last one counts. The same input gives the same draws."""
    rng = np.random.default_rng(20261123)
    mean, root = prior[:, 0], np.diag(prior[:, 1])
    found = None
    for round_ in range(ROUNDS):
        part = 1.0 if round_ == 0 else OF_PRIOR
        z = rng.standard_normal((draws, len(prior)))
        ln_k = mean + z @ root.T
        of_prior = rng.uniform(size=draws) < part
        ln_k[of_prior] = prior[:, 0] + z[of_prior] * prior[:, 1]
        log = log_density(ln_k)
        own = _normal(ln_k, prior[:, 0], np.diag(prior[:, 1]))
        proposal = own
        if round_:
            proposal = np.logaddexp(np.log(part) + own, np.log1p(-part) + _normal(ln_k, mean, root))
        ratio = log - proposal - (log - proposal).max()
        heat = 1.0
        while round_ < ROUNDS - 1 and _effective(np.exp(ratio / heat)) < LEARNT_FROM:
            heat *= 1.5
        weight = np.exp(ratio / heat)
        found = Weighted(ln_k, weight / weight.sum(), log)
        mean = found.weight @ ln_k
        off = ln_k - mean
        covariance = WIDER**2 * (off * found.weight[:, None]).T @ off
        root = np.linalg.cholesky(covariance + np.diag((1e-3 * prior[:, 1]) ** 2))
    return found


def interface_stiffness(
    data: StickData, simulated: Parametric, fitted: Fit, mechanisms: list[Mechanism], base: int
) -> xr.Dataset:
    """Quantiles of every interface's stiffness at the pivot of the campaign's loads."""
    log_density = density(data, simulated, fitted, mechanisms, base)
    found = weighted_draws(log_density, np.array(simulated.prior))
    off = found.ln_k - found.weight @ found.ln_k
    covariance = (off * found.weight[:, None]).T @ off
    text = "quantiles of the stiffness of an interface, named causes included"
    return xr.Dataset(
        {
            "interface_k": (
                ("stiffness", "quantile"), np.exp(found.quantiles()),
                {"units": "N/m", "long_name": text},
            ),
            "interface_ln_covariance": (
                ("stiffness", "stiffness_"), covariance,
                {"units": "1", "long_name": "covariance of ln k"},
            ),
            "interface_prior_std": (
                "stiffness", np.array(simulated.prior)[:, 1],
                {"units": "1", "long_name": "standard deviation of ln k beforehand"},
            ),
        },
        coords={"stiffness": list(simulated.parameters),
                "stiffness_": list(simulated.parameters), "quantile": list(QUANTILES)},
        attrs={"interface_effective_draws": found.effective},
    )  # fmt: skip


def _effective(weight: ndarray) -> float:
    return float(weight.sum() ** 2 / (weight**2).sum())


def _normal(x: ndarray, mean: ndarray, root: ndarray) -> Float[ndarray, " draw"]:
    """Log density of a normal distribution by the root of its covariance, up to a constant."""
    rest = np.linalg.solve(root, (x - mean).T)
    return -0.5 * (rest**2).sum(axis=0) - np.log(np.abs(np.diag(root))).sum()
