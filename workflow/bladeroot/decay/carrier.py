"""A first, rough log-phasor of one mode: where its cycles lie and how fast it decays."""

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.records.spectrum import band_signal


def rough_log_phasor(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    low_Hz: float,
    high_Hz: float,
    noise: float,
) -> Complex[ndarray, " sample"]:
    """ln of the mode's analytic signal at every sample, good to a fraction of a radian.

    Real part: log-envelope; imaginary part: unwrapped phase. The two ends, where the filter
    rings or the mode drowns in the noise (rms `noise` over the full band), are continued with
    constant frequency and decay rate.
    """
    analytic = band_signal(velocity, sampling_Hz, low_Hz, high_Hz)
    envelope = np.abs(analytic)
    log_phasor = np.log(envelope + 1e-300) + 1j * np.unwrap(np.angle(analytic))
    in_band = noise * np.sqrt(2.0 * (high_Hz - low_Hz) / sampling_Hz)
    ring = int(1.5 * sampling_Hz / (high_Hz - low_Hz))
    drowned = np.flatnonzero(envelope[ring:] < 5.0 * in_band)
    last = (ring + drowned[0] if drowned.size else velocity.size) - ring
    last = max(min(last, velocity.size - ring), min(2 * ring, velocity.size))
    sample = np.arange(velocity.size, dtype=float)
    span = max(2, min(2 * ring, last // 2))
    first = min(ring, max(last - span, 0))
    head = slice(first, first + span)
    slope = _slope(sample[head], log_phasor[head])
    log_phasor[:first] = log_phasor[first] + slope * (sample[:first] - first)
    stretch = max(span, (last - first) // 5)
    tail = slice(max(last - stretch, 0), last)
    slope = _slope(sample[tail], log_phasor[tail])
    slope = complex(min(slope.real, 0.0), slope.imag)  # nothing grows in a free decay
    middle = 0.5 * (tail.start + tail.stop - 1)
    log_phasor[last:] = log_phasor[tail].mean() + slope * (sample[last:] - middle)
    return log_phasor


def _slope(x: Float[ndarray, " k"], y: Complex[ndarray, " k"]) -> complex:
    centred = x - x.mean()
    return complex((centred @ y) / (centred @ centred))
