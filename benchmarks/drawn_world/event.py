"""One motion of one specimen, seen by one to four sensors: the files and the truth."""

from dataclasses import dataclass, field, replace

import numpy as np

from . import friction
from .flow import Flow
from .laws import Law, linear, log_uniform
from .pushes import response
from .sensors import OVERSAMPLING, TAPS, Chain, draw_chain, filtered, gain, measured
from .specimen import Excitation, Mode, draw_modes, excite

MOST_SAMPLES = 120_000
DIRECT_SHARE = 0.2
HIGHER = 6.0  # a backbone starts at so many times the amplitude of the record
DIRECT_CYCLES = 6_000  # of the highest mode, at most, in an event that is integrated in time
ASKED_MODES = 3  # a campaign asks for so many modes at most
LEAST_RATE = 6.0  # samples in a cycle of a mode that is asked for
# What somebody would ask of a record: a mode that stands out of the noise for some time.
LEAST_SNR, LEAST_SHARE, LEAST_CYCLES, LOST = 10.0, 0.003, 50, 2.0
ORDER = {"displacement": 0, "velocity": 1, "acceleration": 2}


@dataclass
class Sensor:
    """A channel: `samples` in SI of its quantity; `noise` is the white noise's deviation."""

    chain: Chain
    samples: np.ndarray
    noise: float
    at_modes: np.ndarray  # displacement at the sensor, filters included, over modal displacement


@dataclass
class Event:
    """`truths[mode]` is the law in modal amplitude, None where there is none.

    `asked` holds pairs of mode and sensor.
    """

    seed: int
    sampling_Hz: float
    modes: list[Mode]
    truths: list[Law | None]
    excitation: Excitation
    sensors: list[Sensor]
    expected_Hz: dict[int, float]
    asked: list[tuple[int, int]]
    free: list[complex]  # complex amplitude of each mode when its motion becomes free
    features: set[str] = field(default_factory=set)

    def truth(self, mode: int, sensor: int, amplitude):
        """Undamped frequency (Hz) and loss factor at displacement amplitudes (m) of the sensor."""
        return self.truths[mode].truth(np.asarray(amplitude) / self.sensors[sensor].at_modes[mode])


def rounded(rng, rate: float) -> float:
    """A sampling frequency as devices have it, mostly."""
    if rng.random() < 0.25:
        return round(rate, 2)
    usual = np.array([a * 2.0**k for a in (100.0, 128.0, 75.0) for k in range(-2, 10)])
    return float(usual[np.argmin(np.abs(np.log(usual / rate)))])


def schedule(rng, modes: list[Mode], direct: bool):
    """Sampling frequency (Hz), samples, times of release and of a late touch (s)."""
    structural = [m for m in modes if m.structural]
    target = structural[int(rng.integers(min(3, len(structural))))].law
    rate = rounded(rng, target.omega / (2 * np.pi) * log_uniform(rng, 7.0, 60.0))
    within = [m for m in structural if rate >= LEAST_RATE * m.law.omega / (2 * np.pi)]
    reference = within[int(rng.integers(len(within)))].law if within else structural[0].law
    flow = Flow(reference)
    duration = float(flow.time_at(-rng.uniform(1.5, 11.0)) - flow.time_at(0.0))
    duration = float(np.clip(duration, 0.5, 60.0))
    if direct:
        highest = max(m.law.omega for m in structural) / (2 * np.pi)
        duration = min(duration, DIRECT_CYCLES / highest)
    count = int(min(duration * rate, MOST_SAMPLES))
    duration = count / rate
    if rng.random() < 0.6:
        release = duration * log_uniform(rng, 0.001, 0.1)
    else:
        release = -duration * log_uniform(rng, 3e-4, 0.03)
    late = np.inf
    if not direct and rng.random() < 0.06:
        late = max(release, 0.0) + (duration - max(release, 0.0)) * rng.uniform(0.5, 0.97)
    return rate, count, round(release * rate) / rate, late


