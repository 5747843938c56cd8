"""Free motion of a mode by its own law, exact between pushes: z = A exp(i phi).

dA/dt = -alpha(A) A and dphi/dt = omega(A) have the solution t = integral of du / alpha and
phi = integral of omega du / alpha over u = ln A, which is tabulated once and inverted.
"""

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from .laws import Law

HIGHEST, LOWEST = 1.0, -30.0  # ln x; no motion is larger, and the end is no amplitude
STEP = 0.004  # of ln x; Hermite's error at it is below 1e-10 of a radian a panel
GAUSS = np.polynomial.legendre.leggauss(5)


class Flow:
    """Tables of time and phase over ln A, from the highest amplitude down."""

    def __init__(self, law: Law):
        grid = np.linspace(HIGHEST, LOWEST, round((HIGHEST - LOWEST) / STEP) + 1)
        inside = [u for u in np.log(law.kinks or (1.0,)) if LOWEST < u < HIGHEST]
        self.law = law
        self.log = np.unique(np.concatenate([grid, inside]))[::-1] + np.log(law.scale)
        half = -0.5 * np.diff(self.log)[:, None]
        node = self.log[:-1, None] - half * (GAUSS[0] + 1.0)
        omega, alpha = law.rates(np.exp(node))
        times = (half * GAUSS[1] / alpha).sum(axis=1)
        turns = (half * GAUSS[1] * omega / alpha).sum(axis=1)
        self.time = np.concatenate([[0.0], np.cumsum(times)])
        phase = np.concatenate([[0.0], np.cumsum(turns)])
        omega, alpha = law.rates(np.exp(self.log))
        self.log_at = CubicHermiteSpline(self.time, self.log, -alpha)
        self.phase_at = CubicHermiteSpline(self.time, phase, omega)
        self.time_at = CubicHermiteSpline(self.log[::-1], self.time[::-1], -1.0 / alpha[::-1])

    def free(self, z0: complex, elapsed):
        """Complex amplitude so long after it was z0; elapsed in s, any shape."""
        start = float(self.time_at(np.log(abs(z0))))
        clock = np.minimum(start + np.asarray(elapsed), self.time[-1])
        phase = self.phase_at(clock) - self.phase_at(start) + np.angle(z0)
        return np.exp(self.log_at(clock) + 1j * phase)


def motion(law: Law, z, harmonics=()):
    """Displacement, velocity and acceleration of z, exact derivatives by the law.

    harmonics: pairs (n, c), a part c (A/scale)^(n-1) A cos(n phi) beside the fundamental.
    """
    amplitude = np.maximum(np.abs(z), law.scale * np.exp(LOWEST))
    omega, alpha = law.rates(amplitude)
    d_omega, d_alpha = law.slopes(amplitude)
    rate, bend = -alpha + 1j * omega, -alpha * (-d_alpha + 1j * d_omega)
    found = [z.real, (rate * z).real, ((rate**2 + bend) * z).real]
    for n, part in harmonics:
        wave = part * law.scale * (z / law.scale) ** n
        terms = (wave, n * rate * wave, (n**2 * rate**2 + n * bend) * wave)
        found = [sum_ + term.real for sum_, term in zip(found, terms, strict=True)]
    return found


def state(law: Law, displacement: float, velocity: float) -> complex:
    """The z that has this displacement and velocity; the rates depend on |z|."""
    z = complex(displacement, -velocity / law.omega)
    for _ in range(60):
        omega, alpha = law.rates(max(abs(z), law.scale * np.exp(LOWEST)))
        z = complex(displacement, float(-(alpha * displacement + velocity) / omega))
    return z
