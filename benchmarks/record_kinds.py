"""Kinds of ring-downs as published data sets hold them: right, told, silent or no curve, each kind.

    python benchmarks/record_kinds.py                # thirty of each kind, about a minute
    python benchmarks/record_kinds.py --seed 7 --count 3 --kinds doublet stop --each

Each kind is a structure with a sensor and what the two do to a record: some equations of motion are
integrated, some laws of amplitude are followed as a slow flow, some modes are plain exponentials.
Nothing is shared with the library but the call of `br.ringdown`, which is told the sampling, the
quantity, the unit, the mode to within 1 to 3 % and, of seven records in ten, other modes to 0.5 %.

True is Y'' + w^2 (1 + i eta) Y = 0 for Y = A exp(i phi), of a law from the law itself, of what is
integrated from A and phi of a longer, noiseless motion (of two modes in resonance, of the same
motion, over time). A point is right within WRONG_PPM of the frequency or three stated errors, and
within WRONG_LOSS of the loss factor or three; a curve, if 95 % of its points are. A curve that is
not is told where there is a finding, but for the one that asks for the unit, and silent otherwise.
Record k of kind i is drawn from the seed and 1000 i + k.
"""

import argparse
import secrets
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import bladeroot as br
import numpy as np
from numba import njit
from numpy import ndarray
from numpy.random import Generator
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter

WRONG_PPM = 500.0
WRONG_LOSS = 0.1
ORDER = {"displacement": 0, "velocity": 1, "acceleration": 2}
IN_SI = {None: 1.0, "g": 9.80665, "mm": 1e-3}
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


# motions and their truths


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
def _sliders(start, omega, zeta, stiffness, reach, step, within, count):
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


# what the kinds have in common


def between(rng: Generator, low: float, high: float) -> float:
    """A number drawn evenly in its logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def white(rng: Generator, x: ndarray, low: float, high: float, size: float) -> ndarray:
    """White noise as long as x, of an rms between two parts of a size."""
    return between(rng, low, high) * size * rng.standard_normal(len(x))


def integrated(
    rng: Generator, made: Callable, mode_Hz: float, start: float, a_cycle: tuple, cycles: tuple,
    quantity: str | None = None, held: float = 0.0, noise: tuple = (3e-4, 5e-3), **truth: float,
) -> Record:  # fmt: skip
    """A motion from rest at `start` (m), held there before for a drawn part of its length."""
    rate, quantity = mode_Hz * between(rng, *a_cycle), quantity or str(rng.choice(list(ORDER)))
    count = int(between(rng, *cycles) * rate / mode_Hz)
    motion = made(start, rate, count)
    x, seen_Hz = motion[:, ORDER[quantity]], turns(motion, rate, 0.5)[1]
    rest = start if quantity == "displacement" else 0.0
    x = np.r_[np.full(int(rng.uniform(0.0, held) * count), rest), x]
    x = x + white(rng, x, *noise, np.abs(x).max())
    return Record(x, rate, quantity, seen_Hz, truth_of(made, start, rate, count, mode_Hz, **truth))


def joint(
    rng: Generator, mode_Hz: float, start: float, softening: tuple = (1e-3, 2e-2),
    loss: tuple = (1e-3, 6e-3),
) -> Law:  # fmt: skip
    """Powers of the amplitude that level off: softer and more damped at large ones."""
    drop, least, rise = between(rng, *softening), between(rng, *loss), rng.uniform(0.5, 4.0)
    one, two = rng.uniform(0.5, 1.4), rng.uniform(0.5, 1.2)

    def levelled(a, power, most):
        return (a / start) ** power / (1.0 + most * (a / start) ** power)

    return Law(
        lambda a: mode_Hz * (1.0 - drop * levelled(a, one, 0.3)),
        lambda a: least * (1.0 + rise * levelled(a, two, 0.5)),
        start,
    )


def let_go(
    rng: Generator, mode_Hz: float, start: float, rate: float, cycles: tuple, quantity: str,
    lead: tuple = (0.0, 0.1), noise: tuple = (5e-4, 3e-3), phase: float = 0.0, **law: tuple,
) -> tuple[Record, ndarray, float]:  # fmt: skip
    """A joint's decay from `start` (m), time from then on (s), and its size in the quantity."""
    length, flow = between(rng, *cycles) / mode_Hz, joint(rng, mode_Hz, start, **law)
    since = np.arange(int(length * rate)) / rate - rng.uniform(*lead) * length
    x, size = (
        flow.motion(since, start, phase, quantity),
        start * (TURN * mode_Hz) ** ORDER[quantity],
    )
    x += white(rng, x, *noise, size)
    if quantity == "displacement":
        x += np.where(since < 0.0, start, 0.0)
    return Record(x, float(rate), quantity, mode_Hz, flow.truth), since, size