def friction_for(rng, modes: list[Mode], main: int) -> friction.Friction:
    """An element on one mode that the others move by less than a per cent of what it does."""
    law = modes[main].law
    size = np.array([m.law.scale for m in modes])
    couple = rng.uniform(-0.005, 0.005, size.size) * np.minimum(1.0, law.scale / size)
    couple[main] = 1.0
    kind = "jenkins" if rng.random() < 0.6 else "bouc-wen"
    count = int(rng.integers(1, 13)) if kind == "jenkins" else 1
    low = log_uniform(rng, 0.02, 0.4)
    onset = np.sort(low * rng.uniform(1.0, 10.0, count)) if count > 1 else np.array([low])
    part = log_uniform(rng, 0.01, 0.12)
    stiffness = np.full(count, part / count) * law.omega**2
    limit = stiffness * onset * law.scale
    return friction.Friction(kind, stiffness, limit, float(rng.uniform(1.0, 2.0)), couple)


def integrated(modes, excitation, element, rate, count, release):
    """Motion of an event by direct integration, (3, modes, count) from its release on."""
    omega = np.array([m.law.omega for m in modes])
    zeta = np.array([float(m.law.shape(np.array(1.0))[1]) for m in modes])
    highest = omega.max() / (2 * np.pi)
    start = np.array([b.level.real if b.level else 0.0 for b in excitation.before])

    def force(since):
        return np.stack([
            sum((p.force(since + release - p.start) for p in own), np.zeros(since.size))
            for own in excitation.pushes
        ])  # fmt: skip

    forces = force, excitation.free_s - release
    out = friction.integrate(
        omega, zeta, element, start, np.zeros(omega.size), forces, rate, count, highest
    )
    return out, omega, zeta, highest


def backbones(modes, element, omega, zeta, highest, seconds):
    """The truth of each structural mode, from a clean decay of the same system."""
    found = []
    for k, mode in enumerate(modes):
        if not mode.structural:
            found.append(mode.law)
            continue
        near = omega[k] / (2 * np.pi)
        rate, start = 40.0 * near, np.zeros(omega.size)
        start[k] = HIGHER * mode.law.scale
        falls = (np.log(HIGHER) + 1.0) / (zeta[k] * omega[k])
        count = int((1.2 * seconds + falls + 80.0 / near) * rate)
        nothing = (None, 0.0)
        out = friction.integrate(
            omega, zeta, element, start, np.zeros(omega.size), nothing, rate, count, highest
        )
        stuck = omega[k] ** 2 + element.couple[k] ** 2 * element.stiffness.sum()
        middle = 0.5 * (near + np.sqrt(stuck) / (2 * np.pi))
        found.append(friction.backbone(1.0 / rate, out[0, k], middle, element.kind))
    return found


