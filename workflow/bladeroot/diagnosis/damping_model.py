"""Loss factors of the stuck joint: one a mode, scattering from clamping to clamping.

A clamping changes the losses of all modes together, and each mode's besides: taken for independent,
they would count one chance as often as there are modes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis.causes import places, with_causes, with_smooth
from bladeroot.diagnosis.guards import TRUST
from bladeroot.diagnosis.stick_model import LAWS, StickData, same_mode, trust_kernel
from bladeroot.inference.problem import Problem, Slopes, State
from bladeroot.mechanisms.mechanism import Mechanism, rows_of

LEVEL = (np.log(5e-3), 1.5)  # steel structures with joints
SCATTER = (np.log(0.03), 0.8)  # of ln(loss factor) between clampings: of all modes, of each one's
NOISE = (np.log(3e-3), 1.5)  # of ln(loss factor) between records of one


@dataclass(frozen=True)
class DampingData:
    """ln of the loss factors and their relative errors, with the records' situations."""

    stick: StickData
    ln_loss: Float[ndarray, " record"]
    std: Float[ndarray, " record"]


def damping_data(seen: xr.Dataset, stick: StickData) -> DampingData | None:
    """Loss factors of the records that have a stick frequency; None if there are none."""
    loss = seen["stick_loss_factor"].values[stick.row]
    std = seen["stick_loss_factor_std"].values[stick.row]
    kept = np.flatnonzero(np.isfinite(loss) & (loss > 0.0) & np.isfinite(std))
    if not kept.size:
        return None
    here = replace(
        rows_of(stick, kept),
        records=rows_of(stick.records, kept),
        hold=np.unique(stick.hold[kept], return_inverse=True)[1],
    )
    return DampingData(here, np.log(loss[kept]), std[kept] / loss[kept])


def problem(
    data: DampingData,
    mechanisms: Sequence[Mechanism] = (),
    extra: Sequence[tuple[ndarray, float]] = (),
) -> Problem:
    """One loss factor a mode, with mechanisms and a smooth competitor."""
    records = data.stick.records
    n, modes = data.ln_loss.size, len(data.stick.modes)
    of_mode = np.eye(modes)[records.mode]
    held = data.stick.hold[:, None] == data.stick.hold
    own_held = held & same_mode(data.stick)
    trust = [trust_kernel(data.stick, one.over) for one in mechanisms]
    prior = with_causes(*(np.full(modes, one) for one in LEVEL), mechanisms)

    def predict(theta: ndarray) -> State:
        mean, columns, effects = of_mode @ theta[:modes], [of_mode], []
        for one, own in zip(mechanisms, places(mechanisms, modes), strict=True):
            values, chain = one.values(theta[own])
            change, slope = one.damping(records, values)
            mean = mean + change
            effects.append(change)
            columns.append(slope * chain)
        return State(mean, np.hstack(columns), {"effects": np.array(effects).reshape(-1, n)})

    def covariance(state: State, scales: ndarray) -> tuple[ndarray, Slopes]:
        size = np.exp(2.0 * scales)
        scatter, noise = (size[0] * held, size[1] * own_held), np.full(n, size[2])
        whole = scatter[0] + scatter[1] + np.diag(noise + data.std**2)
        of_laws = np.zeros((n, n))
        for e, kernel in zip(state.facts["effects"], trust, strict=True):
            of_laws += np.outer(size[3] * TRUST**2 * e, e) * kernel
        parts = [of_laws, *(of * unit for of, (unit, _) in zip(size[4:], extra, strict=True))]
        for part in parts:
            whole += part
        return whole, lambda: [2.0 * part for part in (*scatter, noise, *parts)]

    scales = with_smooth([SCATTER, SCATTER, NOISE, LAWS], extra)
    return Problem(data.ln_loss, predict, covariance, prior, scales)
