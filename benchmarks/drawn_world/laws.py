"""Laws of frequency and damping over amplitude, by many kinds of physics, and their truth.

A law says how fast a mode turns and decays, dA/dt = -zeta omega A and dphi/dt = omega. What an
estimator should find from it, the undamped natural frequency and the hysteretic loss factor of
x = A cos phi, follows in closed form (`Law.truth`). Laws are functions of x = A / scale, the
modal amplitude over that at the start.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

# Step in ln A of the central differences: rounding and truncation both below 1e-9 of the value.
LOG_STEP = 1e-5

Shape = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Law:
    """`shape(x)` returns the relative change of frequency and the damping ratio."""

    name: str
    omega: float  # rad/s, where the change of frequency is none
    scale: float  # modal amplitude of x = 1
    shape: Shape
    kinks: tuple[float, ...] = ()  # x at which the slope jumps

    def rates(self, amplitude):
        """Angular frequency and decay rate zeta omega (both rad/s)."""
        change, zeta = self.shape(np.asarray(amplitude) / self.scale)
        omega = self.omega * (1.0 + change)
        return omega, zeta * omega

    def slopes(self, amplitude):
        """Derivatives of both by ln A."""
        up = self.rates(amplitude * np.exp(LOG_STEP))
        down = self.rates(amplitude * np.exp(-LOG_STEP))
        return tuple((u - d) / (2.0 * LOG_STEP) for u, d in zip(up, down, strict=True))

    def truth(self, amplitude):
        """Undamped natural frequency (Hz) and hysteretic loss factor (3.11).

        omega_n^2 = omega^2 - A''/A and eta = -(2 omega A'/A + omega') / omega_n^2, where
        A' = -alpha A and d/dt = -alpha d/dlnA.
        """
        omega, alpha = self.rates(amplitude)
        d_omega, d_alpha = self.slopes(amplitude)
        squared = omega**2 - alpha**2 - alpha * d_alpha
        return np.sqrt(squared) / (2.0 * np.pi), alpha * (2.0 * omega + d_omega) / squared


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def jenkins(x, onset):
    """Lost share of a slider's stiffness and its loss factor over its stiffness (3.19)."""
    over = np.maximum(x / onset, 1.0)
    angle = np.arccos(1.0 - 2.0 / over)
    lost = 1.0 - (angle - 0.5 * np.sin(2.0 * angle)) / np.pi
    return lost, 4.0 / np.pi * (over - 1.0) / over**2


def coulomb(rng, zeta):
    onset, part = log_uniform(rng, 0.02, 0.6), log_uniform(rng, 0.004, 0.12)

    def shape(x):
        lost, loss = jenkins(x, onset)
        return np.sqrt(1.0 - part * lost) - 1.0, zeta + 0.5 * part * loss

    return shape, (onset,)


def sliders(rng, zeta):
    """Thresholds spread between two amplitudes with a density that is a power of the threshold."""
    low = log_uniform(rng, 0.01, 0.2)
    high, power = low * log_uniform(rng, 3.0, 100.0), rng.uniform(-0.8, 0.8)
    part = log_uniform(rng, 0.01, 0.15)
    node, weight = np.polynomial.legendre.leggauss(40)
    onset = low * (high / low) ** (0.5 * (node + 1.0))
    weight = weight * onset**power
    weight /= weight.sum()

    def shape(x):
        lost, loss = 0.0, 0.0
        for one, share in zip(onset, weight, strict=True):
            a, b = jenkins(x, one)
            lost, loss = lost + share * a, loss + share * b
        return np.sqrt(1.0 - part * lost) - 1.0, zeta + 0.5 * part * loss

    return shape, ()


def iwan(rng, zeta):
    """Four parameters: powers of the amplitude in microslip, then towards macroslip."""
    chi, part = rng.uniform(-0.9, -0.1), log_uniform(rng, 0.005, 0.08)
    macro, dissipated = log_uniform(rng, 1.0, 10.0), rng.uniform(0.2, 0.6)

    def shape(x):
        lost = (x / (x + macro)) ** (chi + 1.0)
        return np.sqrt(1.0 - part * lost) - 1.0, zeta + dissipated * part * lost / (1 + x / macro)

    return shape, ()