def draw(seed: int) -> Event:
    """The event of a seed; the same on every machine to the digits of its arithmetic."""
    rng = np.random.default_rng([seed, 20])
    direct = bool(rng.random() < DIRECT_SHARE)
    sensors = int(rng.integers(1, 5))
    modes, features = draw_modes(rng, sensors)
    rate, count, release, late = schedule(rng, modes, direct)
    if direct:
        modes = [straight(rng, mode) for mode in modes]
    modes, excitation = excite(rng, modes, release, late)
    while direct and excitation.kind == "shaker":
        unit = [replace(m, law=replace(m.law, scale=1.0)) for m in modes]
        modes, excitation = excite(rng, unit, release, late)
    # dense time from well before the first sample to well after the last
    lead = OVERSAMPLING * (TAPS + int(np.ceil(max(0.0, -release) * rate)))
    dense = (np.arange(OVERSAMPLING * (count + TAPS) + lead) - lead) / (OVERSAMPLING * rate)
    if direct:
        main = int(rng.integers(min(3, sum(m.structural for m in modes))))
        element = friction_for(rng, modes, main)
        features = (features - {"harmonics"}) | {"direct", element.kind}
        free = [0j] * len(modes)
        first = int(np.searchsorted(dense, release - 0.25 / (OVERSAMPLING * rate)))
        after = integrated(
            modes, excitation, element, OVERSAMPLING * rate, dense.size - first, release
        )
        truths = backbones(modes, element, *after[1:], count / rate + max(0.0, -release))
        motion = np.zeros((3, len(modes), dense.size))
        motion[0, :, :first] = np.array(
            [b.level.real if b.level else 0.0 for b in excitation.before]
        )[:, None]
        motion[:, :, first:] = after[0]
        loose = dense > max(excitation.free_s, 0.0)
        for k, law in enumerate(truths):
            if law is None or not modes[k].structural:
                continue
            step, near = dense[1] - dense[0], law.omega / (2 * np.pi)
            if not friction.agrees(law, step, motion[0, k, loose], near):
                truths[k] = None
    else:
        parts = [
            response(Flow(m.law), b, p, dense, m.harmonics)
            for m, b, p in zip(modes, excitation.before, excitation.pushes, strict=True)
        ]
        motion = np.stack([part for part, _ in parts], axis=1)
        free, truths = [z for _, z in parts], [m.law for m in modes]
    features |= {excitation.kind, "before" if release > 0 else "after"}
    if np.isfinite(late):
        features.add("late touch")
    first_Hz = modes[0].law.omega / (2 * np.pi)
    quantity = str(rng.choice(list(ORDER), p=[0.15, 0.45, 0.4]))
    seen, heights = [], []
    for s in range(sensors):
        chain = draw_chain(rng, quantity, first_Hz)
        at = np.array([abs(m.at_sensors[s]) for m in modes])
        dense_motion = sum(
            m.at_sensors[s] * x for m, x in zip(modes, motion[ORDER[quantity]], strict=True)
        )
        clean = filtered(chain, dense_motion, rate)[lead // OVERSAMPLING :][:count]
        samples, noise = measured(rng, chain, clean, rate, release)
        gains = np.array([gain(chain, m.law.omega / (2 * np.pi), rate) for m in modes])
        seen.append(Sensor(chain, samples, noise, at * gains))
        heights.append(float(np.max(np.abs(clean))))
    event = Event(seed, rate, modes, truths, excitation, seen, {}, [], free, features)
    ask(rng, event, motion, dense, heights)
    return event


def straight(rng, mode: Mode) -> Mode:
    """The same mode without a law of its own, for a system whose friction gives it one."""
    if not mode.structural:
        return mode
    zeta = float(mode.law.shape(np.array(1e-6))[1])
    shape, _ = linear(rng, min(zeta, 0.01))
    return replace(mode, law=replace(mode.law, name="linear", shape=shape, kinks=()), harmonics=())


def ask(rng, event: Event, motion, dense, heights) -> None:
    """Choose the campaign's modes and pairs: what stands out of a sensor's noise long enough."""
    rate, order = event.sampling_Hz, ORDER[event.sensors[0].chain.quantity]
    pairs = []
    begin = max(event.excitation.free_s, 0.0)
    for k, mode in enumerate(event.modes):
        near = mode.law.omega / (2 * np.pi)
        if not mode.structural or event.truths[k] is None or rate < LEAST_RATE * near:
            continue
        cycle = max(1, round(OVERSAMPLING * rate / near))
        inside = np.flatnonzero((dense >= begin) & (dense < event.sensors[0].samples.size / rate))
        whole = np.abs(motion[order, k, inside])
        tops = whole[: whole.size // cycle * cycle].reshape(-1, cycle).max(axis=1)
        for s, sensor in enumerate(event.sensors):
            noise = sensor.noise * np.sqrt(1.0 + sensor.chain.flicker_Hz / near)
            size = tops * sensor.at_modes[k]
            if size.size == 0 or size[0] < max(LEAST_SNR * noise, LEAST_SHARE * heights[s]):
                continue
            if np.count_nonzero(size > LOST * noise) >= LEAST_CYCLES:
                pairs.append((k, s))
    found = sorted({k for k, _ in pairs})
    chosen = sorted(rng.permutation(found)[:ASKED_MODES].tolist())
    event.asked = [(k, s) for k, s in pairs if k in chosen]
    for k in chosen:
        law = event.truths[k]
        middle = law.truth(np.array(0.3 * event.modes[k].law.scale))[0]
        event.expected_Hz[k] = round(float(middle) * (1.0 + rng.uniform(-0.02, 0.02)), 2)
