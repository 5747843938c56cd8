"""The extrema of one mode's displacement: the raw material of peak finding and fitting.

The record is integrated and band-passed in one step with a Butterworth filter that looks forward
in time only (a record turned round, filtered, and turned back): the sudden start of a free decay
does not ring into its first cycles, and the end, where it would, lies in the noise.
"""

from functools import cache

import numpy as np
from jaxtyping import Bool, Complex, Float, Inexact, Int
from numpy import ndarray
from scipy import fft

from bladeroot.signal.runs import runs

# The Butterworth band-pass around the mode, which looks forward in time.
FILTER_ORDER = 4
FILTER_QUALITY = 2.5  # centre frequency over the width between the -3 dB points
FILTER_REACH = 6.0 * FILTER_QUALITY  # cycles after an instant on which its output depends
_POLES = np.exp(
    1j * np.pi * (2 * np.arange(1, FILTER_ORDER + 1) + FILTER_ORDER - 1) / (2 * FILTER_ORDER)
)
_POLYNOMIAL = np.poly(_POLES).real
# group delay at the centre, in cycles: a slowly varying decay appears that much too early
FILTER_DELAY = float(-(1.0 / _POLES).sum().real) * FILTER_QUALITY / np.pi

NOISE_LAGS = 60  # half cycles over which filtered white noise is correlated
BRIDGED_GAP = 1.0 / 24.0  # of a cycle: gaps up to this long are bridged by a straight line


def band_displacement(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, expected_Hz: float, tolerance: float
) -> tuple[float, float, float, Float[ndarray, " new"]]:
    """Frequency (Hz) of the strongest line; first time, time step (s), displacement (m) around it.

    The displacement has about 32 samples a cycle, whatever the record has. More than these are
    averaged at once.
    """
    few = max(1, int(sampling_Hz / expected_Hz / 32))
    means = velocity[: velocity.size // few * few].reshape(-1, few) @ np.full(few, 1.0 / few)
    rate = sampling_Hz / few
    margin = 20.0 * FILTER_QUALITY / expected_Hz * rate
    padded = fft.next_fast_len(means.size + int(margin) + 1, real=True)
    spectrum = fft.rfft(means, padded)
    spacing = rate / padded
    low = max(int(expected_Hz * (1.0 - tolerance) / spacing), 1)
    high = min(int(expected_Hz * (1.0 + tolerance) / spacing) + 2, spectrum.size)
    centre = low + int(np.argmax(np.abs(spectrum[low:high])))
    resampled = fft.next_fast_len(32 * centre, real=True)
    # beyond eight times the frequency the filter leaves nothing
    size = min(spectrum.size, 8 * centre)
    kept = np.zeros(resampled // 2 + 1, dtype=complex)
    place = np.arange(1, size)
    kept[1:size] = spectrum[1:size] * _gain(place / centre) / (2j * np.pi * spacing * place)
    step = padded / rate / resampled
    passed = np.sinc(centre / padded) / np.sinc(centre / padded / few)  # averaging
    wave = fft.irfft(kept, resampled) * (resampled / padded / passed)
    start = 0.5 * (few - 1) / sampling_Hz
    return centre * spacing, start, step, wave[: int(means.size / rate / step)]


def extrema(
    wave: Float[ndarray, " sample"], step: float, start: float = 0.0
) -> tuple[Float[ndarray, " peak"], Float[ndarray, " peak"]]:
    """Times and heights (without sign) of all extrema, each on a quartic through five samples."""
    size = np.abs(wave)
    top = 2 + np.flatnonzero((size[2:-2] >= size[1:-3]) & (size[2:-2] > size[3:-1]))
    near = np.arange(-2, 3)
    a, b, c, d, e = np.linalg.inv(np.vander(near, 5)) @ wave[top + near[:, None]]
    x = np.zeros(top.size)
    for _ in range(3):
        slope = ((4 * a * x + 3 * b) * x + 2 * c) * x + d
        bend = (12 * a * x + 6 * b) * x + 2 * c
        x = np.clip(x - slope / np.where(bend == 0.0, 1.0, bend), -1.0, 1.0)
    return start + (top + x) * step, np.abs((((a * x + b) * x + c) * x + d) * x + e)


def bridged(
    velocity: Float[ndarray, " sample"], usable: Bool[ndarray, " sample"], shortest: float
) -> tuple[Float[ndarray, " sample"], Bool[ndarray, " sample"]]:
    """Gaps filled by straight lines; those up to `shortest` samples long count as usable."""
    at = np.arange(velocity.size)
    filled = np.where(usable, velocity, np.interp(at, at[usable], velocity[usable]))
    good = usable.copy()
    for first, stop in runs(~usable):
        good[first:stop] |= stop - first <= shortest
    return filled, good


def undisturbed(
    time: Float[ndarray, " peak"],
    reach: float,
    bad: Int[ndarray, " bad"],
    samples: int,
    sampling_Hz: float,
) -> Bool[ndarray, " peak"]:
    """Whether all samples from a peak to `reach` seconds after it are there and not bad."""
    first = (time * sampling_Hz).astype(int)
    last = ((time + reach) * sampling_Hz).astype(int) + 1
    return (last <= samples) & (np.searchsorted(bad, first) == np.searchsorted(bad, last))


@cache
def correlation() -> Float[ndarray, " lag"]:
    """Correlation of filtered white noise over up to `NOISE_LAGS` half cycles either way."""
    ratio = np.linspace(0.4, 2.4, 251)
    power = np.abs(_gain(ratio)) ** 2 / ratio**2
    wave = np.cos(np.pi * (ratio[:, None] - 1.0) * np.arange(-NOISE_LAGS, NOISE_LAGS + 1))
    return power @ wave / power.sum()


def noise_bandwidth() -> float:
    """Width over centre frequency of the ideal band that passes as much white noise."""
    return float(np.pi / 2 / FILTER_ORDER / np.sin(np.pi / 2 / FILTER_ORDER)) / FILTER_QUALITY


def uneven_gain(
    rate: Complex[ndarray, " point"], centre_Hz: float
) -> tuple[Float[ndarray, " point"], Float[ndarray, " point"]]:
    """ln of the filter's gain and its phase for exp(rate t), rate in 1/s, without the delay."""
    ratio = rate / (2j * np.pi * centre_Hz)
    gain = _gain(ratio) * np.exp(-2j * np.pi * FILTER_DELAY * (ratio - 1.0))
    return np.log(np.abs(gain)), np.unwrap(np.angle(gain))


def _gain(ratio: Inexact[ndarray, " bin"]) -> Complex[ndarray, " bin"]:
    """Gain by (complex) frequency over centre: the usual filter's conjugate, as it looks ahead."""
    return 1.0 / np.polyval(_POLYNOMIAL, -1j * FILTER_QUALITY * (ratio - 1.0 / ratio))
