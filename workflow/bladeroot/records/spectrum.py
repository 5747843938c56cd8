"""Spectral views of a record: a band's analytic signal and the level of white noise."""

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray
from scipy import fft


def band_signal(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, low_Hz: float, high_Hz: float
) -> Complex[ndarray, " sample"]:
    """Analytic signal (3.1) of what lies between two frequencies.

    The band is a zero-phase filter with cosine edges a quarter of the band wide, set in Hz. Near
    the ends of the record it rings for about one over the band's width; the record is padded by
    forty times that, so that a strong start does not ring round into a weak end.
    """
    count = velocity.size
    padded = fft.next_fast_len(count + int(40 * sampling_Hz / (high_Hz - low_Hz)) + 1)
    spectrum = fft.fft(velocity, padded)
    frequency = fft.fftfreq(padded, 1.0 / sampling_Hz)
    edge = (high_Hz - low_Hz) / 4.0
    rise = np.clip((frequency - low_Hz) / edge, 0.0, 1.0)
    fall = np.clip((high_Hz - frequency) / edge, 0.0, 1.0)
    gain = 2.0 * np.sin(0.5 * np.pi * rise) ** 2 * np.sin(0.5 * np.pi * fall) ** 2
    return fft.ifft(spectrum * gain)[:count]


def white_noise(velocity: Float[ndarray, " sample"]) -> float:
    """Rms of the sensor's noise, taken as white, from the floor between the spectral lines.

    The median over frequency ignores lines, the lower quartile over tapered segments ignores
    impacts and the loud part of the record. Segments of 1024 samples, or eighths of a shorter
    record (64 at least, for a median); no more than 100 of them, spread evenly (the quartile
    then rests on 25), so that a long record costs no more than one of 51,000 samples.
    """
    segment = min(velocity.size, max(64, min(1024, velocity.size // 8)))
    count = min(100, max(1, 2 * velocity.size // segment - 1))
    start = np.linspace(0, velocity.size - segment, count).astype(int)
    taper = np.hanning(segment)
    pieces = velocity[start[:, None] + np.arange(segment)]
    pieces = (pieces - pieces.mean(axis=1, keepdims=True)) * taper
    power = np.abs(fft.rfft(pieces, axis=1)) ** 2 / (taper**2).sum()
    floor = np.median(power[:, segment // 50 + 2 : -2], axis=1) / np.log(2.0)
    return float(np.sqrt(np.quantile(floor, 0.25)))
