"""FREEVIB: amplitude-dependent frequency and loss factor of a free decay (3.1 to 3.13, App. F)."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.decay.phasors import Phasors
from bladeroot.decay.scatter import noise_ratio
from bladeroot.decay.smooth import smooth
from bladeroot.decay.track import Band, follow, separate, sites

POINT = (
    ("time", "s", "time since the start of the cut", ""),
    ("amplitude", "m", "displacement amplitude at the sensor", "eqs 3.1, 3.12"),
    ("frequency", "Hz", "undamped natural frequency", "eq. 3.11"),
    ("loss_factor", "1", "hysteretic loss factor", "eq. 3.11"),
    ("amplitude_std", "m", "standard error of amplitude", "App. F"),
    ("frequency_std", "Hz", "standard error of frequency", "App. F"),
    ("loss_factor_std", "1", "standard error of loss factor", "App. F"),
)
BLOCK = (
    ("block_time", "s", "centre of a block of whole cycles", ""),
    ("block_log_amplitude", "1", "ln of the displacement amplitude in m", "eq. 3.1"),
    ("block_phase", "rad", "unwrapped phase of the displacement", "eq. 3.1"),
    ("block_std", "1", "standard error of log-amplitude and of phase", "App. F"),
)


def freevib(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    noise: float,
    tolerance: float = 0.3,
    points: int = 500,
) -> xr.Dataset:
    """Frequency and loss factor as functions of displacement amplitude from a free decay.

    The analytic displacement Y = A exp(i phi) obeys Y'' + omega_n^2 (1 + i eta) Y = 0 (3.7), so
    omega_n^2 = omega^2 - A''/A and eta = -(2 omega A'/A + omega') / omega_n^2 (3.11), with
    omega = phi'. The velocity's own log-derivative lambda_V is measured; the displacement's is
    lambda = A'/A + i omega = lambda_V - lambda_V' / lambda_V, and Y = V / lambda, which replaces
    the integration and the Hilbert filters of the thesis.

    Args:
        velocity: free decay in m/s, the release or blow left out.
        sampling_Hz: sampling frequency.
        expected_Hz: the mode is looked for within `tolerance` (relative) of it.
        noise: rms of the sensor's noise in m/s; corrected by what the blocks themselves show.
        tolerance: relative half-width of the search band.
        points: largest number of points of the curves.

    Returns:
        Dataset with dim `point` (the curves, in time order, with standard errors and the windows
        in seconds) and dim `block` (independent log-phasors of the displacement, from which
        the plateau is fitted).

    Raises:
        ValueError: no line in the band, or fewer than eight cycles of it.
    """
    band = main_band(velocity, sampling_Hz, expected_Hz, tolerance)
    # no digitiser is better than this, and errors without a floor mean nothing
    noise = max(float(noise), 5e-6 * float(np.abs(velocity).max()))
    alone, others, carriers = separate(velocity, sampling_Hz, band, noise)
    apart = [
        carrier
        for other, carrier in zip(others, carriers, strict=True)
        if other.centre_Hz > 1.8 * band.centre_Hz
    ]
    blocks, _ = follow(alone, sampling_Hz, band, noise, corrections=3, others=apart)
    # a clock and a digitiser are never better than a millionth of a radian
    std = np.hypot(blocks.std * np.maximum(noise_ratio(blocks), 0.5), 1e-6)
    blocks = Phasors(blocks.time, blocks.log, std)
    count = min(points, max(8, blocks.time.size))
    centre = np.interp(
        np.linspace(0, blocks.time.size - 1, count), np.arange(blocks.time.size), blocks.time
    )
    knots = sites(blocks, 150)
    blocks = _doubt_outliers(blocks, knots)
    both = np.concatenate([centre, blocks.time])
    level = smooth(blocks.time, blocks.log.real, blocks.std, knots, both)
    phase = smooth(blocks.time, blocks.log.imag, blocks.std, knots, both)
    rate = level.value[1] + 1j * phase.value[1]
    change = level.value[2] + 1j * phase.value[2]
    lam = rate - change / rate
    alpha, omega = lam.real, lam.imag
    square = omega**2 - level.value[2] - alpha**2
    omega_n = np.sqrt(np.where(square > 0.0, square, np.nan))  # negative: the mode is lost
    loss = -(2.0 * omega * alpha + phase.value[2]) / omega_n**2
    amplitude = np.exp(level.value[0]) / np.abs(lam)
    frequency_std = np.hypot(phase.std[1], 0.5 * level.std[2] / omega) / (2.0 * np.pi)
    loss_std = np.hypot(2.0 * level.std[1] / omega, phase.std[2] / omega**2)
    meaningful = (level.std[0] < 0.1) & (loss_std < 0.5 * np.maximum(loss, 1e-4))
    meaningful &= frequency_std < 5e-4 * omega_n / (2.0 * np.pi)
    keep = _before_noise(meaningful[:count])
    curves = (both, amplitude, omega_n / (2.0 * np.pi), loss)
    errors = (amplitude * level.std[0], frequency_std, loss_std)
    displacement = blocks.log - np.log(lam[count:])
    result = _dataset(
        [values[:count][keep[:count]] for values in (*curves, *errors)],
        [blocks.time, displacement.real, displacement.imag, blocks.std],
    )
    result.attrs["band_low_Hz"] = band.low_Hz
    result.attrs["band_high_Hz"] = band.high_Hz
    result.attrs["other_modes_Hz"] = [float(other.centre_Hz) for other in others]
    return result


def no_decay() -> xr.Dataset:
    """The empty result of a rejected record: the variables of `freevib`, no points."""
    return _dataset([np.empty(0)] * len(POINT), [np.empty(0)] * len(BLOCK))


def main_band(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    tolerance: float = 0.3,
) -> Band:
    """The mode's line nearest the expected frequency in strength, and a band around it."""
    low, high = expected_Hz * (1.0 - tolerance), expected_Hz * (1.0 + tolerance)
    if not 0.0 < expected_Hz < 0.48 * sampling_Hz:
        raise ValueError(
            f"expected_Hz must lie between 0 and {0.48 * sampling_Hz:.6g} Hz (sampling at "
            f"{sampling_Hz:.6g} Hz), got {expected_Hz:.6g}"
        )
    return Band(expected_Hz, low, min(high, 0.49 * sampling_Hz))


