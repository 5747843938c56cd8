"""What the stick frequencies say of each interface's stiffness, drawn from the posterior.

Frequencies saturate towards soft and stiff contact, so that the posterior of several stiffnesses is
far from a normal distribution, and at its peak the clampings' scatter is told less or more than it
is: both are drawn together. All else that is linear in ln f (the model's biases, the error of what
the load does, the causes' parameters about their fit) is part of the covariance.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis.causes import causes, of_load
from bladeroot.diagnosis.simulation.parametric import Parametric
from bladeroot.diagnosis.stick_model import StickData, problem
from bladeroot.diagnosis.structures import distinct
from bladeroot.inference.gaussian import Fit, fit, maxima_of
from bladeroot.inference.problem import Prior, Problem, Slopes, State
from bladeroot.inference.sampling import sample
from bladeroot.mechanisms.mechanism import COORDINATES, Mechanism
from bladeroot.rom.parametric import ln_frequencies
from bladeroot.variables import dataset

QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)
# Draws handed out: ends of an interval of 95 % move by a tenth of a standard deviation.
DRAWS = 1000


def stiffness_problem(
    data: StickData, simulated: Parametric, fitted: Fit, mechanisms: list[Mechanism], base: int
) -> Problem:
    """The problem of `stick_model` in the stiffnesses alone, all other parameters integrated out.

    fitted: of that problem, whose first `base` parameters are the simulation's. The stiffnesses are
    those at the pivot of the loads, whatever load the causes' laws are stated at.
    """
    records, count = data.records, len(simulated.stiffnesses)
    whole = problem(data, simulated, mechanisms)
    here = simulated.of_records(records, data.hold, data.rounding)
    structures = partial(here.structures, fitted.parameters[:base])
    made = causes(mechanisms, fitted.parameters[base:], records, structures)
    pivot = simulated.pivot_of(records)
    change, own = of_load(mechanisms, fitted.parameters[base:], np.array([pivot]))
    slopes = [a - b for a, b in zip(made.slopes, own, strict=True)]
    made = replace(made, changes=made.changes - change, slopes=slopes)
    load = (records.force + made.changes[:, 2]) / simulated.per_load - simulated.shift
    # The load's own effect on f is some per cent: its square is far below the model's bias.
    different, where = distinct(made.changes[:, :2])
    middle = load.mean()
    prior = whole.prior
    # The simulation's part is about nothing, the causes' about where the fit has them.
    off = prior.mean[count:] - np.append(np.zeros(base - count), fitted.parameters[base:])
    variance = prior.std[count:] ** 2

    def state(mean: ndarray, g: Float[ndarray, "record coordinate"]) -> State:
        """With what the other parameters do at these stiffnesses."""
        gradient = here.together(g)
        by_change = np.column_stack([gradient, np.ones(load.size)])
        of_causes = [np.einsum("nc,ncp->np", by_change, one) for one in made.slopes]
        columns = np.hstack([here.others(g[:, :count], g[:, count] * load), *of_causes])
        effects = np.einsum("nc,knc->kn", by_change, made.effects)
        facts = {"gradient": gradient, "effects": effects, "linear": columns * variance @ columns.T}
        return State(mean + columns @ off, g[:, :count], facts)

    def states(ln_k: Float[ndarray, "point parameter"]) -> list[State]:
        points = np.empty((len(different), len(ln_k), count + 1))
        points[:, :, :count] = ln_k + different[:, None, :2][:, :, here.kind]
        points[:, :, count] = middle
        value, by = ln_frequencies(simulated.surface, points.reshape(-1, count + 1))
        g = by.reshape(len(different), len(ln_k), -1, count + 1)[where, :, records.mode]
        mean = value.reshape(len(different), len(ln_k), -1)[where, :, records.mode].T
        mean = mean + (g[..., count] * (load - middle)[:, None]).T
        return [state(one, own) for one, own in zip(mean, g.transpose(1, 0, 2), strict=True)]

    def covariance(state: State, scales: Float[ndarray, " scale"]) -> tuple[ndarray, Slopes]:
        scatter, slopes = whole.covariance(state, scales)
        return scatter + state.facts["linear"], slopes

    return Problem(
        data.ln_f - made.changes[:, 3], lambda ln_k: states(ln_k[None])[0], covariance,
        Prior(prior.mean[:count], prior.std[:count]), whole.scales, many=states,
    )  # fmt: skip


def interface_stiffness(
    data: StickData, simulated: Parametric, fits: Sequence[Fit], mechanisms: list[Mechanism],
    base: int,
) -> xr.Dataset:  # fmt: skip
    """Quantiles of every interface's stiffness at the pivot of the campaign's loads.

    fits: at the maxima of the whole problem's posterior; the first has the mechanisms.
    """
    asked = stiffness_problem(data, simulated, fits[0], mechanisms, base)
    count, pivot = asked.prior.mean.size, simulated.pivot_of(data.records)
    change, _ = of_load(mechanisms, fits[0].parameters[base:], np.array([pivot]))
    own = change[0, [COORDINATES.index(name) for name in simulated.coordinates]]
    ends = [fit(asked, one.parameters[:count] + own, one.scales) for one in fits]
    best, *others = maxima_of(ends, count)
    found = sample(best, range(count), DRAWS, others=others)
    made = {
        "interface_k": np.exp(np.quantile(found.parameters, QUANTILES, axis=0).T),
        "interface_ln_covariance": np.cov(found.parameters.T).reshape(count, count),
        "interface_prior_std": asked.prior.std,
        "interface_load": pivot,
        "stiffness": list(simulated.stiffnesses),
        "stiffness_": list(simulated.stiffnesses),
        "quantile": list(QUANTILES),
    }
    return dataset("diagnosis/interfaces", made).assign_attrs(
        interface_effective_draws=found.effective
    )
