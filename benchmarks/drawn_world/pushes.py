"""What sets a mode in motion: blows, a shaker that lets go, a released load, all in closed form.

A push is a sum of exponentials c exp(i w s) over its duration. While it acts, a mode answers with
its rates at the amplitude where it then is; before and after it follows its law.
"""

from dataclasses import dataclass, replace

import numpy as np

from .flow import Flow, motion, state


@dataclass(frozen=True)
class Push:
    """Force per modal mass at `start` s, for `duration` s."""

    start: float
    duration: float
    terms: tuple[tuple[complex, float], ...]  # c, w: the force is the sum of c exp(i w s), real

    def force(self, since):
        inside = (since >= 0) & (since < self.duration)
        return inside * sum((c * np.exp(1j * w * since)).real for c, w in self.terms)

    def answer(self, omega, alpha, since):
        """Displacement, velocity, acceleration from rest, for 0 <= since <= duration."""
        rate = -alpha + 1j * omega
        integral = sum(
            c * (np.exp(1j * w * since) - np.exp(rate * since)) / (1j * w - rate)
            for c, w in self.real_terms()
        )
        found = [(factor * integral).imag / omega for factor in (1.0, rate, rate**2)]
        return found[0], found[1], found[2] + self.force(since)

    def real_terms(self):
        """The same with conjugates, so that the sum itself is real."""
        for c, w in self.terms:
            yield 0.5 * c, w
            yield 0.5 * np.conj(c), -w

    def times(self, factor):
        return replace(self, terms=tuple((factor * c, w) for c, w in self.terms))


def half_sine(start, duration):
    return Push(start, duration, ((-1j, np.pi / duration),))


def haversine(start, duration):
    return Push(start, duration, ((0.5, 0.0), (-0.5, 2.0 * np.pi / duration)))


def fading_drive(start, duration, force: complex, drive):
    """A drive Re(force exp(i drive s)) that goes to nothing by half a cosine."""
    turn = np.pi / duration
    half = 0.5 * force
    return Push(
        start, duration, ((half, drive), (0.5 * half, drive + turn), (0.5 * half, drive - turn))
    )


@dataclass(frozen=True)
class Before:
    """Motion before the first push: rest, a held load, or a drive: Re(level exp(i drive s))."""

    until: float
    level: complex = 0.0
    drive: float = 0.0

    def motion(self, times):
        wave = self.level * np.exp(1j * self.drive * (times - self.until))
        return [(factor * wave).real for factor in (1.0, 1j * self.drive, -(self.drive**2))]


def response(flow: Flow, before: Before, pushes, times, harmonics=()):
    """Displacement, velocity and acceleration at `times` (s, rising), and where it is free last.

    Returns:
        an array (3, times) and the complex amplitude after the last push.
    """
    law = flow.law
    out = np.zeros((3, times.size))
    first = times < before.until
    out[:, first] = before.motion(times[first])
    q, v, _ = (float(part) for part in before.motion(np.array(before.until)))
    z, now = state(law, q, v) if before.level else 0j, before.until
    for push in (*sorted(pushes, key=lambda one: one.start), None):
        until = push.start if push else np.inf
        part = (times >= now) & (times < until)
        if z:
            out[:, part] = motion(law, flow.free(z, times[part] - now), harmonics)
        if push is None:
            break
        if z:
            z = complex(flow.free(z, until - now))
        omega, alpha = law.rates(abs(z) or law.scale)
        now = push.start + push.duration
        part = (times >= until) & (times < now)
        out[:, part] = push.answer(omega, alpha, times[part] - until)
        q, v, _ = push.answer(omega, alpha, push.duration)
        if z:
            out[:, part] += motion(law, flow.free(z, times[part] - until), harmonics)
            q0, v0, _ = motion(law, flow.free(z, push.duration))
            q, v = q + float(q0), v + float(v0)
        z = state(law, float(q), float(v))
    return out, z