# the kinds


def sliders(rng: Generator) -> Record:
    """A mass on one slider or fourteen (Jenkins, Iwan), seen by an accelerometer in g."""
    f, start, share = rng.uniform(30.0, 400.0), between(rng, 1e-5, 1e-3), rng.uniform(0.02, 0.12)
    reach = np.geomspace(between(rng, 0.01, 0.2), rng.uniform(0.6, 2.0), 14)
    reach = start * (reach if rng.random() < 0.5 else np.array([rng.uniform(0.03, 0.3)]))
    each = np.full(reach.size, share * (TURN * f) ** 2 / reach.size)
    own, zeta = TURN * f * np.sqrt(1.0 - share), between(rng, 3e-4, 4e-3)

    def made(start, rate, count):
        within = int(np.ceil(400.0 * f / rate))
        return _sliders(start, own, zeta, each, reach, 1.0 / rate, within, count)

    record = integrated(rng, made, f, start, (15.0, 80.0), (80.0, 400.0), "acceleration", 0.1)
    record.unit = "g"
    return record


def clamped_beam(rng: Generator) -> Record:
    """A stiffness that grows, or falls, with the square of x (Duffing)."""
    f, start = rng.uniform(15.0, 200.0), between(rng, 1e-4, 5e-3)
    cubic = (TURN * f / start) ** 2 * between(rng, 0.01, 0.3) * rng.choice([1.0, 1.0, -0.4])
    made = solver(Terms(TURN * f, between(rng, 5e-4, 8e-3), cubic=cubic), f)
    return integrated(rng, made, f, start, (15.0, 70.0), (100.0, 600.0))


def stop(rng: Generator) -> Record:
    """A stop on either side, beyond a gap."""
    f, start = rng.uniform(20.0, 200.0), between(rng, 1e-4, 2e-3)
    gap, stiffness = start * rng.uniform(0.15, 0.6), (TURN * f) ** 2 * rng.uniform(0.05, 0.8)
    made = solver(Terms(TURN * f, between(rng, 1e-3, 8e-3), gap=gap, stop=stiffness), f)
    return integrated(rng, made, f, start, (20.0, 80.0), (120.0, 500.0))


def dry_slide(rng: Generator) -> Record:
    """A mass on a slide that dry friction stops, held and let go, seen in mm."""
    f, start, lasts = rng.uniform(2.0, 40.0), between(rng, 1e-3, 2e-2), rng.uniform(15.0, 70.0)
    dry, speed = 0.225 * (TURN * f) ** 2 * start / lasts, 2e-3 * TURN * f * start
    made = solver(Terms(TURN * f, between(rng, 5e-4, 5e-3), dry=dry, dry_speed=speed), f, 480)
    cycles = (1.4 * lasts, 1.4 * lasts)
    record = integrated(rng, made, f, start, (15.0, 200.0), cycles, "displacement", 0.3)
    record.unit = "mm"
    return record


