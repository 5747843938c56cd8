"""Cramer-Rao bound of a mode's curves when all components of the record are unknown together.

The unbiased estimator that it bounds knows the noise and the number of modes, and nothing else: for
every mode ln A and phase at the start, and omega(t) and alpha(t) as broken lines whose knots lie a
unit of that mode's ln A apart, down to where it is lost; and an offset. Fisher's information is J^T
J over the noise's variance, at the true motion. A smoother or a rougher law than one knot for each
e-fold of the amplitude would be bounded lower or higher.
"""

import numpy as np

from .event import ORDER, Event
from .flow import Flow

ROWS = 12_000  # samples taken at random stand for all, with their weight
MOST_KNOTS = 10
LOST = 0.1  # of the noise's standard deviation: a mode smaller than that has no more knots


def hats(knots, times):
    """Broken lines that are one at one knot, and their integrals from the first: (knots, times)."""
    fine = np.union1d(np.linspace(knots[0], knots[-1], 4001), knots)
    values = np.stack([np.interp(fine, knots, row) for row in np.eye(knots.size)])
    steps = 0.5 * (values[:, 1:] + values[:, :-1]) * np.diff(fine)
    integral = np.concatenate([np.zeros((knots.size, 1)), np.cumsum(steps, axis=1)], axis=1)
    return np.stack([np.interp(times, fine, row) for row in integral])


def columns(event: Event, mode: int, sensor: int, times, last: float, noise: float):
    """Derivatives of the samples by a mode's unknowns, and its knots (s after it is free)."""
    law, one = event.modes[mode].law, event.sensors[sensor]
    flow = Flow(law)
    z = flow.free(event.free[mode], times)
    omega, _ = law.rates(np.abs(z))
    factor = one.at_modes[mode] * (1j * omega) ** ORDER[one.chain.quantity]
    wave = factor * z
    log = np.log(abs(event.free[mode]))
    size = np.abs(factor[0]) * abs(event.free[mode])
    fall = min(np.log(max(size / (LOST * noise), 3.0)), 12.0)
    grid = flow.time_at(np.linspace(log, log - fall, 200)) - flow.time_at(log)
    end = min(float(grid[-1]), last)
    reach = np.interp(end, grid, np.linspace(0.0, fall, 200))
    count = int(np.clip(round(reach) + 1, 2, MOST_KNOTS))
    knots = np.interp(np.linspace(0.0, reach, count), np.linspace(0.0, fall, 200), grid)
    knots = knots if knots[-1] > knots[0] else np.array([0.0, last])
    turned = hats(knots, times)
    rows = [wave.real, -wave.imag, *(-wave.imag * turned), *(-wave.real * turned)]
    return np.stack(rows), knots


def bounds(event: Event, mode: int, sensor: int):
    """Smallest standard deviation of frequency (Hz) and loss factor as a function of amplitude (m).

    Returns:
        a function of amplitudes at the sensor, or None where the motion has no closed form.
    """
    if not all(event.free[k] or not m.structural for k, m in enumerate(event.modes)):
        return None
    one, rate = event.sensors[sensor], event.sampling_Hz
    begin = max(event.excitation.free_s, 0.0)
    end = min(one.samples.size / rate, event.excitation.late_s)
    index = np.arange(int(np.ceil(begin * rate)), int(end * rate))
    if index.size < 100:
        return None
    rng = np.random.default_rng(event.seed)
    part = np.sort(rng.choice(index, min(ROWS, index.size), replace=False))
    times, last = part / rate - event.excitation.free_s, end - event.excitation.free_s
    near = event.modes[mode].law.omega / (2 * np.pi)
    noise = one.noise * np.sqrt(1.0 + one.chain.flicker_Hz / near)
    blocks, at, start = [np.ones((1, times.size))], None, 1
    for k, other in enumerate(event.modes):
        if not event.free[k] or rate < 2.2 * other.law.omega / (2 * np.pi):
            continue
        rows, knots = columns(event, k, sensor, times, last, noise)
        if k == mode:
            at = start + 2, knots
        start += rows.shape[0]
        blocks.append(rows)
    jacobian = np.concatenate(blocks)
    size = np.sqrt(np.sum(jacobian**2, axis=1))
    jacobian = jacobian[size > 0] / size[size > 0, None]
    if at is None or np.any(size == 0):
        return None
    information = jacobian @ jacobian.T * (index.size / part.size / noise**2)
    covariance = np.linalg.pinv(information, rcond=1e-13, hermitian=True)
    covariance /= np.outer(size, size)
    first, knots = at
    count = knots.size
    omega = covariance[first : first + count, first : first + count]
    alpha = covariance[first + count : first + 2 * count, first + count : first + 2 * count]
    flow, law = Flow(event.modes[mode].law), event.modes[mode].law
    origin = float(flow.time_at(np.log(abs(event.free[mode]))))

    def stds(amplitude):
        modal = np.asarray(amplitude) / one.at_modes[mode]
        when = np.clip(flow.time_at(np.log(modal)) - origin, knots[0], knots[-1])
        weight = np.stack([np.interp(when, knots, row) for row in np.eye(count)])
        frequency = np.sqrt(np.einsum("ip,ij,jp->p", weight, omega, weight)) / (2 * np.pi)
        decay = np.sqrt(np.einsum("ip,ij,jp->p", weight, alpha, weight))
        return frequency, 2.0 * decay / law.rates(modal)[0]

    return stds
