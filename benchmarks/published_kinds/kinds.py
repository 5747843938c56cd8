"""The kinds: what is measured, how, and what a record of it is."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy import ndarray
from numpy.random import Generator
from scipy.signal import lfilter

from published_kinds.motion import (
    ORDER,
    TURN,
    Law,
    Record,
    Terms,
    demodulated,
    followed_sliders,
    plain,
    solver,
    truth_of,
    turns,
)  # fmt: skip


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
        return followed_sliders(start, own, zeta, each, reach, 1.0 / rate, within, count)

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


def floating_body(rng: Generator) -> Record:
    """A moored body with drag, held and let go, in m off another place than that of its rest."""
    f, start, loss = 1.0 / rng.uniform(5.0, 35.0), rng.uniform(2.0, 6.0), rng.uniform(0.04, 0.12)
    viscous, rise, rate = rng.uniform(0.3, 0.8), rng.uniform(-0.02, 0.02), f * between(rng, 15, 250)
    flow = Law(
        lambda a: f * (1.0 + rise * (a / start) ** 2),
        lambda a: loss * (viscous + (1.0 - viscous) * a / start),
        start,
    )
    since = np.arange(int(rng.uniform(12.0, 20.0) * rate / f)) / rate - rng.uniform(0.0, 2.0) / f
    x = flow.motion(since, start, 0.0, "displacement") + np.where(since < 0.0, start, 0.0)
    x += white(rng, x, 5e-4, 5e-3, start) + rng.uniform(-2.0, 2.0)
    return Record(x, rate, "displacement", f, flow.truth)


def interpolated_video(rng: Generator) -> Record:
    """Three to eight frames a cycle, from which lines are drawn to many more samples."""
    f, start, finer = rng.uniform(1.0, 50.0), between(rng, 1e-4, 1e-2), int(rng.integers(4, 21))
    frames_Hz = f * rng.uniform(3.3, 8.0)
    record, since, _ = let_go(
        rng, f, start, frames_Hz, (80.0, 400.0), "displacement", (0.0, 0.0), (5e-4, 5e-3)
    )
    many = since[0] + np.arange((since.size - 1) * finer) / (finer * frames_Hz)
    gain = np.sinc(f / frames_Hz) ** 2  # of lines through samples, for a wave
    return replace(
        record,
        samples=np.interp(many, since, record.samples),
        rate=finer * frames_Hz,
        truth=lambda a: record.truth(a / gain),
    )


KINDS = (
    sliders, clamped_beam, stop, dry_slide, ship_roll, internal_resonance, bolted_beam,
    tuning_fork, windy_tower, video, charge_amplifier, strain_gauge, speckle,
    shaker_off, doublet, steady_line, floating_body, interpolated_video,
)  # fmt: skip