def ship_roll(rng: Generator) -> Record:
    """Ten to twenty-five cycles of a heavily damped roll (rad) with drag."""
    f, start = rng.uniform(0.05, 0.6), np.radians(rng.uniform(8.0, 20.0))
    cubic, drag = (TURN * f) ** 2 * rng.uniform(-0.5, 0.8), rng.uniform(0.0, 0.15)
    made = solver(Terms(TURN * f, between(rng, 8e-3, 3e-2), cubic, drag), f)
    return integrated(
        rng, made, f, start, (20.0, 200.0), (10.0, 25.0), "displacement", 0.2, (1e-3, 5e-3),
        larger=2.0,
    )  # fmt: skip


def internal_resonance(rng: Generator) -> Record:
    """Two modes near 1 to 2 or 1 to 3 that pass energy to and fro, one of them asked for."""
    f, start, ratio = rng.uniform(40.0, 200.0), between(rng, 1e-4, 1e-3), int(rng.integers(2, 4))
    rate, second = f * between(rng, 26.0, 104.0), f * ratio * rng.uniform(0.96, 1.04)
    count, quantity = int(between(rng, 150.0, 500.0) * rate / f), str(rng.choice(list(ORDER)))
    terms = Terms(
        TURN * f, between(rng, 1e-3, 5e-3), omega_2=TURN * second, zeta_2=between(rng, 1e-3, 5e-3),
        two=(ratio == 2) * (TURN * f) ** 2 * between(rng, 2e-3, 3e-2) / start,
        three=(ratio == 3) * (TURN * f / start) ** 2 * between(rng, 2e-3, 5e-2),
    )  # fmt: skip
    lead = int(8.0 * rate / f)  # the truth's motion is longer, and mirrored at its start
    made = solver(terms, f, 200)(start, rate, count + lead, start * rng.uniform(-0.2, 0.2))
    asked, other = (f, second) if rng.random() < 0.6 else (second, f)
    both = made[:, :3] + rng.uniform(0.3, 1.0) * made[:, 3:]
    _, true = demodulated(np.r_[both[lead:0:-1, 0], both[:, 0]], rate, asked, 0.25)
    time, x = np.arange(-lead, count + lead) / rate, both[:count, ORDER[quantity]]
    x = x + white(rng, x, 3e-4, 3e-3, np.abs(x).max())

    def truth(at):
        return tuple(np.interp(at, time, one) for one in true)

    return Record(x, rate, quantity, asked, truth, others=[other], over_time=True)


def bolted_beam(rng: Generator) -> Record:
    """Four modes of a free beam with a joint after a blow, the sensor perhaps near a node."""
    first, rate = rng.uniform(40.0, 250.0), float(rng.choice([5120, 12800, 25600]))
    f = first * np.array([1.0, 2.757, 5.404, 8.93]) * rng.normal(1.0, 0.01, 4)
    since = np.arange(int(rng.uniform(1.0, 5.0) * rate)) / rate - rng.uniform(0.02, 0.2)
    asked, node = int(rng.integers(3)), between(rng, 0.02, 0.1) if rng.random() < 0.3 else 1.0
    sizes = between(rng, 1e-6, 5e-5) * rng.uniform(0.3, 1.0, 4) * (first / f) ** 1.5
    laws = [joint(rng, *one) for one in zip(f, sizes, strict=True)]
    phases, quantity = (
        rng.normal(-0.5 * np.pi, 0.1, 4),
        str(rng.choice(["velocity", "acceleration"])),
    )
    x = sum(
        (node if k == asked else 1.0) * law.motion(since, sizes[k], phases[k], quantity)
        for k, law in enumerate(laws)
    )
    x = x + white(rng, x, 5e-4, 5e-3, node * sizes[asked] * (TURN * f[asked]) ** ORDER[quantity])

    def truth(a):
        return laws[asked].truth(a / node)

    return Record(x, rate, quantity, f[asked], truth, others=np.delete(f, asked))


