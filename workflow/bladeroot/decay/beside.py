"""Harmonics of what else rings, beside the mode: locked in phase to their line, and so told apart.

A sensor or a joint that is not linear makes of a mode z a small g z^2 / |z0| and g z^3 / |z0|^2.
Where such a line lies within some per cent of the mode asked for, no spectrum of a decay shows
both, but its phase is known. Against it the mode turns, and from one interval to a later one,
over which the mode is multiplied by rho,

    y' = rho y + g (h' - rho h),    y = mode + g h,

so rho and g follow from a linear regression in each of some windows.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.decay.envelope_model import Envelopes

# What may be left of it is no more than this part of the mode, where a curve still goes.
HIDDEN = 0.3


@dataclass(frozen=True)
class Beside:
    """A wave in the samples, its error (m/s) at times (s) evenly spaced, and the finding's id."""

    frequency_Hz: float
    wave: Float[ndarray, " sample"]
    time: Float[ndarray, " interval"]
    error: Float[ndarray, " interval"]
    finding: str
    remark: str

    def over(self, mode: Complex[ndarray, " middle"], time: Float[ndarray, " middle"]) -> ndarray:
        """Its error over the mode, at times."""
        return np.interp(time, self.time, self.error) / np.maximum(np.abs(mode), 1e-300)

    def hides(self, found: Envelopes, sampling_Hz: float) -> int:
        """Samples until what is left of it may be more than `HIDDEN` of the mode."""
        mode = found.envelope(0)
        time = (np.arange(mode.size) + 0.5) * found.spacing / sampling_Hz
        hidden = np.flatnonzero(self.over(mode, time) > HIDDEN)
        return int(hidden[0]) * found.spacing if hidden.size else found.samples


ORDERS = (2, 3)
# Turns of the mode against the harmonic over the regression's step and over a window.
STEP, WINDOW = 1.0 / 6.0, 0.7
# Part of the mode by which a window may be wrong for the mode's own laws, least and (as on records
# of a beam, and where fewer windows than FEWEST tell) most.
LAWS, FEWEST = (0.002, 0.05), 3
PASSES = 3
# A window counts from so many standard errors on, and a harmonic where all of them make so many
# and agree in phase (rad, rms).
SEEN, CLEAR, IN_PHASE = 3.0, 8.0, 0.5
# A friction's harmonic is there while it slips: one law must leave no more than this part of what
# all windows see.
MISSED = 0.2
# Its part of the line falls with the line's power, or grows, by no more than these exponents.
EXPONENT = (-1.0, 0.5)


def harmonics(found: Envelopes, sampling_Hz: float, within: float) -> list[Beside]:
    """Clear harmonics of all other lines within that part of the mode's frequency beside it."""
    own_Hz, shortest = float(found.lines_Hz[0]), WINDOW * sampling_Hz / found.samples
    near = [
        (line, order)
        for line in range(1, found.lines_Hz.size)
        for order in ORDERS
        if shortest < abs(order * found.lines_Hz[line] - own_Hz) < within * own_Hz
    ]
    made = [harmonic(found, line, order, sampling_Hz) for line, order in near]
    return [one for one in made if one is not None]


def harmonic(found: Envelopes, line: int, order: int, sampling_Hz: float) -> Beside | None:
    """A line's harmonic beside the mode (the first line), None where none is clear.

    found: the envelopes of all lines that are known; the mode's holds the harmonic, too.
    """
    at_Hz = order * float(found.lines_Hz[line])
    apart = abs(at_Hz - float(found.lines_Hz[0]))
    step_s = found.spacing / sampling_Hz
    lag, length = (max(int(turns / (apart * step_s)), 1) for turns in (STEP, WINDOW))
    base = found.envelope(line) * found.turn[:, line]
    h = (base / np.abs(base).max()) ** order
    size = np.maximum(np.abs(h), 1e-12)
    y = found.envelope(0) * found.turn[:, 0] * np.exp(-1j * np.angle(h))
    for _ in range(PASSES):  # in a window it falls as the line's power does, to an exponent
        law = _law(y, size, lag, max(length, 12))
        if law is None:
            return None
        size = size ** (1.0 + law.slope)
    phasor = law.part * size * np.exp(1j * np.angle(h))
    time = np.arange(size.size) * found.spacing + 0.5 * (found.spacing - 1)
    now, carrier = np.arange(found.samples), 2j * np.pi * at_Hz / sampling_Hz
    slow = phasor * np.exp(-carrier * time)
    slow = np.interp(now, time, slow.real) + 1j * np.interp(now, time, slow.imag)
    wave = (slow * np.exp(carrier * now)).real
    # further from the windows that see it, its law is less sure
    error = law.error * np.hypot(1.0, 0.5 * (np.log(size) - law.centre)) * np.abs(phasor)
    part = float(np.max(np.abs(phasor) / np.maximum(np.abs(found.envelope(0)), np.abs(phasor))))
    remark = (
        f"a harmonic, {order} x {found.lines_Hz[line]:.5g} Hz, rings beside the mode, up to "
        f"{100.0 * part:.3g} % of it; taken off, and the curve ends where it hides the mode"
    )
    return Beside(at_Hz, wave, time / sampling_Hz, error, "harmonic", remark)


