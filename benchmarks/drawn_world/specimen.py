"""Specimens: modes with their laws, shapes at hammer and sensors, and how they are excited."""

from dataclasses import dataclass, replace

import numpy as np

from .flow import Flow
from .laws import Law, draw_law, linear, log_uniform
from .pushes import Before, Push, fading_drive, half_sine, haversine

HIGHEST_HZ = 2000.0
# Velocity of a suspension mode over that of the loudest structural one.
SUSPENSION = 1e-3, 0.2
NONLINEAR = {"coulomb", "sliders", "iwan", "hardening", "both", "dry"}  # laws with harmonics


@dataclass(frozen=True)
class Mode:
    """One mode of the specimen, or of its suspension."""

    law: Law
    structural: bool
    at_sensors: np.ndarray  # shape at each sensor
    at_force: float  # shape where it is pushed; of a suspension, its velocity over the loudest
    harmonics: tuple[tuple[int, float], ...] = ()


@dataclass(frozen=True)
class Excitation:
    """`before` and `pushes` hold one entry per mode; all motion is free from `free_s` on."""

    kind: str
    before: list[Before]
    pushes: list[list[Push]]
    release_s: float
    free_s: float
    late_s: float = np.inf  # something touches the specimen


def draw_frequencies(rng) -> tuple[list[float], set[str]]:
    """3 to 6 structural frequencies (Hz), rising, and what is special about their ratios."""
    found, features = [log_uniform(rng, 5.0, 800.0)], set()
    for _ in range(int(rng.integers(2, 6))):
        kind = rng.choice(["wide", "2:1", "3:1", "close"], p=[0.68, 0.1, 0.1, 0.12])
        ratio = {
            "wide": rng.uniform(1.25, 4.0),
            "2:1": 2.0 * (1.0 + rng.uniform(-0.04, 0.04)),
            "3:1": 3.0 * (1.0 + rng.uniform(-0.04, 0.04)),
            "close": 1.0 + log_uniform(rng, 0.03, 0.15),
        }[kind]
        if len(found) >= 3 and found[-1] * ratio > HIGHEST_HZ:
            break
        found.append(found[-1] * ratio)
        if kind != "wide":
            features.add(str(kind))
    return found, features


def draw_modes(rng, sensors: int) -> tuple[list[Mode], set[str]]:
    """Structural modes, then suspension modes, of laws with unit scale."""
    frequencies, features = draw_frequencies(rng)
    modes = []
    for frequency in frequencies:
        law = draw_law(rng, frequency)
        shape = rng.choice([-1.0, 1.0], sensors) * rng.uniform(0.15, 1.0, sensors)
        if sensors > 1 and rng.random() < 0.15:
            shape[rng.integers(sensors)] *= log_uniform(rng, 0.003, 0.1)
            features.add("node")
        push = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 1.0))
        parts = ()
        if law.name in NONLINEAR and rng.random() < 0.6:
            parts = ((2, log_uniform(rng, 1e-5, 3e-3)), (3, log_uniform(rng, 1e-5, 0.01)))
            features.add("harmonics")
        modes.append(Mode(law, True, shape, push, parts))
    for _ in range(int(rng.integers(0, 4))):
        law = draw_law(rng, frequencies[0] * log_uniform(rng, 0.03, 0.3))
        shape, _ = linear(rng, log_uniform(rng, 5e-4, 0.02))
        law = replace(law, name="suspension", shape=shape, kinks=())
        at = rng.uniform(-1.0, 1.0, sensors)
        modes.append(Mode(law, False, at, log_uniform(rng, *SUSPENSION)))
        features.add("suspension")
    return modes, features


def blow(rng, modes: list[Mode], start: float) -> Push:
    """A hammer's pulse, as short as one of the first modes needs or longer."""
    reference = modes[int(rng.integers(min(3, len(modes))))].law.omega / (2.0 * np.pi)
    shape = half_sine if rng.random() < 0.5 else haversine
    return shape(start, log_uniform(rng, 0.15, 1.0) / reference)


def amplitude_after(law: Law, push: Push) -> float:
    """Amplitude that a push leaves, with the rates of x = 1."""
    omega, alpha = (float(part) for part in law.rates(law.scale))
    q, v, _ = push.answer(omega, alpha, push.duration)
    return float(np.hypot(q, (v + alpha * q) / omega))


