"""Peak finding and fitting (PFF): a second opinion on frequency and damping of a free decay.

The peaks of the filtered displacement are located one by one, the frequency follows from their
spacing and the damping from their decline (Jin, Chen, Brake, Song, J. Vib. Acoust. 142(5), 2020:
051111). Nothing here is shared with `freevib`, so that a fault of either shows as a difference.

Known systematic effects. A curve is averaged over the segment in which it was fitted: where slip
sets in, frequency and damping are rounded over about half of `pff_window`. A mode closer than
about a third of the frequency passes the filter and beats.

The record is integrated and band-passed in one step with a Butterworth filter that looks forward
in time only (a record turned round, filtered, and turned back): the sudden start of a free decay
does not ring into its first cycles, and the end, where it would, lies in the noise.
"""

from functools import cache

import numpy as np
import xarray as xr
from jaxtyping import Bool, Complex, Float, Inexact, Int
from numpy import ndarray
from scipy import fft

from bladeroot.signal.lines import FREQUENCY_TOLERANCE
from bladeroot.signal.phasors import natural
from bladeroot.signal.runs import runs
from bladeroot.variables import dataset, names

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
PEAK_OVER_NOISE = 8.0  # ratio to the noise's rms in the band; a lower peak ends the curve
# The segment that is fitted around each point of the curve.
SEGMENT_FALL = 0.5  # fall of ln A over it
FEWEST_PEAKS = 24  # in it, however much ln A falls
MOST_PEAKS = 400
POLYNOMIAL_DEGREE = 3  # of time and of ln A over the peak's number
CURVE_POINTS = 300  # of a record at most, shared among its runs of peaks by their lengths


