"""Cramer-Rao bound of a mode's curves when all components of the record are unknown together.

The unbiased estimator that it bounds knows the noise and the number of modes, and nothing else: for
every mode ln A and phase at the start, and omega(t) and alpha(t) as broken lines; and an offset.
Fisher's information is J^T J over the noise's variance, at the true motion. Of the other modes the
knots lie a unit of ln A apart, down to where each is lost; of the mode itself as far apart as makes
the whole error least, the bound and what the broken lines that come nearest to its law in the
samples miss of it (medians over the curve). Where they miss much more than the bound they bound
nothing: from samples without noise their best estimator would be further off than that.
"""

import numpy as np

from .event import ORDER, Event
from .flow import Flow

ROWS = 12_000  # samples taken at random stand for all, with their weight
MOST_KNOTS = 10
DENSITIES = 2.0 ** np.arange(0.0, 3.5, 0.5)  # knots in a unit of ln A
LOST = 0.1  # of the noise's standard deviation: a mode smaller than that has no more knots
FASTEST = 2.2  # samples in a cycle of a mode that is told from the others, at least
PLACES = 400  # at which the lines are held against the law


def hats(knots, times):
    """Broken lines that are one at one knot, and their integrals from the first: (knots, times)."""
    fine = np.union1d(np.linspace(knots[0], knots[-1], 4001), knots)
    values = broken(knots, fine)
    steps = 0.5 * (values[:, 1:] + values[:, :-1]) * np.diff(fine)
    integral = np.concatenate([np.zeros((knots.size, 1)), np.cumsum(steps, axis=1)], axis=1)
    return np.stack([np.interp(times, fine, row) for row in integral])


def broken(knots, times):
    """The broken lines themselves: (knots, times)."""
    return np.stack([np.interp(times, knots, row) for row in np.eye(knots.size)])


def columns(event: Event, mode: int, sensor: int, times, last: float, noise: float, density=1):
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
    count = int(np.clip(round(density * reach) + 1, 2, round(density * MOST_KNOTS)))
    knots = np.interp(np.linspace(0.0, reach, count), np.linspace(0.0, fall, 200), grid)
    knots = knots if knots[-1] > knots[0] else np.array([0.0, last])
    turned = hats(knots, times)
    rows = [wave.real, -wave.imag, *(-wave.imag * turned), *(-wave.real * turned)]
    return np.stack(rows), knots


def missed(law, start: float, rows, knots, times, places):
    """What the broken lines nearest to a law in the samples miss of omega and alpha at places.

    start: the mode's amplitude when it is free; rows: as of `columns` at times.
    """
    flow = Flow(law)
    origin = float(flow.time_at(np.log(start)))

    def rates(when):
        return np.stack(law.rates(np.exp(flow.log_at(origin + when))))

    turned, at_knots = hats(knots, times), rates(knots)
    phase = flow.phase_at(origin + times) - flow.phase_at(origin)
    fallen = np.log(start) - flow.log_at(origin + times)
    left = rows[1] * (phase - at_knots[0] @ turned) - rows[0] * (fallen - at_knots[1] @ turned)
    nearer = np.linalg.lstsq(rows.T, left, rcond=None)[0][2:].reshape(2, -1)
    return (at_knots + nearer) @ broken(knots, places) - rates(places)


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
    told = [rate >= FASTEST * m.law.omega / (2 * np.pi) for m in event.modes]
    if index.size < 100 or not told[mode] or not event.free[mode]:
        return None
    rng = np.random.default_rng(event.seed)
    part = np.sort(rng.choice(index, min(ROWS, index.size), replace=False))
    times, last = part / rate - event.excitation.free_s, end - event.excitation.free_s
    near = event.modes[mode].law.omega / (2 * np.pi)
    noise = one.noise * np.sqrt(1.0 + one.chain.flicker_Hz / near)
    others = [np.ones((1, times.size))]
    for k in range(len(event.modes)):
        if k != mode and event.free[k] and told[k]:
            others.append(columns(event, k, sensor, times, last, noise)[0])
    law, start = event.modes[mode].law, abs(event.free[mode])
    least = np.inf
    for density in DENSITIES:
        rows, knots = columns(event, mode, sensor, times, last, noise, density)
        jacobian = np.concatenate([rows, *others])
        size = np.sqrt(np.sum(jacobian**2, axis=1))
        if np.any(size == 0):
            return None
        jacobian = jacobian / size[:, None]
        information = jacobian @ jacobian.T * (index.size / part.size / noise**2)
        covariance = np.linalg.pinv(information, rcond=1e-13, hermitian=True)
        covariance /= np.outer(size, size)
        own = [slice(2 + n * knots.size, 2 + (n + 1) * knots.size) for n in range(2)]
        places = np.linspace(knots[0], knots[-1], PLACES)
        known = np.stack([_deviation(covariance[a, a], knots, places) for a in own])
        off = missed(law, start, rows, knots, times, places)
        whole = np.prod(np.median(np.hypot(known, off), axis=1))
        if whole < least:
            least, best = whole, (knots, [covariance[a, a] for a in own])
    knots, (of_omega, of_alpha) = best
    flow = Flow(law)
    origin = float(flow.time_at(np.log(start)))

    def stds(amplitude):
        modal = np.asarray(amplitude) / one.at_modes[mode]
        when = np.clip(flow.time_at(np.log(modal)) - origin, knots[0], knots[-1])
        omega, alpha = (_deviation(part, knots, when) for part in (of_omega, of_alpha))
        return omega / (2 * np.pi), 2.0 * alpha / law.rates(modal)[0]

    return stds


def _deviation(covariance, knots, when):
    """Standard deviation of a broken line at times, from the covariance of its knots."""
    weight = broken(knots, when)
    return np.sqrt(np.einsum("ip,ij,jp->p", weight, covariance, weight))
