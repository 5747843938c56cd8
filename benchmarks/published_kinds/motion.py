"""Motions of one mode and what is true of them, over amplitude or time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy import ndarray
from scipy.interpolate import CubicSpline

ORDER = {"displacement": 0, "velocity": 1, "acceleration": 2}
TURN = 2.0 * np.pi

Truth = Callable[[ndarray], tuple[ndarray, ndarray]]  # natural frequency (Hz) and loss factor


@dataclass
class Record:
    """Samples in SI, told in `unit`, and truth over amplitude (m) or, if so, over time (s)."""

    samples: ndarray
    rate: float
    quantity: str
    mode_Hz: float
    truth: Truth
    unit: str | None = None
    others: Sequence[float] = ()
    over_time: bool = False


def natural(rate: ndarray, bend: ndarray) -> tuple[ndarray, ndarray]:
    """Frequency (Hz) and loss factor of Y, of (ln Y)' (1/s) and its derivative (1/s^2)."""
    square = -(rate**2 + bend)
    return np.sqrt(np.abs(square.real)) / TURN, square.imag / square.real


class Law:
    """A slow flow: (ln Y)' = -loss w / 2 + i w with w = 2 pi turn, both functions of A (m)."""

    def __init__(self, turn: Callable, loss: Callable, largest: float) -> None:
        self.log = np.linspace(np.log(1.05 * largest), np.log(1e-5 * largest), 6000)
        omega = TURN * turn(np.exp(self.log))
        self.rate = omega * (1j - 0.5 * loss(np.exp(self.log)))
        self.bend = self.rate.real * np.gradient(self.rate, self.log)

    def at(self, log: ndarray) -> tuple[ndarray, ndarray]:
        """(ln Y)' and its derivative at ln A."""
        return np.interp(-log, -self.log, self.rate), np.interp(-log, -self.log, self.bend)

    def truth(self, amplitude: ndarray) -> tuple[ndarray, ndarray]:
        """Frequency (Hz) and loss factor at an amplitude (m)."""
        return natural(*self.at(np.log(amplitude)))

    def motion(self, since: ndarray, start: float, phase: float, quantity: str) -> ndarray:
        """What a sensor of the quantity sees from time zero (s) and amplitude `start` (m) on."""
        log = np.r_[np.log(start), self.log[self.log < np.log(start) - 1e-9]]
        rate, _ = self.at(log)
        fall = CubicSpline(-log, -1.0 / rate.real).antiderivative()(-log)
        turned = CubicSpline(-log, -rate.imag / rate.real).antiderivative()(-log)
        within = np.clip(since, 0.0, fall[-1])
        value = CubicSpline(fall, log)(within) + 1j * CubicSpline(fall, turned)(within)
        value = value + rate[-1] * np.maximum(since - fall[-1], 0.0) + 1j * phase
        slope, bend = self.at(value.real)
        factor = {"displacement": 1.0, "velocity": slope, "acceleration": slope**2 + bend}
        return np.where(since >= 0.0, (np.exp(value) * factor[quantity]).real, 0.0)


def plain(mode_Hz: float, loss: float, since: ndarray, size: float, phase: float) -> ndarray:
    """A plain exponential from time zero (s) on, of any quantity and in the size's unit."""
    pole = 1j * TURN * mode_Hz * np.sqrt(1.0 + 1j * loss)
    value = size * np.exp(pole * np.maximum(since, 0.0) + 1j * phase)
    return np.where(since >= 0.0, value.real, 0.0)


class Terms(NamedTuple):
    """Forces over mass on x, and on a second coordinate y that it is coupled to (rad/s, SI)."""

    omega: float
    zeta: float
    cubic: float = 0.0
    drag: float = 0.0  # of v |v|
    dry: float = 0.0
    dry_speed: float = 1.0  # below it dry friction is viscous
    gap: float = 0.0
    stop: float = 0.0  # stiffness beyond the gap, on either side
    omega_2: float = 1.0
    zeta_2: float = 0.0
    two: float = 0.0  # of the potential x^2 y
    three: float = 0.0  # of the potential x^3 y


@njit
def _slope(state, p):
    x, v, y, u = state
    spring = p.omega**2 * x
    if abs(x) > p.gap:
        spring += p.stop * (abs(x) - p.gap) * np.sign(x)
    push = -spring - 2.0 * p.zeta * p.omega * v - p.cubic * x**3 - p.drag * v * abs(v)
    push -= p.dry * np.tanh(v / p.dry_speed) + 2.0 * p.two * x * y + 3.0 * p.three * x * x * y
    other = -(p.omega_2**2) * y - 2.0 * p.zeta_2 * p.omega_2 * u - p.two * x * x - p.three * x**3
    return np.array([v, push, u, other])