def tuning_fork(rng: Generator) -> Record:
    """A fork before a microphone: full scale, a harmonic, the clang, mains and pink noise."""
    f, rate = rng.uniform(250.0, 530.0), float(rng.choice([16000, 44100]))
    time = np.arange(int(rng.uniform(3.0, 7.0) * rate)) / rate
    since, least = time - rng.uniform(0.1, 1.0), between(rng, 2e-4, 2e-3)
    law = Law(lambda a: f * (1.0 - 2e-4 * a**2), lambda a: least * (1.0 + 0.3 * a), 1.0)
    x = law.motion(since, 1.0, rng.uniform(0.0, TURN), "acceleration") / (TURN * f) ** 2
    x += 0.08 * x**2 + plain(6.27 * f, 5e-4, since, 0.3, 1.0)
    line = np.maximum(np.fft.rfftfreq(x.size, 1.0 / rate), rate / x.size)
    pink = np.fft.irfft(np.fft.rfft(rng.standard_normal(x.size)) / np.sqrt(line), x.size)
    x += between(rng, 2e-3, 2e-2) * pink / pink.std()
    x += 3e-3 * np.sin(TURN * 50.0 * time) + 2e-3 * np.sin(TURN * 150.0 * time + 1.0)
    x = np.clip(np.round(x / 2.2 * 2**15) / 2**15, -1.0, 1.0)
    return Record(x, rate, "acceleration", f, lambda a: law.truth(a * 2.2 * (TURN * f) ** 2))


def windy_tower(rng: Generator) -> Record:
    """A tower let go in wind that shakes the same mode, sampled at 10 to 50 Hz."""
    f, rate, loss = rng.uniform(0.15, 0.6), rng.choice([10.0, 20.0, 50.0]), between(rng, 4e-3, 2e-2)
    record, since, size = let_go(
        rng, f, rng.uniform(0.01, 0.2), rate, (60.0, 200.0),
        str(rng.choice(["velocity", "acceleration"])), (0.1, 0.3), loss=(loss, loss),
    )  # fmt: skip
    pole, lead = np.exp(TURN * f * (1j - 0.5 * loss) / rate), int(2.0 * rate / (loss * f))
    shaken = lfilter([1.0], [1.0, -pole], rng.standard_normal(since.size + lead))[lead:].imag
    record.samples += between(rng, 1e-3, 1.5e-2) * size * shaken / shaken.std()
    return record


def video(rng: Generator) -> Record:
    """A target followed in pixels, with frames that come twice, are lost or are left out."""
    f, rate, start = (
        rng.uniform(1.5, 20.0),
        rng.choice([120.0, 240.0, 960.0]),
        rng.uniform(3.0, 60.0),
    )
    noise = (0.02 / start, 0.15 / start)
    record, _, _ = let_go(
        rng, f, start, rate, (40.0, 150.0), "displacement", noise=noise, loss=(3e-3, 1.5e-2)
    )
    x = record.samples + rng.uniform(200.0, 900.0)
    which = rng.choice(x.size - 10, max(2, int(x.size * between(rng, 5e-4, 4e-3))), False) + 5
    fault = rng.integers(3)
    if fault < 2:
        x[which] = x[which - 1] if fault else np.nan
    record.samples = x if fault < 2 else np.delete(x, which[:2])
    return record


def charge_amplifier(rng: Generator) -> Record:
    """An accelerometer whose amplifier is pushed off zero by the blow and creeps back."""
    f = rng.uniform(4.0, 60.0)
    rate, corner = f * between(rng, 20.0, 120.0), f / rng.uniform(10.0, 60.0)
    record, since, size = let_go(
        rng, f, between(rng, 1e-5, 1e-3), rate, (80.0, 300.0), "acceleration",
        phase=-0.5 * np.pi, loss=(2e-3, 1e-2),
    )  # fmt: skip
    blow = np.where((since > 0.0) & (since < 0.15 / f), np.sin(np.pi * since * f / 0.15), 0.0)
    x = rng.uniform(0.5, 4.0) * blow + rng.uniform(-0.3, 0.3) * (since > 0.0)
    keep, slow = np.exp(-TURN * corner / rate), record.truth
    gate = 0.5 * (1.0 + keep) * np.array([1.0, -1.0])
    record.samples = lfilter(gate, [1.0, -keep], record.samples + size * x)
    record.truth = lambda a: slow(a * np.sqrt(1.0 + (corner / f) ** 2))
    return record


