"""Harmonics of what else rings, beside the mode: locked in phase to their line, and so told apart.

A sensor or a joint that is not linear makes of a mode z a small g z^2 / |z0| and g z^3 / |z0|^2.
Where such a line lies within some per cent of the mode asked for, no spectrum of a decay shows
both, but its phase is known (`locked_harmonic`).
"""

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.decay.beside import HIDDEN_ABOVE, Beside
from bladeroot.decay.envelope_model import ENVELOPE_BANDWIDTH, Envelopes
from bladeroot.decay.locked_harmonic import WINDOW_TURNS, locked_harmonic
from bladeroot.signal.phasors import FrameGrid, fit_frames

HARMONIC_ORDERS = (2, 3)  # multiples of a line's frequency that are looked for
# What a harmonic may do to the mode that is not found because the record is too short for it.
RESOLVED_TURNS = 6.0  # of its phase against the mode's; with more, the record tells the two apart
ASSUMED_HARMONIC = 0.005  # its amplitude over the line's, where the line is loudest
NOTABLE_HARMONIC = 0.003  # of the mode's amplitude: a smaller one is left out of the errors
TAKEN_OFF = (
    "a harmonic, {} x {:.5g} Hz, rings beside the mode, up to {:.3g} % of it; taken off, and the "
    "curve ends where it hides the mode"
)
VEILED = (
    "a harmonic, {} x {:.5g} Hz, may ring within the mode's own line, up to {:.2g} % of it; this "
    "record cannot tell, and the errors hold it"
)


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
    turn = 2.0 * np.pi * own_Hz / sampling_Hz
    alone = x - found.waves(list(range(1, found.lines_Hz.size)))
    frames = FrameGrid(0, found.spacing, found.samples // found.spacing, turn)
    y = fit_frames(alone, sampling_Hz, 1.0, [frames]).phasor * found.turn[: frames.frames, 0].conj()
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


def veiled_harmonics(found: Envelopes, sampling_Hz: float, known: list[Beside]) -> list[Beside]:
    """Harmonics that the record is too short to tell from the mode, as errors without a wave.

    known: what was found beside the mode.
    """
    own_Hz, apart = float(found.lines_Hz[0]), RESOLVED_TURNS * sampling_Hz / found.samples
    made = []
    for line, order, at_Hz in _pairs(found, apart):
        if any(abs(one.frequency_Hz - at_Hz) < apart for one in known):
            continue
        h, loudest = _unit(found, line, order)
        error = ASSUMED_HARMONIC * loudest * np.abs(h)
        over = error / np.maximum(np.abs(found.envelope(0)), 1e-300)
        part = float(over.max(where=over < HIDDEN_ABOVE, initial=0.0))
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
