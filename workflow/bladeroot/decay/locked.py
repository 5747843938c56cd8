"""A harmonic in a mode's phasor as a constant part of its line: what makes the mode likeliest.

The phasor y holds a mode and a harmonic g h whose phase is known. A mode has smooth laws of its
own, so ln(y - g h) is smooth for the right g, and beats for others. Smooth is what third
differences say, as of Whittaker and Henderson: a doubly integrated random walk in noise, whose
strength the record's own likelihood tells. Where the mode is large its laws bend more: the walk
may fall with a power of it.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray
from scipy.linalg import cholesky_banded
from scipy.linalg.lapack import dtbtrs

from bladeroot.signal.runs import runs

# Frames in a turn of the mode against the harmonic, and turns that tell it from the mode's laws:
# over fewer its errors would be too small.
PER_TURN, ENOUGH = 16.0, 1.7
# The line is at least that part of the mode, which counts from so many standard errors of noise on,
# for so many frames at least.
LOUD, ALIVE, FEWEST = 0.1, 10.0, 10
# Variances of the random walk's third differences that are tried, over that of noise in the middle,
# and powers of the mode's own with which they fall.
STRENGTHS, FALLS = 10.0 ** np.arange(-6.0, 5.0, 1.5), (0.0, 1.0, 2.0)
# Into so many parts the decay is cut, one of which the first step takes; where the harmonic is less
# than that part of the mode the fit is at home.
WINDOWS, SMALL = (1, 2, 4), 0.6
# Steps of the fit; from which on they are halved and frames are left out but not taken in; and part
# of a standard error that the last one moves.
STEPS, SETTLES, STILL = 20, 5, 0.1
# What is known before: a harmonic is that part of its line, and goes with another power of it by no
# more than that exponent (standard deviations).
SIZE, EXPONENT = 0.1, 0.3
# A harmonic counts where the record is likelier with it by so many nats, it is known to this part
# of itself, and its exponent is no larger.
CLEAR, KNOWN, LARGEST = 14.0, 0.35, 0.7
TINY = 1e-300  # of what holds no noise at all


@dataclass(frozen=True)
class Locked:
    """A harmonic against the mode's carrier, its error, and nats by which it is likelier."""

    phasor: Complex[ndarray, " frame"]
    error: Float[ndarray, " frame"]
    gain: float