def drawn_velocity(rng, modes: list[Mode], sizes: list[float]) -> float:
    """Factor by which the motion reaches a drawn velocity without absurd deflections."""
    velocity = max(
        m.law.omega * a * np.max(np.abs(m.at_sensors)) for m, a in zip(modes, sizes, strict=True)
    )
    deflection = max(a * np.max(np.abs(m.at_sensors)) for m, a in zip(modes, sizes, strict=True))
    return min(log_uniform(rng, 1e-3, 3.0) / velocity, 0.02 / deflection)


def excite(rng, modes: list[Mode], start: float, late: float) -> tuple[list[Mode], Excitation]:
    """Modes with their laws scaled to the motion, and what moves them.

    Args:
        start: time of the blow or release, s.
        late: time at which the specimen is touched again, or infinity.
    """
    kind = str(rng.choice(["hammer", "shaker", "step"], p=[0.65, 0.2, 0.15]))
    rates = [tuple(float(r) for r in m.law.rates(1.0)) for m in modes]
    gains = [m.at_force for m in modes]
    before, common = [Before(start)] * len(modes), []
    pushes: list[list[Push]] = [[] for _ in modes]
    if kind == "hammer":
        common = [blow(rng, modes, start)]
        sizes = [
            amplitude_after(m.law, common[0].times(g)) for m, g in zip(modes, gains, strict=True)
        ]
    elif kind == "step":
        sizes = [abs(g) / omega**2 for g, (omega, _) in zip(gains, rates, strict=True)]
    else:
        target = int(rng.integers(min(3, len(modes))))
        drive = rates[target][0] * (1.0 + rng.normal() * 0.3 * rates[target][1] / rates[target][0])
        levels = [
            g / (omega**2 + alpha**2 - drive**2 + 2j * alpha * drive)
            for g, (omega, alpha) in zip(gains, rates, strict=True)
        ]
        sizes = [abs(level) for level in levels]
    loudest = max(s * o for s, (o, _), m in zip(sizes, rates, modes, strict=True) if m.structural)
    for k, mode in enumerate(modes):
        if not mode.structural:
            share = mode.at_force * loudest / (sizes[k] * rates[k][0])
            gains[k], sizes[k] = gains[k] * share, sizes[k] * share
    if kind == "shaker":
        levels = [
            level * gain / m.at_force for level, gain, m in zip(levels, gains, modes, strict=True)
        ]
    factor = drawn_velocity(rng, modes, sizes)
    sizes = [max(factor * size, 1e-15) for size in sizes]
    modes = [replace(m, law=replace(m.law, scale=s)) for m, s in zip(modes, sizes, strict=True)]
    if kind == "hammer":
        common = [common[0].times(factor)]
        if rng.random() < 0.2:
            again = start + common[0].duration + log_uniform(rng, 0.004, 0.06)
            common.append(replace(common[0], start=again).times(log_uniform(rng, 0.05, 0.7)))
            kind = "double hit"
    elif kind == "step":
        before = [Before(start, factor * g / o**2) for g, (o, _) in zip(gains, rates, strict=True)]
    else:
        phase = np.exp(1j * rng.uniform(0.0, 2.0 * np.pi))
        before = [Before(start, factor * level * phase, drive) for level in levels]
        fade = 2.0 * np.pi / drive * log_uniform(rng, 0.2, 8.0)
        for own, gain in zip(pushes, gains, strict=True):
            own.append(fading_drive(start, fade, factor * gain * phase, drive))
        loudest = max(s * o for s, (o, _) in zip(sizes, rates, strict=True))
        knock = half_sine(start + fade, 0.2 * 2.0 * np.pi / drive)
        size = max(amplitude_after(m.law, knock.times(m.at_force)) * m.law.omega for m in modes)
        common = [knock.times(log_uniform(rng, 1e-4, 0.03) * loudest / size)]
    free = max([p.start + p.duration for p in common] + [start])
    if np.isfinite(late):
        loudest = max(s * o for s, (o, _) in zip(sizes, rates, strict=True))
        touch = blow(rng, modes, late)
        size = max(amplitude_after(m.law, touch.times(m.at_force)) * m.law.omega for m in modes)
        common.append(touch.times(log_uniform(rng, 1e-4, 0.02) * loudest / size))
    for own, gain in zip(pushes, gains, strict=True):
        own.extend(push.times(gain) for push in common)
    return modes, Excitation(kind, before, pushes, start, free, late)


def flows(modes: list[Mode]) -> list[Flow]:
    return [Flow(mode.law) for mode in modes]