def power(rng, zeta):
    soft, rise = log_uniform(rng, 0.001, 0.04), log_uniform(rng, 0.2, 5.0)
    p, q = rng.uniform(0.4, 2.0), rng.uniform(0.4, 2.0)
    return lambda x: (-soft * x**p, zeta * (1.0 + rise * x**q)), ()


def hardening(rng, zeta):
    hard, rise = log_uniform(rng, 0.0005, 0.02), log_uniform(rng, 0.05, 1.0)
    return lambda x: (hard * x**2, zeta * (1.0 + rise * x)), ()


def saturating(rng, zeta):
    soft, rise = log_uniform(rng, 0.002, 0.04), log_uniform(rng, 0.2, 4.0)
    knee, p = log_uniform(rng, 0.05, 0.6), rng.uniform(1.0, 3.0)

    def shape(x):
        y = (x / knee) ** p
        return -soft * y / (1.0 + y), zeta * (1.0 + rise * y / (1.0 + y))

    return shape, ()


def hump(rng, zeta):
    """Damping with a maximum where the frequency steps down, as of a single relaxation."""
    soft, peak = log_uniform(rng, 0.002, 0.03), log_uniform(rng, 0.3, 4.0)
    knee, p = log_uniform(rng, 0.05, 0.5), rng.uniform(0.7, 1.6)

    def shape(x):
        y = (x / knee) ** p
        return -soft * y**2 / (1.0 + y**2), zeta * (1.0 + peak * 2.0 * y / (1.0 + y**2))

    return shape, ()


def drag(rng, zeta):
    """Air: quadratic drag, a damping ratio that rises linearly, next to no softening."""
    rise, soft = log_uniform(rng, 0.2, 6.0), log_uniform(rng, 1e-5, 1e-3)
    return lambda x: (-soft * x**2, zeta * (1.0 + rise * x)), ()


def falling(rng, zeta):
    """Damping that falls with the amplitude while the frequency softens."""
    extra, knee = log_uniform(rng, 0.2, 1.5), log_uniform(rng, 0.05, 1.0)
    soft = log_uniform(rng, 0.001, 0.03)
    return lambda x: (-soft * x / (knee + x), zeta * (1.0 + extra / (1.0 + x / knee))), ()


def dry(rng, zeta):
    """A sliding pivot: a constant force, whose damping ratio goes as one over the amplitude."""
    extra, knee = log_uniform(rng, 0.02, 0.2), log_uniform(rng, 0.03, 0.2)
    soft = log_uniform(rng, 1e-4, 5e-3)
    return lambda x: (-soft * x, zeta * (1.0 + extra / (x + knee))), ()


def both(rng, zeta):
    """A joint softens, then large deflections stiffen."""
    soft, hard = log_uniform(rng, 0.002, 0.03), log_uniform(rng, 0.001, 0.02)
    knee, rise = log_uniform(rng, 0.03, 0.4), log_uniform(rng, 0.2, 3.0)
    return lambda x: (-soft * x / (knee + x) + hard * x**2, zeta * (1.0 + rise * x)), ()


def logarithm(rng, zeta):
    soft, rise = log_uniform(rng, 0.002, 0.03), log_uniform(rng, 0.2, 3.0)
    knee = log_uniform(rng, 0.003, 0.1)

    def shape(x):
        grown = np.log1p(x / knee) / np.log1p(1.0 / knee)
        return -soft * grown, zeta * (1.0 + rise * grown)

    return shape, ()


def linear(rng, zeta):
    return lambda x: (0.0 * x, zeta + 0.0 * x), ()


POOL = (
    coulomb, sliders, iwan, power, hardening, saturating, hump, drag, falling, dry, both,
    logarithm, linear,
)  # fmt: skip


def draw_law(rng, frequency_Hz) -> Law:
    """A law of unit scale; the damping at small amplitude is 0.0003 to 0.012, seldom more."""
    kind = POOL[rng.integers(len(POOL))]
    zeta = log_uniform(rng, 3e-4, 0.012) if rng.random() < 0.9 else log_uniform(rng, 0.012, 0.025)
    shape, kinks = kind(rng, zeta)
    return Law(kind.__name__, 2.0 * np.pi * frequency_Hz, 1.0, shape, kinks)