def strain_gauge(rng: Generator) -> Record:
    """Strain of a released cantilever, with drift, a random walk and the mains."""
    f = rng.uniform(5.0, 120.0)
    rate = f * between(rng, 15.0, 100.0)
    record, since, size = let_go(
        rng, f, between(rng, 5e-5, 8e-4), rate, (60.0, 400.0), "displacement", loss=(1.5e-3, 1e-2)
    )
    x = 0.3 * rng.uniform(-1.0, 1.0) * since / since[-1] + rng.uniform(-1.0, 1.0)
    x += np.cumsum(white(rng, x, 3e-4, 3e-4, np.sqrt(f / rate)))
    record.samples += size * (x + between(rng, 5e-4, 1e-2) * np.sin(TURN * 50.0 * since))
    return record


def speckle(rng: Generator) -> Record:
    """A laser vibrometer whose signal drops out or jumps for some samples, up to 60 times."""
    f, a_cycle = rng.uniform(100.0, 3000.0), between(rng, 10.0, 60.0)
    record, since, size = let_go(
        rng, f, between(rng, 1e-8, 1e-5), f * a_cycle, (150.0, 800.0), "velocity",
        noise=(1e-3, 1e-2),
    )  # fmt: skip
    record.samples += plain(6.3 * f, 2e-3, since, 0.1 * size, 0.0)
    for at in rng.integers(0, since.size - 50, int(between(rng, 3.0, 60.0))):
        part = slice(at, at + int(rng.integers(1, max(2, int(0.15 * a_cycle)))))
        jump = rng.uniform(-1.0, 1.0) * size if rng.random() < 0.5 else -record.samples[part]
        record.samples[part] += jump
    return record


def shaker_off(rng: Generator) -> Record:
    """Driven at resonance until the amplifier is cut, which then leaks up to 0.2 %."""
    f, start, phase = rng.uniform(30.0, 600.0), between(rng, 1e-6, 1e-4), rng.uniform(0.0, TURN)
    rate, order = f * between(rng, 12.0, 60.0), int(rng.integers(1, 3))
    record, since, size = let_go(
        rng, f, start, rate, (150.0, 600.0), list(ORDER)[order], (0.1, 0.4), phase=phase
    )
    turn = TURN * record.truth(np.array(start))[0]
    steady = start * turn**order * np.cos(turn * since + phase + 0.5 * np.pi * order)
    record.samples += np.where(since < 0.0, steady, 0.0)
    record.samples += rng.uniform(0.0, 2e-3) * size * np.sin(turn * since)
    record.samples += plain(4.1 * f, 5e-3, since, rng.uniform(0.01, 0.1) * size, 0.0)
    return record


def _beside(rng: Generator, f: float, loss: float, folds: tuple, other: Callable) -> Record:
    """A plain decay of 1 mm/s over so many e-folds, and what rings beside it."""
    rate = f * rng.uniform(12.0, 60.0)
    since = np.arange(int(rng.uniform(*folds) / (np.pi * loss) * rate / f)) / rate
    x = plain(f, loss, since, 1e-3, rng.uniform(0.0, TURN))
    x += 1e-3 * other(since, rng.uniform(0.0, TURN)) + white(rng, x, 1e-3, 1e-3, 1e-3)
    return Record(x, rate, "velocity", f, lambda a: (f + 0.0 * a, loss + 0.0 * a))


