"""Peak finding and fitting (PFF): a second opinion on frequency and damping of a free decay.

The peaks of the filtered displacement are located one by one, the frequency follows from their
spacing and the damping from their decline (Jin, Chen, Brake, Song, J. Vib. Acoust. 142(5), 2020:
051111). Nothing here is shared with `freevib`, so that a fault of either shows as a difference.

Known systematic effects. A curve is averaged over the segment in which it was fitted: where slip
sets in, frequency and damping are rounded over about half of `pff_window`. A mode closer than
about a third of the frequency passes the filter and beats.
"""

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int
from numpy import ndarray

from bladeroot.decay.peaks import (
    BRIDGED_GAP,
    FILTER_DELAY,
    FILTER_REACH,
    band_displacement,
    bridged,
    correlation,
    extrema,
    noise_bandwidth,
    undisturbed,
    uneven_gain,
)
from bladeroot.signal.lines import FREQUENCY_TOLERANCE
from bladeroot.signal.phasors import natural
from bladeroot.variables import dataset, names

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
    centre_Hz, start, step, wave = band_displacement(
        velocity, sampling_Hz, expected_Hz, FREQUENCY_TOLERANCE
    )
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
    return dataset("decay/peak", dict(zip(names("decay/peak"), columns, strict=True)))
