"""Harmonics of what else rings, beside the mode: locked in phase to their line, and so told apart.

A sensor or a joint that is not linear makes of a mode z a small g z^2 / |z0| and g z^3 / |z0|^2.
Where such a line lies within some per cent of the mode asked for, no spectrum of a decay shows
both, but its phase is known. Against it the mode turns, and from one interval to a later one, over
which the mode is multiplied by rho,

    y' = rho y + g (h' - rho h),    y = mode + g h,

so rho and g follow from a linear regression in each of some windows (`locked_harmonic`). The
windows need to agree only roughly, as where modes in resonance drive one another.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray
from numpy.lib.stride_tricks import sliding_window_view

from bladeroot.decay.envelope_model import ENVELOPE_BANDWIDTH, HIDDEN_ABOVE, Beside, Envelopes
from bladeroot.signal.phasors import FrameGrid, fit_frames

HARMONIC_ORDERS = (2, 3)  # multiples of a line's frequency that are looked for
# What a harmonic may do to the mode that is not found because the record is too short for it.
RESOLVED_TURNS = 6.0  # of its phase against the mode's; with more, the record tells the two apart
ASSUMED_HARMONIC = 0.005  # its amplitude over the line's, where the line is loudest
# The same where a joint makes the harmonic and so forces the mode, which answers to it the more the
# nearer it is: times 2 (f - f_mode) / f_mode. On records of a bolted double beam 1e-4 to 5e-4.
FORCED_HARMONIC = 5e-4
NOTABLE_HARMONIC = 0.003  # of the mode's amplitude: a smaller one is left out of the errors
TAKEN_OFF = (
    "a harmonic, {} x {:.5g} Hz, rings beside the mode, up to {:.3g} % of it; taken off, and the "
    "curve ends where it hides the mode"
)
VEILED = (
    "a harmonic, {} x {:.5g} Hz, may ring within the mode's own line, up to {:.2g} % of it; this "
    "record cannot tell, and the errors hold it"
)
# The regressions. Lengths are counted in turns of the mode's phase against the harmonic's.
STEP_TURNS = 1.0 / 6.0  # from an interval to the later one that it is regressed on
WINDOW_TURNS = 0.7  # length of a window
PASSES = 3  # rounds of regressions; each takes over the exponent that the one before found
# The mode's own laws (frequency and damping over amplitude) also change rho within a window: the
# error of a window for that, over the mode's amplitude. It is estimated from how much neighbouring
# windows differ.
LAW_ERROR_RANGE = (0.002, 0.05)  # least and most of it; most is as on records of a beam
FEWEST_LOUD_WINDOWS = 3  # in which the mode is louder than the harmonic; with fewer, most is taken
# When a harmonic counts as found.
WINDOW_ERRORS = 3.0  # standard errors above which a window's harmonic is used
HARMONIC_ERRORS = 8.0  # standard errors of all used windows together, at least
MOST_PHASE_SCATTER = 0.5  # rad, rms over the used windows
# The harmonic over the line's power goes with that power to an exponent. Friction's harmonic is
# there only while the joint slips, and does not.
EXPONENT_RANGE = (-1.0, 0.5)
MOST_MISSED = 0.2  # of the sum of (g / error)^2 over all windows: as much may be left unexplained


def clearest_harmonic(
    x: Float[ndarray, " sample"], found: Envelopes, sampling_Hz: float, within: float
) -> Beside | None:
    """The clearest harmonic of another line within that part of the mode's frequency beside it.

    x: the decay (m/s). found: the envelopes of all lines that are known, the mode's first; the
    harmonic is still part of the mode's envelope.
    """
    own_Hz, shortest = float(found.lines_Hz[0]), WINDOW_TURNS * sampling_Hz / found.samples
    near = [pair for pair in _pairs(found, within * own_Hz) if abs(pair[2] - own_Hz) > shortest]
    if not near:
        return None
    y = _mode(x, found, sampling_Hz)
    made = []
    for line, order, at_Hz in near:
        turns = abs(at_Hz - own_Hz) * found.spacing / sampling_Hz
        h, _ = _unit(found, line, order)
        law = locked_harmonic(y, h[: y.size], turns)
        made += [(law, line, order, at_Hz)] if law is not None else []
    if not made:
        return None
    law, line, order, at_Hz = max(made, key=lambda entry: entry[0].clear)
    time = np.arange(y.size) * found.spacing + 0.5 * (found.spacing - 1)
    now, carrier = np.arange(found.samples), 2j * np.pi * at_Hz / sampling_Hz
    slow = law.phasor * found.turn[: y.size, 0] * np.exp(-carrier * time)
    slow = np.interp(now, time, slow.real) + 1j * np.interp(now, time, slow.imag)
    wave = (slow * np.exp(carrier * now)).real
    part = float(np.max(np.abs(law.phasor) / np.maximum(np.abs(y), np.abs(law.phasor))))
    remark = TAKEN_OFF.format(order, found.lines_Hz[line], 100.0 * part)
    alike = own_Hz / (ENVELOPE_BANDWIDTH * abs(at_Hz - own_Hz))
    return Beside(at_Hz, wave, time / sampling_Hz, law.error, "harmonic", remark, alike)


def _mode(
    x: Float[ndarray, " sample"], found: Envelopes, sampling_Hz: float
) -> Complex[ndarray, " interval"]:
    """The mode's phasor, its harmonics of others included, against its carrier."""
    turn = 2.0 * np.pi * float(found.lines_Hz[0]) / sampling_Hz
    alone = x - found.waves(list(range(1, found.lines_Hz.size)))
    frames = FrameGrid(0, found.spacing, found.samples // found.spacing, turn)
    phasor = fit_frames(alone, sampling_Hz, 1.0, [frames]).phasor
    return phasor * found.turn[: frames.frames, 0].conj()


def veiled_harmonics(
    x: Float[ndarray, " sample"], found: Envelopes, sampling_Hz: float, known: list[Beside]
) -> list[Beside]:
    """Harmonics that the record is too short to tell from the mode, as errors without a wave.

    Arguments as of `clearest_harmonic`; known: what was found beside the mode.
    """
    own_Hz, apart = float(found.lines_Hz[0]), RESOLVED_TURNS * sampling_Hz / found.samples
    made = []
    for line, order, at_Hz in _pairs(found, apart):
        if any(abs(one.frequency_Hz - at_Hz) < apart for one in known):
            continue
        h, loudest = _unit(found, line, order)
        y = _mode(x, found, sampling_Hz)
        off_Hz = max(abs(at_Hz - own_Hz), sampling_Hz / (2.0 * np.pi * found.samples))
        forced = FORCED_HARMONIC * own_Hz / (2.0 * off_Hz) * loudest
        seen = possible(y, h[: y.size], off_Hz * found.spacing / sampling_Hz)
        error = max(ASSUMED_HARMONIC * loudest, min(forced, seen)) * np.abs(h)
        over = error / np.maximum(np.abs(found.envelope(0)), 1e-300)
        least = min(float(over.min()), HIDDEN_ABOVE)  # as much where it hides the mode all along
        part = float(over.max(where=over < HIDDEN_ABOVE, initial=least))
        if part > NOTABLE_HARMONIC:
            time = (np.arange(h.size) + 0.5) * found.spacing / sampling_Hz
            remark = VEILED.format(order, found.lines_Hz[line], 100.0 * part)
            nothing, alike = np.zeros(found.samples), own_Hz * found.samples / sampling_Hz
            made.append(Beside(at_Hz, nothing, time, error, "harmonic", remark, alike))
    return made


def _pairs(found: Envelopes, within_Hz: float) -> list[tuple[int, int, float]]:
    """Lines, orders and frequencies (Hz) of the harmonics within a distance of the mode's line."""
    return [
        (line, order, float(order * found.lines_Hz[line]))
        for line in range(1, found.lines_Hz.size)
        for order in HARMONIC_ORDERS
        if abs(order * found.lines_Hz[line] - found.lines_Hz[0]) < within_Hz
    ]


def _unit(found: Envelopes, line: int, order: int) -> tuple[Complex[ndarray, " interval"], float]:
    """A line to the harmonic's order against the mode's carrier, 1 at most; its largest (m/s)."""
    base = found.envelope(line) * found.turn[:, line]
    loudest = float(np.abs(base).max())
    return (base / loudest) ** order * found.turn[:, 0].conj(), loudest


@dataclass(frozen=True)
class Harmonic:
    """A harmonic against the mode's carrier, its error, and how clear it is (standard errors)."""

    phasor: Complex[ndarray, " interval"]
    error: Float[ndarray, " interval"]
    clear: float


def possible(
    y: Complex[ndarray, " interval"], h: Complex[ndarray, " interval"], turns: float
) -> float:
    """Amplitude (m/s) of a harmonic that all windows together leave possible.

    Arguments as of `locked_harmonic`. What they see on average and its standard error.
    """
    lag, length = _lengths(turns)
    if y.size < length + lag:
        return np.inf
    g, std, _ = _seen(y * np.exp(-1j * np.angle(h)), np.maximum(np.abs(h), 1e-12), lag, length)
    weight = std**-2.0
    return float(np.hypot(abs(weight @ g), np.sqrt(weight.sum())) / weight.sum())


def _lengths(turns: float) -> tuple[int, int]:
    """Intervals from one to the later one, and of a window, where the mode turns by so much."""
    lag, length = (max(int(part / turns), 1) for part in (STEP_TURNS, WINDOW_TURNS))
    return lag, max(length, 12)


def locked_harmonic(
    y: Complex[ndarray, " interval"], h: Complex[ndarray, " interval"], turns: float
) -> Harmonic | None:
    """A harmonic in the mode's phasor, None where none is clear.

    y: the mode with the harmonic; h: the line to the harmonic's order, 1 at the line's loudest,
    against the same carrier. turns: of the mode against the harmonic in an interval.
    """
    lag, length = _lengths(turns)
    size = np.maximum(np.abs(h), 1e-12)
    still = y * np.exp(-1j * np.angle(h))
    for _ in range(PASSES):  # within a window the harmonic goes as size
        law = _law(still, size, lag, length)
        if law is None:
            return None
        size = size ** (1.0 + law.slope)
    phasor = law.part * size * np.exp(1j * np.angle(h))
    # the law is less certain at sizes far from those of the windows that see the harmonic
    error = law.error * np.hypot(1.0, 0.5 * (np.log(size) - law.centre)) * np.abs(phasor)
    return Harmonic(phasor, error, law.clear)


@dataclass(frozen=True)
class _Law:
    """A harmonic is `part` times size^(1 + `slope`), where size is the line's power.

    `error` is relative. `centre` is ln of the harmonic's size where it is seen best. `clear`:
    standard errors of all windows together.
    """

    part: complex
    slope: float
    centre: float
    error: float
    clear: float


def _law(
    y: Complex[ndarray, " interval"], size: Float[ndarray, " interval"], lag: int, length: int
) -> _Law | None:
    """The law of all windows together; None where they see no harmonic clearly."""
    if y.size < length + lag:
        return None
    every = g, std, _ = _seen(y, size, lag, length)
    clear = np.abs(g) > WINDOW_ERRORS * std
    g, std, x = (values[clear] for values in every)
    weight = (np.abs(g) / std) ** 2
    if weight.sum() < HARMONIC_ERRORS**2:
        return None
    mean = np.sum(weight * g / np.abs(g))
    mean /= np.abs(mean)
    log = np.log(g / mean)
    if np.sqrt(np.average(log.imag**2, weights=weight)) > MOST_PHASE_SCATTER:
        return None
    # the added 1 draws the slope to zero where few windows see the harmonic
    centre, middle = np.average(x, weights=weight), np.average(log.real, weights=weight)
    slope = np.sum(weight * (x - centre) * log.real) / (np.sum(weight * (x - centre) ** 2) + 1.0)
    slope = float(np.clip(slope, *EXPONENT_RANGE))
    left = np.abs(log - middle - slope * (x - centre))
    error = float(np.sqrt(np.average(left**2, weights=weight) + 1.0 / weight.sum()))
    part = complex(mean * np.exp(middle - slope * centre))
    g, std, x = every
    missed = np.sum(np.abs((g - part * np.exp(slope * x)) / std) ** 2)
    if missed > MOST_MISSED * np.sum(np.abs(g / std) ** 2):
        return None
    clear = float(np.sqrt(weight.sum()))
    return _Law(part, slope, (1.0 + slope) * float(centre), error, clear)


def _seen(
    y: Complex[ndarray, " interval"], size: Float[ndarray, " interval"], lag: int, length: int
) -> tuple[Complex[ndarray, " window"], Float[ndarray, " window"], Float[ndarray, " window"]]:
    """Of windows that overlap by half: harmonic over size, its standard error, ln of the size."""
    apart = max(length // 2, 1)
    windows = (sliding_window_view(x, length + lag)[::apart] for x in (y, size))
    g, std, level, mode = _regressions(*windows, lag)
    return g, np.hypot(std, _laws(g, mode) * mode), np.log(level)


def _regressions(
    y: Complex[ndarray, "window interval"], h: Float[ndarray, "window interval"], lag: int
) -> tuple[
    Complex[ndarray, " window"],
    Float[ndarray, " window"],
    Float[ndarray, " window"],
    Float[ndarray, " window"],
]:
    """Of each window: harmonic over h, its standard error, mean of h, median of the mode over h."""
    before, later, falls = y[:, :-lag], y[:, lag:], np.mean(h[:, lag:] / h[:, :-lag], axis=1)
    weight = 1.0 / np.maximum(np.abs(before), 1e-300)
    design = np.stack([before, h[:, :-lag]], axis=2) * weight[..., None]
    wanted = (later * weight)[..., None]
    turned = design.conj().transpose(0, 2, 1)
    inverse = np.linalg.pinv(turned @ design)
    found = inverse @ (turned @ wanted)
    left = (wanted - design @ found)[..., 0]
    rho, kappa = found[:, 0, 0], found[:, 1, 0]
    variance = inverse[:, 1, 1].real * np.mean(np.abs(left) ** 2, axis=1) * lag
    g = kappa / (falls - rho)
    mode = np.median(np.abs(y - g[:, None] * h) / h, axis=1)
    return g, np.sqrt(variance) / np.abs(falls - rho), np.mean(h, axis=1), mode


def _laws(g: Complex[ndarray, " window"], mode: Float[ndarray, " window"]) -> float:
    """Error of a window for the mode's own laws, over the mode, from how far neighbours differ."""
    loud = mode[1:] > np.abs(g[1:])
    if np.count_nonzero(loud) < FEWEST_LOUD_WINDOWS:
        return LAW_ERROR_RANGE[1]
    return float(np.clip(np.median((np.abs(np.diff(g)) / mode[1:])[loud]), *LAW_ERROR_RANGE))