def _before_noise(good: ndarray, reach: int = 10) -> ndarray:
    """The good points up to where the bad ones take over for good."""
    padded = np.concatenate([np.ones(reach - 1), good])
    share = np.convolve(padded, np.full(reach, 1.0 / reach), mode="valid")
    lasting = np.flatnonzero(share >= 0.5)
    keep = good.copy()
    keep[lasting[-1] + 1 if lasting.size else 0 :] = False
    return keep


def _doubt_outliers(blocks: Phasors, knots: Float[ndarray, " site"], limit: float = 2.5) -> Phasors:
    """Larger standard errors for blocks off the smooth curve (a filter's edges, knocks)."""
    level = smooth(blocks.time, blocks.log.real, blocks.std, knots, blocks.time, iterations=20)
    phase = smooth(blocks.time, blocks.log.imag, blocks.std, knots, blocks.time, iterations=20)
    miss = np.abs(blocks.log - level.value[0] - 1j * phase.value[0]) / np.sqrt(2.0) / blocks.std
    return Phasors(blocks.time, blocks.log, blocks.std * np.maximum(1.0, miss / limit))


def _dataset(points: Sequence[ndarray], blocks: Sequence[ndarray]) -> xr.Dataset:
    result = xr.Dataset()
    for dim, table, columns in (("point", POINT, points), ("block", BLOCK, blocks)):
        for (name, units, long_name, source), values in zip(table, columns, strict=True):
            attrs = {"units": units, "long_name": long_name}
            result[name] = (dim, values, attrs | {"source": source} if source else attrs)
    return result