@dataclass(frozen=True)
class _Law:
    """A harmonic is `part` of a line's power, to an exponent larger by `slope`; relative error.

    `centre` is ln of the power where it is seen best.
    """

    part: complex
    slope: float
    centre: float
    error: float


def _law(
    y: Complex[ndarray, " interval"], size: Float[ndarray, " interval"], lag: int, length: int
) -> _Law | None:
    """What the windows say together; None where they see no harmonic clearly."""
    starts = range(0, y.size - length - lag + 1, max(length // 2, 1))
    windows = [_regression(*(x[a : a + length + lag] for x in (y, size)), lag) for a in starts]
    if not windows:
        return None
    g, std, level, mode = (np.array(column) for column in zip(*windows, strict=True))
    std = np.hypot(std, _laws(g, mode) * mode)
    every, clear = (g, std, np.log(level)), np.abs(g) > SEEN * std
    g, std, x = (values[clear] for values in every)
    weight = (np.abs(g) / std) ** 2
    if weight.sum() < CLEAR**2:
        return None
    mean = np.sum(weight * g / np.abs(g))
    mean /= np.abs(mean)
    log = np.log(g / mean)
    if np.sqrt(np.average(log.imag**2, weights=weight)) > IN_PHASE:
        return None
    # where few windows see it, it goes with the line's power as it is
    centre, middle = np.average(x, weights=weight), np.average(log.real, weights=weight)
    slope = np.sum(weight * (x - centre) * log.real) / (np.sum(weight * (x - centre) ** 2) + 1.0)
    slope = float(np.clip(slope, *EXPONENT))
    left = np.abs(log - middle - slope * (x - centre))
    error = float(np.sqrt(np.average(left**2, weights=weight) + 1.0 / weight.sum()))
    part = complex(mean * np.exp(middle - slope * centre))
    g, std, x = every
    missed = np.sum(np.abs((g - part * np.exp(slope * x)) / std) ** 2)
    if missed > MISSED * np.sum(np.abs(g / std) ** 2):
        return None
    return _Law(part, slope, (1.0 + slope) * float(centre), error)


def _regression(
    y: Complex[ndarray, " interval"], h: Float[ndarray, " interval"], lag: int
) -> tuple[complex, float, float, float]:
    """The harmonic's part in a window, its standard error, mean level of line and mode."""
    before, after = slice(0, y.size - lag), slice(lag, y.size)
    falls = float(np.mean(h[after] / h[before]))
    weight = 1.0 / np.maximum(np.abs(y[before]), 1e-300)
    design = np.stack([y[before], h[before]], axis=1) * weight[:, None]
    wanted = y[after] * weight
    inverse = np.linalg.pinv(design.conj().T @ design)
    rho, kappa = found = inverse @ (design.conj().T @ wanted)
    left = wanted - design @ found
    variance = float(inverse[1, 1].real) * np.mean(np.abs(left) ** 2) * lag
    g = kappa / (falls - rho)
    mode = np.median(np.abs(y - g * h) / h)
    std = np.sqrt(variance) / abs(falls - rho)
    return complex(g), float(std), float(np.mean(h)), float(mode)


def _laws(g: Complex[ndarray, " window"], mode: Float[ndarray, " window"]) -> float:
    """Part of the mode by which windows err for its laws: they turn, and so windows differ."""
    loud = mode[1:] > np.abs(g[1:])
    if np.count_nonzero(loud) < FEWEST:
        return LAWS[1]
    return float(np.clip(np.median((np.abs(np.diff(g)) / mode[1:])[loud]), *LAWS))
