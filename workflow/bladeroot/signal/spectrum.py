"""The level of white noise in a record's spectrum."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy import fft

from bladeroot.signal.runs import medians


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
    taper = np.hanning(segment + 1)[:-1]  # periodic: a mean shows in the lowest two lines only
    pieces = velocity[start[:, None] + np.arange(segment)] * taper
    spectra = fft.rfft(pieces, axis=1)[:, segment // 50 + 2 : -2]
    power = spectra.real**2 + spectra.imag**2
    floor = medians(power) / (np.log(2.0) * (taper**2).sum())
    quartile = np.interp(0.25 * (count - 1), np.arange(count), np.sort(floor))
    return float(np.sqrt(quartile))


def quantum(samples: Float[ndarray, " sample"]) -> float:
    """The digitiser's step: the smallest difference of values (of some thousand samples)."""
    some = np.sort(samples[:: -(-samples.size // 8192)])
    steps = np.diff(some)
    steps = steps[steps > 1e-9 * (some[-1] - some[0])]
    return float(steps.min()) if steps.size else 0.0
