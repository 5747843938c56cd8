"""Frequency and damping against amplitude from one quasi-static cycle of a mode.

The same specimen, forces and sliders as in `stepping`, moved along one stuck mode: what answers
in phase with the displacement changes the frequency, the area of the loop is the loss.
"""

from typing import no_type_check

import numpy as np
from bladeroot.bench.forces import ModalForces, nonlinear_force
from bladeroot.bench.modes import StuckModes
from bladeroot.bench.sweep import own_give, settle
from bladeroot.compiled import njit
from jaxtyping import Float
from numpy import ndarray

_PHASES = 96
_LOADS_A_DECADE = 40
_SWEEPS = 2000
_TOLERANCE = 1e-6


def cycle_curves(
    modes: StuckModes,
    number: int,
    loss_factor: float,
    forces: ModalForces,
    limit: Float[ndarray, " pair"],
    amplitude: Float[ndarray, " amplitude"],
) -> tuple[Float[ndarray, " amplitude"], Float[ndarray, " amplitude"]]:
    """Frequency (Hz) and decay rate (1/s, of ln A) of mode `number` at amplitudes (m) at the laser.

    `loss_factor` is that of the stuck mode, whose damper stays what it is at all amplitudes;
    `limit` (N) is the largest tangential force of a pair.
    """
    square = modes.omega[number] ** 2
    reach = amplitude / abs(modes.laser_shape[number])
    softer, lost = np.zeros(reach.size), np.zeros(reach.size)
    if forces.active:
        for k, q in enumerate(reach):
            softer[k], lost[k] = _by_phase(forces, number, float(modes.omega[number]), float(q))
    if np.isfinite(limit).all():
        by_slip = slip_cycle(modes, number, limit, reach)
        softer, lost = softer + by_slip[0], lost + by_slip[1]
    omega = np.sqrt(square - softer)
    return omega / (2 * np.pi), modes.omega[number] * loss_factor / 2 + lost / (2 * omega)


def loss_factor(
    frequency: Float[ndarray, " amplitude"],
    rate: Float[ndarray, " amplitude"],
    amplitude: Float[ndarray, " amplitude"],
) -> Float[ndarray, " amplitude"]:
    """Loss factor as (3.11) defines it for a decay: -(2 omega A'/A + omega') / omega^2."""
    omega = 2 * np.pi * frequency
    return rate * (2 * omega + np.gradient(omega, np.log(amplitude))) / omega**2


def slip_cycle(
    modes: StuckModes,
    number: int,
    limit: Float[ndarray, " pair"],
    reach: Float[ndarray, " amplitude"],
) -> tuple[Float[ndarray, " amplitude"], Float[ndarray, " amplitude"]]:
    """What slip takes from a mode's stiffness, and its loss in the same unit (rad^2/s^2).

    First loading from rest gives the loop at every amplitude: a reversal repeats it at twice the
    size, turned round (Masing). What slips below a tenth of the
    smallest of `reach` is taken to be in proportion.
    """
    low, high = 0.1 * reach.min(), reach.max()
    loads = 1 + int(np.ceil(_LOADS_A_DECADE * np.log10(high / low)))
    load = np.concatenate([[0.0], np.geomspace(low, high, loads)])
    others = np.delete(modes.slider_shape / modes.omega, number, axis=1)
    flexible = modes.residual + others @ others.T
    give = np.diag(modes.slider_kt) - modes.slider_kt[:, None] * flexible * modes.slider_kt
    missing = _first_loading(
        load, np.ascontiguousarray(modes.slider_shape[:, number]), modes.slider_kt, give, limit
    )
    phase = (np.arange(_PHASES) + 0.5) * np.pi / _PHASES
    softer, lost = np.zeros(reach.size), np.zeros(reach.size)
    for k, q in enumerate(reach):
        # On the way from +q to -q, as a function of x = q cos(phase).
        turned = np.interp(q * (1 - np.cos(phase)) / 2, load, missing)
        loop = np.interp(q, load, missing) - 2 * turned
        softer[k] = 2 * np.mean(loop * np.cos(phase)) / q
        lost[k] = 2 * np.mean(loop * np.sin(phase)) / q
    return softer, lost


def _by_phase(forces: ModalForces, number: int, omega: float, reach: float) -> tuple[float, float]:
    """The nonlinear forces' parts in phase with displacement and against speed, over the reach."""
    phase = (np.arange(_PHASES) + 0.5) * 2 * np.pi / _PHASES
    force = _round(forces, number, omega, reach, phase)
    with_displacement = 2 * np.mean(force * np.cos(phase)) / reach
    against_speed = 2 * np.mean(force * np.sin(phase)) / reach
    return float(with_displacement), float(against_speed)


@njit(cache=True)
@no_type_check
def _round(forces, number, omega, reach, phase):
    modes = forces.geometric.shape[0]
    r, v, out = np.zeros(modes), np.zeros(modes), np.zeros(modes)
    force = np.zeros(phase.size)
    for k in range(phase.size):
        r[number] = reach * np.cos(phase[k])
        v[number] = -omega * reach * np.sin(phase[k])
        nonlinear_force(forces, r, v, out)
        force[k] = out[number]
    return force


@njit(cache=True)
@no_type_check
def _first_loading(load, shape, kt, give, limit):
    """Modal force that slip takes away at each displacement of a monotonic loading."""
    sliders = kt.size
    rho = own_give(give)
    force = np.zeros(sliders)
    slip = np.zeros(sliders)
    total = np.zeros(sliders)
    missing = np.zeros(load.size)
    for n in range(1, load.size):
        for j in range(sliders):
            force[j] += kt[j] * shape[j] * (load[n] - load[n - 1])
        slip[:] = 0.0
        settle(force, slip, give, rho, limit, _TOLERANCE, _SWEEPS)
        total += slip
        for j in range(sliders):
            missing[n] += shape[j] * kt[j] * total[j]
    return missing