def peak_fit(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    noise: float,
    usable: Bool[ndarray, " sample"] | None = None,
    damping: str = "hysteretic",
) -> xr.Dataset:
    """Frequency and loss factor against displacement amplitude from the peaks of a free decay.

    Standard errors are from the scatter of the peaks about the fit, with the correlation that
    the filter gives to white noise, and from what a polynomial of a higher degree changes.

    Args:
        velocity: free decay in m/s.
        sampling_Hz: sampling frequency.
        expected_Hz: the mode is looked for within `FREQUENCY_TOLERANCE` (relative) of it.
        noise: rms of the sensor's noise in m/s: what it leaves in the band ends the curve.
        usable: False for samples that must not count; peaks they reach are left out.
        damping: "hysteretic" (3.11) or "viscous" (the loss factor is then 2 zeta).

    Returns:
        Dataset with dim `peak` (0 long where no segment has enough peaks), variables of that table.
    """
    if velocity.size * expected_Hz < FEWEST_PEAKS * sampling_Hz:
        return no_peaks()
    bad = np.zeros(0, dtype=int)
    if usable is not None and not usable.all():
        if usable.sum() < 2:
            return no_peaks()
        velocity, good = bridged(velocity, usable, BRIDGED_GAP * sampling_Hz / expected_Hz)
        bad = np.flatnonzero(~good)
    centre_Hz, start, step, wave = band_displacement(velocity, sampling_Hz, expected_Hz)
    time, size = extrema(wave, step, start)
    keep = undisturbed(time, FILTER_REACH / centre_Hz, bad, velocity.size, sampling_Hz)
    in_band = noise * np.sqrt(2.0 * noise_bandwidth() * centre_Hz / sampling_Hz)
    drowned = np.flatnonzero((size < PEAK_OVER_NOISE * in_band / (2.0 * np.pi * centre_Hz)) & keep)
    keep[drowned[0] if drowned.size else keep.size :] = False
    pieces = _segments(np.flatnonzero(keep), time, centre_Hz)
    total = sum(piece.size for piece in pieces)
    rows = [
        _curve(
            time[piece], size[piece], centre_Hz, max(2, CURVE_POINTS * piece.size // total), damping
        )
        for piece in pieces
    ]
    if not rows:
        return no_peaks()
    columns = np.concatenate(rows, axis=1)
    columns[0] += FILTER_DELAY / centre_Hz
    return _dataset(columns)


def no_peaks() -> xr.Dataset:
    """The empty result of a record without peaks."""
    return _dataset(np.empty((7, 0)))


def _segments(keep: Int[ndarray, " kept"], time: ndarray, centre_Hz: float) -> list[ndarray]:
    """Runs of neighbouring peaks half a cycle apart, long enough to be fitted."""
    if keep.size < FEWEST_PEAKS:
        return []
    apart = np.diff(time[keep]) * 2.0 * centre_Hz
    breaks = 1 + np.flatnonzero((np.diff(keep) > 1) | (np.abs(apart - 1.0) > 0.3))
    return [run for run in np.split(keep, breaks) if run.size >= FEWEST_PEAKS]


def _curve(
    time: ndarray, size: ndarray, centre_Hz: float, points: int, damping: str
) -> Float[ndarray, "column point"]:
    """Rows of table `peak` for one segment of peaks."""
    level = np.log(size)
    at = np.unique(np.linspace(0, time.size - 1, min(points, time.size)).round().astype(int))
    length = _lengths(level)[at]
    fitted = _fitted(np.stack([time, level]), at, length)
    (clock, decline), (period, fall), (period_std, fall_std) = fitted
    turn, rate = np.pi / period, fall / period
    turn_std, rate_std = turn * period_std / period, fall_std / period
    # a peak lies where the phase is atan(rate / turn), which moves where damping changes
    turn = turn + np.gradient(rate / turn, clock)
    # where the frequency moves, so does the filter's gain; corrected to first order
    passed, ahead = uneven_gain(rate + 1j * turn, centre_Hz)
    faded, turned = np.gradient(passed, clock), np.gradient(ahead, clock)
    rate, rate_std = rate - faded, np.hypot(rate_std, faded)
    turn, turn_std = turn - turned, np.hypot(turn_std, turned)
    chirp, bend = (np.gradient(x, clock) for x in (turn, rate))
    omega_n, loss = natural(np.stack([rate, turn]), np.stack([bend, chirp]), damping)
    amplitude = np.exp(decline - passed) * np.hypot(1.0, rate / turn)
    window = length * period
    frequency = omega_n / (2.0 * np.pi)
    errors = (turn_std / (2.0 * np.pi), 2.0 * rate_std / turn)
    return np.stack([clock, amplitude, frequency, loss, *errors, window])


def _lengths(level: Float[ndarray, " peak"]) -> Int[ndarray, " peak"]:
    """Number of peaks around each peak in which ln A falls by `SEGMENT_FALL`."""
    edges = np.linspace(0, level.size, min(16, level.size // 8) + 1).astype(int)
    mean = np.add.reduceat(level, edges[:-1]) / np.diff(edges)
    middle = 0.5 * (edges[1:] + edges[:-1])
    rate = np.abs(np.diff(mean)) / np.diff(middle) if middle.size > 1 else np.zeros(1)
    between = 0.5 * (middle[1:] + middle[:-1]) if middle.size > 1 else middle
    wanted = SEGMENT_FALL / np.maximum(np.interp(np.arange(level.size), between, rate), 1e-6)
    # a ladder of lengths, so that few matrices serve all points
    steps = np.round(np.log(np.clip(wanted, FEWEST_PEAKS, MOST_PEAKS)) / np.log(1.25))
    return np.clip(1.25**steps, FEWEST_PEAKS, min(MOST_PEAKS, level.size)).astype(int)


def _fitted(
    y: Float[ndarray, "part peak"], at: Int[ndarray, " point"], length: Int[ndarray, " point"]
) -> Float[ndarray, "3 part point"]:
    """Polynomials in the peak's number through `length` peaks around each of `at`.

    Their values, slopes, and the slopes' standard errors.

    Maxima and minima may differ by a constant (an offset, a second harmonic). The slope's standard
    error includes by how much a polynomial of two degrees more changes it.
    """
    value = np.empty((y.shape[0], at.size))
    slope, variance = np.empty((2, 2, y.shape[0], at.size))  # of both degrees
    lags = correlation()
    for count in np.unique(length):
        which = length == count
        start = np.clip(at[which] - count // 2, 0, y.shape[1] - count)
        half = 0.5 * (count - 1)
        powers = np.arange(POLYNOMIAL_DEGREE + 3)
        x = (np.arange(count) - half) / half
        alternating = np.where(np.arange(count) % 2, 1.0, -1.0)
        basis, triangle = np.linalg.qr(np.column_stack([alternating, x[:, None] ** powers]))
        coloured = [np.convolve(column, lags)[lags.size // 2 :][:count] for column in basis.T]
        covariance = np.stack(coloured) @ basis
        piece = np.lib.stride_tricks.sliding_window_view(y, count, axis=1)[:, start]
        origin = piece[..., :1]
        piece = piece - origin
        projected = piece @ basis
        piece -= projected @ basis.T
        left = np.einsum("ypw,ypw->yp", piece, piece)
        place = (at[which] - start - half) / half
        curve = place[:, None] ** powers
        tangent = np.zeros_like(curve)
        tangent[:, 1:] = curve[:, :-1] * powers[1:] / half
        for k, terms in enumerate((POLYNOMIAL_DEGREE + 2, POLYNOMIAL_DEGREE + 4)):
            inverse = np.linalg.inv(triangle[:terms, :terms])[1:]
            row = tangent[:, : terms - 1] @ inverse
            own = covariance[:terms, :terms]
            slope[k][:, which] = (projected[..., :terms] * row).sum(axis=-1)
            misfit = left + (projected[..., terms:] ** 2).sum(axis=-1)
            spread = ((row @ own) * row).sum(axis=1)
            variance[k][:, which] = misfit / max(count - np.trace(own), 1.0) * spread
            if k == 0:
                row = curve[:, : terms - 1] @ inverse
                value[:, which] = origin[..., 0] + (projected[..., :terms] * row).sum(axis=-1)
    by_noise = np.maximum(variance[1] - variance[0], 0.0)
    bias = np.maximum((slope[1] - slope[0]) ** 2 - by_noise, 0.0)
    return np.stack([value, slope[0], np.sqrt(variance[0] + bias)])


def _dataset(columns: Float[ndarray, "column peak"]) -> xr.Dataset:
    return dataset("quality/peak", dict(zip(names("quality/peak"), columns, strict=True)))


def band_displacement(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, expected_Hz: float
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
    low = max(int(expected_Hz * (1.0 - FREQUENCY_TOLERANCE) / spacing), 1)
    high = min(int(expected_Hz * (1.0 + FREQUENCY_TOLERANCE) / spacing) + 2, spectrum.size)
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