def locked(
    y: Complex[ndarray, " frame"], h: Complex[ndarray, " frame"], loudest: float, turns: float
) -> Locked | None:
    """A line's harmonic in the mode's phasor; None where none is clear.

    By Gauss-Newton steps, where the mode stands out of the noise and of the harmonic: first in the
    window that tells most of it, then wherever it is small beside the mode.

    Args:
        y: the mode with the harmonic, against the mode's carrier.
        h: the harmonic of unit size, against the same carrier.
        loudest: size of the line.
        turns: of the mode against the harmonic in a frame.
    """
    full, step = h, max(int(1.0 / (PER_TURN * turns)), 1)
    y, h = (one[: y.size // step * step].reshape(-1, step).mean(axis=1) for one in (y, h))
    end = _alive(y)
    if end < FEWEST or loudest < LOUD * np.abs(y).max():
        return None
    log = np.log(np.maximum(np.abs(h[:end]), 1e-12))
    centre = np.average(log, weights=np.abs(h[:end]) ** 2)
    model = _Harmonic(y[:end], h[:end], log - centre, SIZE * loudest)
    start = _best_window(model)
    fitted = None if start is None else _refined(model, *start, max(ENOUGH / turns / step, FEWEST))
    if fitted is None:
        return None
    unknown, covariance, gain = fitted
    known = float(np.sqrt(covariance[0, 0]) / max(np.hypot(*unknown[:2]), 1e-300))
    if gain < CLEAR or known > KNOWN or np.hypot(*unknown[2:]) > LARGEST:
        return None
    log = np.log(np.maximum(np.abs(full), 1e-12)) - centre
    phasor = complex(*unknown[:2]) * full * np.exp(complex(*unknown[2:]) * log)
    # far from where it is seen best, the exponent tells
    error = np.hypot(known, np.sqrt(covariance[2, 2] + covariance[3, 3]) * log) * np.abs(phasor)
    return Locked(phasor, error, gain)


def _alive(y: Complex[ndarray, " frame"]) -> int:
    """Frames until the mode is no longer clear of the noise."""
    third = np.abs(np.diff(y, 3))
    if third.size < 2:
        return 0
    # the middle of a complex normal's size; of white noise, third differences have 20 variances
    noise = float(np.median(third[third.size // 2 :])) / np.sqrt(2.0 * np.log(2.0) * 20.0)
    lost = np.flatnonzero(np.abs(y) <= ALIVE * noise)
    return int(lost[0]) if lost.size else y.size


def _best_window(model: "_Harmonic") -> tuple[Float[ndarray, "4"], slice] | None:
    """The unknowns after one step, and the window that gains most by it."""
    count, best = model.y.size, None
    for parts in WINDOWS:
        for k in range(parts if count >= FEWEST * parts else 0):
            here = slice(k * count // parts, (k + 1) * count // parts)
            unknown, _, gain = model.step(np.zeros(4), here, False)
            if model.small(unknown)[here].all() and (best is None or gain > best[0]):
                best = gain, unknown, here
    return None if best is None else best[1:]


def _refined(
    model: "_Harmonic", unknown: Float[ndarray, "4"], here: slice, fewest: float
) -> tuple[Float[ndarray, "4"], Float[ndarray, "4 4"], float] | None:
    """The unknowns over all frames about a window where the harmonic is small, unless they roam."""
    reach = np.ones(model.y.size, bool)
    for step in range(STEPS):
        small = model.small(unknown)
        reach = reach & small if step > SETTLES else small
        spans = runs(reach)
        shared = np.minimum(spans[:, 1], here.stop) - np.maximum(spans[:, 0], here.start)
        if not shared.size or np.ptp(spans[np.argmax(shared)]) < fewest:
            return None
        here = slice(*map(int, spans[np.argmax(shared)]))
        made, covariance, gain = model.step(unknown, here, True)
        moved, unknown = made - unknown, 0.5 * (unknown + made) if step > SETTLES else made
        if (np.abs(moved) < STILL * np.sqrt(np.diag(covariance))).all():
            return unknown, covariance, gain
    return None


@dataclass(frozen=True)
class _Harmonic:
    """A mode's phasor y with a harmonic g h exp(s log); the unknowns are the parts of g and of s.

    size: standard deviation of either part of g before the record.
    """

    y: Complex[ndarray, " frame"]
    h: Complex[ndarray, " frame"]
    log: Float[ndarray, " frame"]
    size: float

    def phasor(self, unknown: Float[ndarray, "4"]) -> Complex[ndarray, " frame"]:
        """The harmonic."""
        return complex(*unknown[:2]) * self.h * np.exp(complex(*unknown[2:]) * self.log)

    def small(self, unknown: Float[ndarray, "4"]) -> Bool[ndarray, " frame"]:
        """The frames where it is a small part of the mode."""
        phasor = self.phasor(unknown)
        return np.abs(phasor) < SMALL * np.abs(self.y - phasor)

    def step(
        self, unknown: Float[ndarray, "4"], here: slice, power: bool
    ) -> tuple[Float[ndarray, "4"], Float[ndarray, "k k"], float]:
        """The unknowns after a step (s with `power`), their covariance, and nats over no harmonic.

        Of all random walks the one that is likeliest after the step. Without `power` the phasor is
        taken over its course, not its logarithm: then g is found from far off, but less well.
        """
        phasor = self.phasor(unknown)
        z = (self.y - phasor)[here]
        y, wave = self.y[here], (self.h * np.exp(complex(*unknown[2:]) * self.log))[here]
        if power:
            turned = phasor[here] / z * self.log[here]
            columns = [_log(y), _log(z), wave / z, 1j * wave / z, turned, 1j * turned]
        else:
            course = _course(y)
            columns = [y / course, z / course, wave / course, 1j * wave / course]
        variance = np.abs(y) ** -2.0
        band = _of_differences(variance / np.median(variance))
        right = np.diff(np.stack([part(one) for part in (np.real, np.imag) for one in columns]), 3)
        nothing = best = -np.inf
        prior = np.array([self.size, self.size, EXPONENT, EXPONENT])[: len(columns) - 2] ** -2.0
        loud = np.abs(y[1:-2] * y[2:-1])
        falls = FALLS if power else FALLS[:1]  # over a window the mode is hardly another one
        walks = [(loud / np.median(loud)) ** fall * one for fall in falls for one in STRENGTHS]
        for walk in walks:
            own = band.copy()
            own[0] += walk
            factor = cholesky_banded(own, lower=True)
            white = np.concatenate(np.split(dtbtrs(factor, right.T, uplo="L")[0], 2, axis=1))
            bare, left, design = white[:, 0], white[:, 1], white[:, 2:]
            count, log_det = left.size, 2.0 * np.log(factor[0]).sum()
            nothing = max(nothing, -log_det - 0.5 * count * np.log(max(bare @ bare, TINY)))
            noise = max(left @ left / count, TINY)
            for _ in range(2):  # the noise that is left
                fisher = design.T @ design / noise + np.diag(prior)
                slope = design.T @ left / noise - prior * unknown[: prior.size]
                move = np.linalg.solve(fisher, slope)
                noise = max(np.mean((left - design @ move) ** 2), TINY)
            likelihood = -log_det - 0.5 * count * np.log(noise * count)
            likelihood -= 0.5 * prior @ (unknown[: prior.size] + move) ** 2
            if likelihood > best:
                best, found = likelihood, (move, np.linalg.inv(fisher))
        made = unknown.copy()
        made[: move.size] += found[0]
        made[2:] = np.clip(made[2:], -1.0, 1.0)
        return made, found[1], best - nothing


def _log(z: Complex[ndarray, " frame"]) -> Complex[ndarray, " frame"]:
    return np.log(np.abs(z)) + 1j * np.unwrap(np.angle(z))


def _course(z: Complex[ndarray, " frame"]) -> Complex[ndarray, " frame"]:
    """A phasor's course on the whole."""
    bent = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, z.size), 2)
    return np.exp(bent @ np.linalg.lstsq(bent, _log(z), rcond=None)[0])


def _of_differences(variance: Float[ndarray, " frame"]) -> Float[ndarray, "4 third"]:
    """Covariance of the third differences of white noise, as a lower band."""
    weight, count = (-1.0, 3.0, -3.0, 1.0), variance.size - 3
    band = np.zeros((4, count))
    for lag in range(4):
        for k in range(lag, 4):
            product = weight[k] * weight[k - lag] * variance[k : k + count]
            band[lag, : count - lag] += product[: count - lag]
    return band