def doublet(rng: Generator) -> Record:
    """Two plain exponentials that die alike and beat 0.15 to 3 times while ln A falls by one."""
    f, loss, size = between(rng, 80.0, 2e3), between(rng, 3e-4, 3e-3), between(rng, 0.05, 0.4)
    near = f * (1.0 + rng.choice([-1.0, 1.0]) * np.pi * loss * between(rng, 0.15, 3.0))
    return _beside(
        rng, f, loss, (3.0, 8.0), lambda t, phase: plain(near, loss * f / near, t, size, phase)
    )


def steady_line(rng: Generator) -> Record:
    """A plain exponential beside a steady line of 0.3 to 1 %, one to ten half-widths away."""
    f, loss, size = between(rng, 30.0, 300.0), between(rng, 3e-3, 1e-2), between(rng, 3e-3, 1e-2)
    line = f * (1.0 + 0.5 * loss * rng.choice([-1.0, 1.0]) * between(rng, 1.0, 10.0))
    return _beside(
        rng, f, loss, (1.5, 7.0), lambda t, phase: size * np.cos(TURN * line * t + phase)
    )


KINDS = (
    sliders, clamped_beam, stop, dry_slide, ship_roll, internal_resonance, bolted_beam,
    tuning_fork, windy_tower, video, charge_amplifier, strain_gauge, speckle,
    shaker_off, doublet, steady_line,
)  # fmt: skip
CLASSES = ("right", "told", "silent", "none")


def scored(rng: Generator, kind: Callable[[Generator], Record]) -> tuple[str, float, tuple]:
    """Class of a drawn record, the part of its points that is right, and the findings."""
    record = kind(rng)
    read = record.mode_Hz * (1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.01, 0.03))
    named = () if rng.random() < 0.3 else record.others
    others = [f * rng.uniform(0.995, 1.005) for f in named if f < record.rate / 2.2]
    found = br.ringdown(
        record.samples / IN_SI[record.unit], read, sampling_Hz=record.rate,
        quantity=record.quantity, unit=record.unit, other_modes_Hz=others,
    )  # fmt: skip
    curve = found.curves
    if not curve.sizes["point"]:
        return "none", np.nan, (found.verdict,)
    at = curve["amplitude"].values
    if record.over_time:
        at = curve["time"].values + found.free_decay.attrs["start_s"]
    ok = np.ones(at.size, dtype=bool)
    for name, true, least in zip(
        ("frequency", "loss_factor"), record.truth(at), (1e-6 * WRONG_PPM, WRONG_LOSS), strict=True
    ):
        miss = np.abs(curve[name].values - true)
        ok &= (miss <= least * np.abs(true)) | (miss <= 3.0 * curve[f"{name}_std"].values)
    told = tuple(one for one in found.findings if "is the unit right" not in one)
    part = float(np.mean(ok))
    return "right" if part >= 0.95 else "told" if told else "silent", part, told


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    names = [kind.__name__ for kind in KINDS]
    parser.add_argument("--seed", type=int, help="repeat a run; drawn afresh if not given")
    parser.add_argument("--count", type=int, default=30, help="records of each kind, below 1000")
    parser.add_argument("--kinds", nargs="+", choices=names, default=names, metavar="KIND")
    parser.add_argument("--each", action="store_true", help="a line for each record")
    options = parser.parse_args()
    np.seterr(divide="ignore", invalid="ignore")
    seed = secrets.randbits(32) if options.seed is None else options.seed
    total = Counter()
    print(f"seed {seed}, {options.count} records of each kind")
    for number, kind in enumerate(KINDS):
        if kind.__name__ not in options.kinds:
            continue
        count = Counter()
        for k in range(options.count):
            what, part, told = scored(np.random.default_rng([seed, 1000 * number + k]), kind)
            count[what] += 1
            if options.each:
                print(f"  {kind.__name__} {k} {what} {part:.2f} {'; '.join(told)}")
        total += count
        print(f"{kind.__name__:20s}" + "".join(f" {one} {count[one]:3d}" for one in CLASSES))
    print(f"{'all':20s}" + "".join(f" {one} {total[one]:3d}" for one in CLASSES))


if __name__ == "__main__":
    main()
