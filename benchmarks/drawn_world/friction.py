"""Direct time integration: modes coupled by a real friction element, and its backbone.

Element: Jenkins sliders in parallel, or Bouc-Wen. Steps are half a kick, the linear modes' exact
flow, half a kick. The truth of a mode is read off a clean decay of the same system in which that
mode alone starts: its analytic signal over whole cycles, no noise and no other mode beside it.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.interpolate import PchipInterpolator

from .laws import Law

PER_CYCLE = 120  # steps in a cycle of the highest mode
READ_CYCLES = 1  # half the distance over which the backbone's slopes are taken
LEAST_CYCLES = 60  # of a decay from which a backbone is read
LEAST_FALLS = 10  # points of it, half a cycle apart, each below all before
# How far the law that a mode follows in an event may be from the one that it has alone.
AGREES_HZ, AGREES_LOSS = 3e-5, 0.02


@dataclass(frozen=True)
class Friction:
    """Sliders (stiffness and limit per modal mass), or Bouc-Wen with one of each."""

    kind: str
    stiffness: np.ndarray
    limit: np.ndarray
    exponent: float
    couple: np.ndarray  # of the modes to the element


@njit(cache=True)
def _integrate(q, v, flow, push, bouc, stiffness, limit, exponent, couple, dt, count, every):
    modes = q.size
    out = np.zeros((3, modes, count))
    held = np.zeros(stiffness.size)
    total = 0.0
    y = np.sum(couple * q)
    kick = np.zeros(modes)
    for step in range((count - 1) * every + 1):
        for k in range(modes):
            kick[k] = -couple[k] * total
            if step < push.shape[1]:
                kick[k] += push[k, step]
        if step % every == 0:
            at = step // every
            for k in range(modes):
                out[0, k, at] = q[k]
                out[1, k, at] = v[k]
                out[2, k, at] = flow[k, 4] * q[k] + flow[k, 5] * v[k] + kick[k]
        for k in range(modes):
            speed = v[k] + 0.5 * dt * kick[k]
            q0 = q[k]
            q[k] = flow[k, 0] * q0 + flow[k, 1] * speed
            v[k] = flow[k, 2] * q0 + flow[k, 3] * speed
        new = np.sum(couple * q)
        dy = new - y
        y = new
        total = 0.0
        for i in range(stiffness.size):
            if bouc:
                z, moved = held[i] / limit[i], stiffness[i] * dy / limit[i]
                parts = int(abs(moved) / 0.05) + 1
                for _ in range(parts):
                    turns = 1.0 if moved * z > 0.0 else 0.0
                    z += moved / parts * (1.0 - abs(z) ** exponent * turns)
                held[i] = min(max(z, -1.0), 1.0) * limit[i]
            else:
                held[i] = min(max(held[i] + stiffness[i] * dy, -limit[i]), limit[i])
            total += held[i]
        for k in range(modes):
            kick[k] = -couple[k] * total
            if step + 1 < push.shape[1]:
                kick[k] += push[k, step + 1]
            v[k] += 0.5 * dt * kick[k]
    return out


def linear_flow(omega, zeta, dt):
    """Rows: the exact step of (q, v), then the acceleration's factors, for each mode."""
    alpha = zeta * omega
    turned = np.sqrt(omega**2 - alpha**2)
    decay, c, s = np.exp(-alpha * dt), np.cos(turned * dt), np.sin(turned * dt)
    return np.stack(
        [
            decay * (c + alpha / turned * s), decay * s / turned,
            -decay * omega**2 / turned * s, decay * (c - alpha / turned * s),
            -(omega**2), -2.0 * alpha,
        ],
        axis=1,
    )  # fmt: skip


def integrate(omega, zeta, friction, q, v, forces, rate_Hz, count, highest_Hz):
    """Displacement, velocity and acceleration of the modes: (3, modes, count) at rate_Hz.

    forces: a function of time (s, array) that returns (modes, times), and how long it acts (s).
    """
    every = max(1, int(np.ceil(PER_CYCLE * highest_Hz / rate_Hz)))
    dt = 1.0 / (rate_Hz * every)
    function, lasts = forces
    push = (
        function(dt * np.arange(int(np.ceil(lasts / dt)) + 2))
        if lasts > 0
        else np.zeros((q.size, 0))
    )
    return _integrate(
        q.copy(), v.copy(), linear_flow(omega, zeta, dt), push, friction.kind == "bouc-wen",
        friction.stiffness, friction.limit, friction.exponent, friction.couple, dt, count, every,
    )  # fmt: skip


def backbone(time_step: float, displacement, frequency_Hz: float, name: str) -> Law | None:
    """The law that a clean decay follows, from its analytic signal; None where it does not fall."""
    count = displacement.size
    cycle = round(1.0 / (frequency_Hz * time_step))
    # ends that go in smoothly, lest their jump leak into the rest
    end = np.minimum(np.arange(count), np.arange(count)[::-1]) / (10.0 * cycle)
    spectrum = np.fft.fft(displacement * np.sin(0.5 * np.pi * np.minimum(end, 1.0)) ** 2)
    frequency = np.fft.fftfreq(count, time_step) / frequency_Hz
    edge = np.clip((0.5 - np.abs(frequency - 1.0)) / 0.2, 0.0, 1.0)
    analytic = 2.0 * np.fft.ifft(
        spectrum * np.where(frequency > 0, np.sin(0.5 * np.pi * edge) ** 2, 0)
    )
    at = np.arange(15 * cycle, count - 15 * cycle, max(1, cycle // 2))
    size = np.maximum(np.abs(analytic), np.finfo(float).tiny)
    phase, log, reach = np.unwrap(np.angle(analytic)), np.log(size), READ_CYCLES * cycle
    span = 2.0 * reach * time_step
    omega = (phase[at + reach] - phase[at - reach]) / span
    alpha = -(log[at + reach] - log[at - reach]) / span
    # the mean slope over the span belongs to the mean of ln A there, not to its middle
    mean = np.array([log[i - reach : i + reach + 1].mean() for i in at])
    falls = np.concatenate([[True], mean[1:] < np.minimum.accumulate(mean)[:-1]])
    if np.count_nonzero(falls) < LEAST_FALLS:
        return None
    u, omega, alpha = (part[falls][::-1] for part in (mean, omega, alpha))
    turn, decay = PchipInterpolator(u, omega), PchipInterpolator(u, alpha)
    nominal = 2.0 * np.pi * frequency_Hz

    def shape(x):
        known = np.clip(np.log(x), u[0], u[-1])
        return turn(known) / nominal - 1.0, decay(known) / turn(known)

    return Law(name, nominal, 1.0, shape)


def agrees(law: Law, time_step: float, displacement, frequency_Hz: float) -> bool:
    """Whether a mode beside the others follows the law that it has alone.

    The others shake the element too, and a mode that they have outlived is theirs to move: then
    there is no law of the amplitude to be found in the record.
    """
    cycle = 1.0 / (frequency_Hz * time_step)
    if displacement.size < LEAST_CYCLES * cycle:
        return False
    own = backbone(time_step, displacement - displacement.mean(), frequency_Hz, "own")
    if own is None:
        return False
    first = np.abs(displacement[round(16 * cycle) : round(18 * cycle)]).max()
    last = np.abs(displacement[-round(18 * cycle) : -round(16 * cycle)]).max()
    amplitude = np.geomspace(max(last, first * np.exp(-4.0)), first, 9)
    pairs = zip(own.truth(amplitude), law.truth(amplitude), (AGREES_HZ, AGREES_LOSS), strict=True)
    return all(np.median(np.abs(a / b - 1.0)) < most for a, b, most in pairs)
