"""Free decays whose amplitude-dependent frequency and damping are known exactly.

Independent of the estimator: nothing of `bladeroot` is imported. The displacement is
y = Re[A exp(i phi)] with d ln A/dt = alpha(A) and d phi/dt = omega(A) given in closed form, so
that the velocity is Re[(alpha + i omega) A exp(i phi)] and the truth of (3.11) follows from the
chain rule, d/dt = alpha d/d ln A:

    omega_n^2 = omega^2 - A''/A = omega^2 - alpha^2 - alpha d alpha/d ln A
    eta = -(2 omega alpha + alpha d omega/d ln A) / omega_n^2

Below the onset alpha and omega are constant (the stick plateau). Amplitudes are relative to the
start of the decay unless they are named in metres.

A record has 102,400 samples at 25.6 kHz of a mode within 2 % of 250 Hz. The onset lies at 0.05 to
0.6 of the start, the plateau's loss factor is 0.001 to 0.004. Above the onset the frequency falls
by 0.2 to 2 % at the start, from a kink (straight in A, or harmonic balance of a Coulomb slider) or
gradually (a power of 1.5 to 2), and slip adds up to 0.3 to 5 times the plateau's loss factor. Each
decay reaches 0.02 of its start and 0.4 of its onset within the record. A second mode starts at up
to 30 % of the velocity, at 1.5 to 7 times the frequency, in a third of the records within 0.5 % of
twice or three times. White noise of 80, 60, 40 and 30 dB: its rms below the starting rms of the
mode's velocity. All draws are log-uniform or uniform; the same decays serve all noise levels.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

SAMPLING_HZ = 25600.0
COUNT = 102400
EXPECTED_HZ = 250.0  # what the estimators are told; the truth lies within 2 % of it
LOWEST, HIGHEST = 0.02, 0.95  # amplitudes over which curves are scored


@dataclass(frozen=True)
class Law:
    """Backbone and damping: a plateau below `onset`, slip above it.

    `kind` is "kink" (softening straight in A from the onset), "coulomb" (harmonic balance of a
    Coulomb slider, 3.19) or "gradual" (softening and damping as a power of the excess).
    `softening` is the relative loss of frequency at the start, `hump` the largest loss factor of
    slip.
    """

    frequency_Hz: float
    loss_factor: float
    softening: float
    onset: float
    kind: str
    power: float
    hump: float
    hump_at: float

    def slip(self, x: np.ndarray) -> tuple[np.ndarray, ...]:
        """Shapes of softening and slip damping, and their derivatives by ln A."""
        r = np.maximum(np.asarray(x, float) / self.onset, 1.0)
        inside = np.asarray(x) > self.onset
        if self.kind == "gradual":
            top = 1.0 / self.onset - 1.0
            e = np.maximum(r - 1.0, 1e-300)
            soft, soft_r = (e / top) ** self.power, self.power * (e / top) ** self.power / e
            s = e / (self.hump_at * top)
            damp = (s * np.exp(1.0 - s)) ** self.power
            damp_r = damp * self.power * (1.0 / e - 1.0 / (self.hump_at * top))
        else:
            damp, damp_r = 4.0 * (1.0 - 1.0 / r) / r, 4.0 * (2.0 / r - 1.0) / r**2
            if self.kind == "kink":
                top = 1.0 / self.onset - 1.0
                soft, soft_r = (r - 1.0) / top, np.full_like(r, 1.0 / top)
            else:
                top = _lost_stiffness(1.0 / self.onset)[0]
                soft, soft_r = (value / top for value in _lost_stiffness(r))
        return tuple(np.where(inside, value, 0.0) for value in (soft, damp, r * soft_r, r * damp_r))

    def rates(self, x: np.ndarray) -> tuple[np.ndarray, ...]:
        """alpha, omega in 1/s at relative amplitudes, and their derivatives by ln A."""
        soft, damp, soft_l, damp_l = self.slip(x)
        omega_0 = 2.0 * np.pi * self.frequency_Hz
        alpha = -0.5 * omega_0 * (self.loss_factor + self.hump * damp)
        omega = omega_0 * (1.0 - self.softening * soft)
        return alpha, omega, -0.5 * omega_0 * self.hump * damp_l, -omega_0 * self.softening * soft_l

    def truth(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """f_n in Hz and loss factor by (3.11) at relative amplitudes."""
        alpha, omega, alpha_l, omega_l = self.rates(x)
        square = omega**2 - alpha**2 - alpha * alpha_l
        return np.sqrt(square) / (2.0 * np.pi), -(2.0 * omega * alpha + alpha * omega_l) / square

    @property
    def stick(self) -> tuple[float, float]:
        """f_n in Hz and loss factor on the plateau."""
        frequency, loss = self.truth(np.array(0.5 * self.onset))
        return float(frequency), float(loss)


@dataclass(frozen=True)
class Motion:
    """ln A and phase of a decay that starts at amplitude 1, as functions of time."""

    law: Law
    log_amplitude: CubicHermiteSpline
    phase: CubicHermiteSpline
    onset_s: float

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """ln A and phase (zero at the start); exact on the plateau."""
        alpha, omega, *_ = self.law.rates(np.array(0.5 * self.law.onset))
        late = np.maximum(time - self.onset_s, 0.0)
        early = np.minimum(time, self.onset_s)
        return self.log_amplitude(early) + alpha * late, self.phase(early) + omega * late

    def time_of(self, x: np.ndarray) -> np.ndarray:
        """When the relative amplitude is x."""
        alpha = float(self.law.rates(np.array(0.5 * self.law.onset))[0])
        grid = np.linspace(0.0, self.onset_s, 20001)
        above = np.interp(-np.log(x), -self.log_amplitude(grid), grid)
        below = self.onset_s + (np.log(x) - np.log(self.law.onset)) / alpha
        return np.where(x > self.law.onset, above, below)


@dataclass(frozen=True)
class Case:
    """One record, and all that is true of it (`start_m`: displacement amplitude at time 0)."""

    velocity: np.ndarray
    noise: float
    start_m: float
    law: Law
    motion: Motion
    second_ratio: float
    second_share: float


def move(law: Law, cells: int = 4000) -> Motion:
    """Integrate dt = d ln A/alpha and d phi = omega dt from amplitude 1 to the onset.

    Gauss-Legendre in each cell of ln A, so the kink lies on an edge; between the edges cubic
    Hermite in time.
    """
    # cells crowd towards the onset, where a power law has its least smooth point
    share = np.linspace(1.0, 0.0, cells + 1) ** 2
    edge = np.log(law.onset) * (1.0 - share)
    node, weight = np.polynomial.legendre.leggauss(8)
    half = 0.5 * np.diff(edge)[:, None]
    alpha, omega, *_ = law.rates(np.exp(edge[:-1, None] + half * (1.0 + node)))
    time = np.concatenate([[0.0], np.cumsum((half * weight / alpha).sum(axis=1))])
    phase = np.concatenate([[0.0], np.cumsum((half * weight * omega / alpha).sum(axis=1))])
    alpha, omega, *_ = law.rates(np.exp(edge))
    return Motion(
        law, CubicHermiteSpline(time, edge, alpha), CubicHermiteSpline(time, phase, omega), time[-1]
    )


def draw_law(rng: np.random.Generator, duration_s: float = COUNT / SAMPLING_HZ) -> Law:
    """A law whose decay uses the record: it ends below 0.02 of the start and 0.4 of the onset."""
    while True:
        kind = str(rng.choice(["kink", "coulomb", "gradual", "gradual"]))
        loss = np.exp(rng.uniform(np.log(1e-3), np.log(4e-3)))
        law = Law(
            frequency_Hz=EXPECTED_HZ * rng.uniform(0.98, 1.02),
            loss_factor=loss,
            softening=np.exp(rng.uniform(np.log(0.002), np.log(0.02))),
            onset=np.exp(rng.uniform(np.log(0.05), np.log(0.6))),
            kind=kind,
            power=rng.uniform(1.5, 2.0),
            hump=loss * np.exp(rng.uniform(np.log(0.3), np.log(5.0))),
            hump_at=rng.uniform(0.4, 1.5),
        )
        if move(law, 200).at(np.array(duration_s))[0] < np.log(min(LOWEST, 0.4 * law.onset)):
            return law


def draw(
    law_seed: np.random.SeedSequence,
    noise_seed: np.random.SeedSequence,
    noise_db: float,
    count: int = COUNT,
) -> Case:
    """A record at 25.6 kHz; the same `law_seed` gives the same decay for any noise.

    White noise with an rms `noise_db` below the starting rms (amplitude over sqrt 2) of the
    mode's velocity. The second mode has up to 30 % of the mode's starting velocity amplitude;
    its frequency is 1.5 to 7 times the mode's, in a third of the records within 0.5 % of twice
    or three times.
    """
    rng = np.random.default_rng(law_seed)
    law = draw_law(rng, count / SAMPLING_HZ)
    motion = move(law)
    time = np.arange(count) / SAMPLING_HZ
    level, phase = motion.at(time)
    alpha, omega, *_ = law.rates(np.exp(level))
    rate = alpha + 1j * omega
    speed = 0.5 * np.exp(rng.uniform(np.log(1e-2), 0.0))  # m/s at the start
    start_m = speed / abs(rate[0])
    velocity = start_m * (rate * np.exp(level + 1j * (phase + rng.uniform(0, 2 * np.pi)))).real
    harmonic = rng.integers(2, 4) * rng.uniform(0.995, 1.005)
    ratio = harmonic if rng.uniform() < 1 / 3 else rng.uniform(1.5, 7.0)
    share = rng.uniform(0.0, 0.3)
    other = 2.0 * np.pi * law.frequency_Hz * ratio
    loss = np.exp(rng.uniform(np.log(1e-3), np.log(6e-3)))
    turn = other * time + rng.uniform(0, 2 * np.pi)
    velocity += share * speed * np.exp(-0.5 * loss * other * time) * np.cos(turn)
    noise = speed / np.sqrt(2.0) * 10.0 ** (-noise_db / 20.0)
    velocity += noise * np.random.default_rng(noise_seed).standard_normal(count)
    return Case(velocity, noise, start_m, law, motion, ratio, share)


def _lost_stiffness(r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """1 - k_eq/k_t of (3.19) at r = A/A_cr above 1, and its derivative by r."""
    theta = np.arccos(1.0 - 2.0 / r)
    return (
        1.0 - (theta - 0.5 * np.sin(2.0 * theta)) / np.pi,
        4.0 * np.sin(theta) / (np.pi * r**2),
    )
