"""Hum of the mains: steady lines at multiples of 50 or 60 Hz."""

from dataclasses import replace

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.quality.examined import Examined, Finding
from bladeroot.signal.lines import BLACKMAN_HARRIS_TERMS

STATISTIC = (
    "largest steady line at a multiple of 50 or 60 Hz (to the 7th, or to twice the mode), in "
    "standard errors"
)
THRESHOLD = 8.0
# Which lines are looked for.
MAINS_HZ = (50.0, 60.0)
# The highest multiple is the one at twice the mode's frequency, but within these orders.
ORDER_LIMITS = (7, 60)
MAINS_WANDER = 0.0015  # the mains' frequency keeps within this (relative)
# Each half of the decay must hold this many periods of 50 Hz, or lines cannot be told apart.
FEWEST_PERIODS = 6
# A line nearer to the mode than the sum of both is not told from it.
MODE_LINES_AWAY = 7.0  # spectral lines, each one over the duration of a half
MODE_PART_AWAY = 0.01  # part of the mode's frequency

# The fit of a steady line and a smooth background to the spectra of both halves.
BACKGROUND_BINS = 6  # bins of the spectrum on either side of the line
# Orthonormal basis of the backgrounds over these bins: constant, straight and bent.
_BACKGROUND = np.linalg.qr(
    np.vander(
        np.arange(-BACKGROUND_BINS, BACKGROUND_BINS + 1.0) / BACKGROUND_BINS, 3, increasing=True
    )
)[0]
# Frequencies that are tried over the search range.
TRIALS_PER_LINE = 8.0  # for each spectral line that the range reaches to either side
FEWEST_TRIALS = 5
MOST_TRIALS = 81
# A line that ends beyond the mains' wander by more than this part of a spectral line is another's.
WANDER_MARGIN = 0.1

# Both halves show the same line where they differ by less than the larger of these.
HALVES_DIFFER = 0.12  # part of the line
HALVES_DIFFER_ERRORS = 4.0  # standard errors


def find(seen: Examined) -> Finding | None:
    """Steady lines in the decay; else those in the record before other modes were taken off."""
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
    if 0.5 * seen.velocity.size / seen.sampling_Hz * MAINS_HZ[0] < FEWEST_PERIODS:
        return None
    frequency, spectra, count = seen.halves
    rate = seen.sampling_Hz / seen.few
    orders = [int(np.clip(2.0 * seen.own_Hz / mains, *ORDER_LIMITS)) for mains in MAINS_HZ]
    mains = np.repeat(MAINS_HZ, orders)
    nominal = mains * np.concatenate([np.arange(1, most + 1) for most in orders])
    near = MODE_LINES_AWAY * rate / count + MODE_PART_AWAY * seen.own_Hz
    place = nominal / frequency[1]
    clear = np.abs(nominal - seen.own_Hz) > near
    clear &= (place > BACKGROUND_BINS // 2) & (place < frequency.size - BACKGROUND_BINS - 2)
    if not clear.any():
        return None
    nominal, mains = nominal[clear], mains[clear]
    at, phasor, ratio = _steady(spectra, rate, count, frequency[1], nominal)
    strongest = float(ratio.max())
    # 300 Hz belongs to both series: the stronger series is taken
    found = np.flatnonzero((ratio > THRESHOLD) & (mains == mains[np.argmax(ratio)]))
    if not found.size:
        return Finding(strongest, THRESHOLD, "subtract", "")
    # from the spectra of means over a few samples back to the samples
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
    bins = middle[:, None] + np.arange(-BACKGROUND_BINS, BACKGROUND_BINS + 1)
    bins = np.maximum(bins, 1)
    data = spectra[:, bins]  # half, line, bin
    data = data - (data @ _BACKGROUND) @ _BACKGROUND.T
    room = np.maximum(0.5 * rate / count, MAINS_WANDER * nominal)
    trials = int(
        np.clip(np.ceil(TRIALS_PER_LINE * room.max() * count / rate), FEWEST_TRIALS, MOST_TRIALS)
    )

    def fit(at):
        """Phasors of a line at each frequency in both halves, and the shape's power."""
        shape = _taper_spectrum((bins[:, None, :] * bin_Hz - at[:, :, None]) * count / rate)
        shape = shape - (shape @ _BACKGROUND) @ _BACKGROUND.T  # line, trial, bin
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
    error = np.sqrt(left / (2 * (len(_BACKGROUND) - 4)) / (2.0 * power)) + 1e-300
    ratio = np.abs(phasor) / error
    allowed = np.maximum(HALVES_DIFFER * np.abs(phasor), HALVES_DIFFER_ERRORS * error)
    uneven = np.abs(parts[0] - parts[1]) > allowed
    off = np.abs(at - nominal) > MAINS_WANDER * nominal + WANDER_MARGIN * rate / count
    ratio[uneven | off] = 0.0
    return at, phasor, ratio


def _taper_spectrum(turns: Float[ndarray, "*any"]) -> Complex[ndarray, "*any"]:
    """Spectrum of the Blackman-Harris taper at a distance (in turns over it) from a unit line."""
    turns = turns + 1e-9  # at whole turns a pole meets a zero of the sine
    square = turns**2
    # the two shifted sinc of a cosine are the unshifted one times this factor; the sign of the
    # shift and that of its phase cancel
    total = 1.0
    for turn, term in enumerate(BLACKMAN_HARRIS_TERMS[1:], 1):
        total = total + (-1) ** turn * term / BLACKMAN_HARRIS_TERMS[0] * square / (square - turn**2)
    return total * np.sinc(turns) * np.exp(-1j * np.pi * turns)
