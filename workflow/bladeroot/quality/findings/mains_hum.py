"""Hum of the mains: steady lines at multiples of 50 or 60 Hz."""

from dataclasses import replace

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.quality.examined import Examined, Finding
from bladeroot.signal.lines import TERMS

STATISTIC = (
    "largest steady line at a multiple of 50 or 60 Hz (to the 7th, or to twice the mode), in "
    "standard errors"
)
THRESHOLD = 8.0
MAINS_HZ = (50.0, 60.0)
# Orders that are looked for at least, and at most, where those to twice the mode are more.
ORDERS = (7, 60)
# The mains' frequency keeps within this (relative).
WANDER = 0.0015
# Lines on each side from which the background is taken.
REACH = 6
# Each half of the decay must hold so many periods of 50 Hz, or lines cannot be told apart.
FEWEST = 6
# Smooth backgrounds over these lines: constant, straight and bent.
_AWAY = np.linalg.qr(np.vander(np.arange(-REACH, REACH + 1.0) / REACH, 3, increasing=True))[0]
# The two halves show the same line if they differ by less than this part of it or so many errors.
UNEVEN, UNEVEN_ERRORS = 0.12, 4.0
# No line is told from the mode within so many lines and this part of its frequency.
LINES_AWAY, PART_AWAY = 7.0, 0.01
# Frequencies tried for a line: so many in a line's width, from the least to the most of them. One
# that ends outside of the mains' wander by this part of a line is another's.
A_LINE, LEAST, MOST, BESIDE = 8.0, 5, 81, 0.1


def find(seen: Examined) -> Finding | None:
    """Steady lines in the decay, or in what was taken off it with all else that rings."""
    found = steady_lines(seen)
    if seen.mixed is None or (found is not None and found.counts):
        return found
    gone = steady_lines(seen.mixed)
    return replace(gone, excess=None) if gone is not None and gone.counts else found


def steady_lines(seen: Examined) -> Finding | None:
    """Lines that both halves of the decay show alike; they are fitted and taken off.

    Around each multiple a line and a smooth background are fitted to the spectra of both halves.
    A line that decays, or one of the mode's own, differs between the halves.
    """
    if 0.5 * seen.velocity.size / seen.sampling_Hz * MAINS_HZ[0] < FEWEST:
        return None
    frequency, spectra, count = seen.halves
    rate = seen.sampling_Hz / seen.few
    orders = [int(np.clip(2.0 * seen.own_Hz / mains, *ORDERS)) for mains in MAINS_HZ]
    mains = np.repeat(MAINS_HZ, orders)
    nominal = mains * np.concatenate([np.arange(1, most + 1) for most in orders])
    near = LINES_AWAY * rate / count + PART_AWAY * seen.own_Hz
    clear = np.abs(nominal - seen.own_Hz) > near
    clear &= (nominal / frequency[1] > REACH // 2) & (nominal < frequency[-REACH - 2])
    if not clear.any():
        return None
    nominal, mains = nominal[clear], mains[clear]
    at, phasor, ratio = _steady(spectra, rate, count, frequency[1], nominal)
    strongest = float(ratio.max())
    # 300 Hz belongs to both series: the stronger series is taken
    found = np.flatnonzero((ratio > THRESHOLD) & (mains == mains[np.argmax(ratio)]))
    if not found.size:
        return Finding(strongest, THRESHOLD, "subtract", "")
    # of the means over a few samples, back to the samples
    phasor /= np.sinc(at / rate) / np.sinc(at / seen.sampling_Hz)
    time = (np.arange(float(seen.velocity.size)) - 0.5 * (seen.few - 1)) / seen.sampling_Hz
    excess = np.zeros(time.size)
    for k in found:
        excess += (phasor[k] * np.exp(2j * np.pi * np.mod(at[k] * time, 1.0))).real
    listed = ", ".join(f"{abs(phasor[k]):.2g} m/s at {at[k]:.5g} Hz" for k in found)
    return Finding(strongest, THRESHOLD, "subtract", f"mains hum: {listed}; taken off", (), excess)


def _steady(
    spectra: Complex[ndarray, "2 bin"],
    rate: float,
    count: int,
    bin_Hz: float,
    nominal: Float[ndarray, " line"],
) -> tuple[Float[ndarray, " line"], Complex[ndarray, " line"], Float[ndarray, " line"]]:
    """Frequency, phasor and size over standard error of a steady line near each frequency."""
    middle = np.round(nominal / bin_Hz).astype(int)
    bins = middle[:, None] + np.arange(-REACH, REACH + 1)
    bins = np.maximum(bins, 1)
    data = spectra[:, bins]  # half, line, bin
    data = data - (data @ _AWAY) @ _AWAY.T
    room = np.maximum(0.5 * rate / count, WANDER * nominal)
    trials = int(np.clip(np.ceil(A_LINE * room.max() * count / rate), LEAST, MOST))

    def fit(at):
        """Phasors of a line at each frequency in both halves, and the shape's power."""
        shape = _taper_spectrum((bins[:, None, :] * bin_Hz - at[:, :, None]) * count / rate)
        shape = shape - (shape @ _AWAY) @ _AWAY.T  # line, trial, bin
        power = (np.abs(shape) ** 2).sum(axis=-1)
        parts = np.einsum("hlb,ltb->hlt", data, shape.conj()) / power
        # the second half starts `count` samples later
        parts[1] /= np.exp(2j * np.pi * np.mod(at * count / rate, 1.0))
        return parts, power

    at = nominal[:, None] + room[:, None] * np.linspace(-1.0, 1.0, trials)
    parts, power = fit(at)
    best = np.argmax((np.abs(parts) ** 2).sum(axis=0) * power, axis=1)
    line = np.arange(nominal.size)
    # the phase from one half to the other tells the frequency best
    turned = np.angle(parts[1] * parts[0].conj())[line, best] / (2.0 * np.pi)
    at = at[line, best] + turned * rate / count
    parts, power = (value[..., 0] for value in fit(at[:, None]))
    phasor = parts.mean(axis=0)
    total = (np.abs(data) ** 2).sum(axis=(0, 2))
    left = np.maximum(total - 2.0 * np.abs(phasor) ** 2 * power, 1e-12 * total)
    error = np.sqrt(left / (2 * (len(_AWAY) - 4)) / (2.0 * power)) + 1e-300
    ratio = np.abs(phasor) / error
    allowed = np.maximum(UNEVEN * np.abs(phasor), UNEVEN_ERRORS * error)
    uneven = np.abs(parts[0] - parts[1]) > allowed
    off = np.abs(at - nominal) > WANDER * nominal + BESIDE * rate / count
    ratio[uneven | off] = 0.0
    return at, phasor, ratio


def _taper_spectrum(turns: Float[ndarray, "*any"]) -> Complex[ndarray, "*any"]:
    """Spectrum of the Blackman-Harris taper at a distance (in turns over it) from a unit line."""
    turns = turns + 1e-9  # a pole of a term is a zero of the sine: not to hit it
    square = turns**2
    # a cosine's two sinc are one, times this; its sign and that of its shifted phase cancel
    total = 1.0
    for turn, term in enumerate(TERMS[1:], 1):
        total = total + (-1) ** turn * term / TERMS[0] * square / (square - turn**2)
    return total * np.sinc(turns) * np.exp(-1j * np.pi * turns)
