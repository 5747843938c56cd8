"""Specimens: modes with their laws, shapes at hammer and sensors, and how they are excited."""

from dataclasses import dataclass, replace

import numpy as np

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


def drive_near(rng, modes: list[Mode], gains: list[float]):
    """A drive near the resonance of a low mode: its frequency (rad/s) and the steady levels."""
    target = modes[int(rng.integers(min(3, sum(m.structural for m in modes))))].law
    omega, alpha = target.rates(1.0)
    drive = float(omega + 0.3 * rng.normal() * alpha)
    rates = [m.law.rates(1.0) for m in modes]
    levels = [
        complex(gain / (omega**2 + alpha**2 - drive**2 + 2j * alpha * drive))
        for gain, (omega, alpha) in zip(gains, rates, strict=True)
    ]
    return drive, levels


def sized(push: Push, modes: list[Mode], gains: list[float], velocity: float) -> Push:
    """The push that gives the mode which it moves fastest this velocity."""
    found = [
        m.law.omega * amplitude_after(m.law, push.times(g))
        for m, g in zip(modes, gains, strict=True)
    ]
    return push.times(velocity / max(found))


def excite(rng, modes: list[Mode], start: float, late: float) -> tuple[list[Mode], Excitation]:
    """Modes with their laws scaled to the motion, and what moves them.

    Args:
        modes: with laws of unit scale.
        start: time of the blow or release, s.
        late: time at which the specimen is touched again, or infinity.
    """
    kind = str(rng.choice(["hammer", "shaker", "step"], p=[0.65, 0.2, 0.15]))
    gains, common, drive = [m.at_force for m in modes], [], 0.0
    levels = [0j] * len(modes)
    if kind == "hammer":
        common = [blow(rng, modes, start)]
        sizes = [amplitude_after(m.law, common[0].times(m.at_force)) for m in modes]
    elif kind == "step":
        levels = [complex(m.at_force / m.law.rates(1.0)[0] ** 2) for m in modes]
        sizes = [abs(level) for level in levels]
    else:
        drive, levels = drive_near(rng, modes, gains)
        sizes = [abs(level) for level in levels]
    loudest = max(s * m.law.omega for s, m in zip(sizes, modes, strict=True) if m.structural)
    for k, mode in enumerate(modes):
        if not mode.structural:
            share = mode.at_force * loudest / (sizes[k] * mode.law.omega)
            gains[k], levels[k] = gains[k] * share, levels[k] * share
    fade = 0.0
    if kind == "hammer" and rng.random() < 0.2:
        kind, again = "double hit", start + common[0].duration + log_uniform(rng, 0.004, 0.06)
        common.append(replace(common[0], start=again).times(log_uniform(rng, 0.05, 0.7)))
    elif kind == "shaker":
        fade = 2.0 * np.pi / drive * log_uniform(rng, 0.2, 8.0)
        knock = half_sine(start + fade, 0.4 * np.pi / drive)
        common.append(sized(knock, modes, gains, loudest * log_uniform(rng, 1e-4, 0.03)))
    free = max([p.start + p.duration for p in common] + [start])
    if np.isfinite(late):
        touch = blow(rng, modes, late)
        common.append(sized(touch, modes, gains, loudest * log_uniform(rng, 1e-4, 0.02)))
    # x = 1 is the most that all pushes together can give: no law is asked beyond it
    most = [
        abs(level) + sum(amplitude_after(m.law, push.times(g)) for push in common)
        for m, g, level in zip(modes, gains, levels, strict=True)
    ]
    factor = drawn_velocity(rng, modes, most)
    turn = np.exp(1j * rng.uniform(0.0, 2.0 * np.pi)) if kind == "shaker" else 1.0
    pushes = [[push.times(factor * g) for push in common] for g in gains]
    if kind == "shaker":
        for own, g in zip(pushes, gains, strict=True):
            own.append(fading_drive(start, fade, factor * g * turn, drive))
    before = [Before(start, factor * level * turn, drive) for level in levels]
    laws = [replace(m.law, scale=factor * size) for m, size in zip(modes, most, strict=True)]
    modes = [replace(m, law=law) for m, law in zip(modes, laws, strict=True)]
    return modes, Excitation(kind, before, pushes, start, free, late)