@njit
def _integrated(state, p, step, within, count):
    """x, x', x'', y, y', y'' at each sample, by Runge-Kutta's fourth order."""
    out, h = np.empty((count, 6)), step / within
    for i in range(count):
        slope = _slope(state, p)
        out[i, :3] = state[0], state[1], slope[1]
        out[i, 3:] = state[2], state[3], slope[3]
        for _ in range(within):
            a = _slope(state, p)
            b = _slope(state + 0.5 * h * a, p)
            c = _slope(state + 0.5 * h * b, p)
            state = state + h / 6.0 * (a + 2.0 * b + 2.0 * c + _slope(state + h * c, p))
    return out


@njit
def followed_sliders(start, omega, zeta, stiffness, reach, step, within, count):
    """x, x', x'' of a mass on sliders that was pulled slowly, by Verlet's steps."""
    force, out, h = np.minimum(start, reach), np.empty((count, 3)), step / within
    x, v, drag = start, 0.0, 2.0 * zeta * omega
    push = -(omega**2) * x - np.sum(stiffness * force)
    for i in range(count):
        out[i] = x, v, push - drag * v
        for _ in range(within):
            v += 0.5 * h * (push - drag * v)
            x += h * v
            force = np.minimum(np.maximum(force + h * v, -reach), reach)
            push = -(omega**2) * x - np.sum(stiffness * force)
            v = (v + 0.5 * h * push) / (1.0 + 0.5 * h * drag)
    return out


def solver(terms: Terms, mode_Hz: float, steps: int = 80) -> Callable:
    """The motion from (start, rate, count), with at least `steps` steps a cycle."""

    def made(start, rate, count, second=0.0):
        state, within = np.array([start, 0.0, second, 0.0]), int(np.ceil(steps * mode_Hz / rate))
        return _integrated(state, terms, 1.0 / rate, within, count)

    return made


def demodulated(
    x: ndarray, rate: float, mode_Hz: float, width: float = 0.5, taken: ndarray | float = 0.0
) -> tuple:
    """ln A, and frequency (Hz) and loss factor of a noiseless x exp(taken), in a flat band."""
    line = np.fft.fftfreq(2 ** int(np.ceil(np.log2(1.2 * x.size))), 1.0 / rate)
    band = 2.0 * (line > 0.0) * np.exp(-(((line / mode_Hz - 1.0) / width) ** 8))
    still = np.fft.ifft(np.fft.fft(x, line.size) * band)[: x.size]
    log = np.log(np.maximum(np.abs(still), 1e-300)) + taken
    slope = np.gradient(log + 1j * np.unwrap(np.angle(still))) * rate
    return log, natural(slope, np.gradient(slope) * rate)


def turns(motion: ndarray, rate: float, least: float) -> tuple[ndarray, float]:
    """Where a motion turns while above a part of its largest, and its frequency (Hz) there."""
    x = np.abs(motion[:, 0])
    at = np.flatnonzero((np.diff(np.sign(motion[:, 1])) != 0.0) & (x[1:] > least * x.max()))
    return at, 0.5 * rate * (at.size - 1) / (at[-1] - at[0])


def truth_of(
    made: Callable, start: float, rate: float, count: int, mode_Hz: float, larger: float = 1.7
) -> Truth:
    """Truth over amplitude, of a longer motion from rest at so much more than the start."""
    finer = int(np.ceil(24.0 * mode_Hz / rate))
    rate, cycle = finer * rate, int(finer * rate / mode_Hz)
    motion = made(larger * start, rate, 4 * count * finer + 20 * cycle)
    (at, seen_Hz), x = turns(motion, rate, 1e-3), motion[:, 0]
    # its first decline is taken off, smoothly, and its start, from rest, mirrored
    slope, lead = np.log(np.abs(x[at[6]] / x[at[0]])) / (at[6] - at[0]), 4 * cycle
    taken = slope * lead * np.tanh(np.maximum(np.arange(-lead, x.size), 0) / lead)
    x = x * np.exp(-taken[lead:])
    log, true = demodulated(np.r_[x[lead:0:-1], x], rate, seen_Hz, taken=taken)
    ended = np.flatnonzero(log[2 * lead :] < log[lead] + np.log(3e-4))
    good = slice(5 * cycle, 2 * lead + ended[0] if ended.size else x.size - lead)
    order = good.start + np.argsort(log[good])
    return lambda a: tuple(np.interp(np.log(a), log[order], one[order]) for one in true)
