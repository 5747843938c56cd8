"""Other modes, hum and harmonics: spectral lines in what the mode itself leaves of a record."""

from typing import no_type_check

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray
from scipy import fft

from bladeroot.compiled import njit
from bladeroot.signal.phasors import Stretch


def remainder(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    stretches: list[Stretch],
    log: Complex[ndarray, "3 frame"],
) -> Float[ndarray, " sample"]:
    """The record less the mode, given its log-phasor and two derivatives in each frame."""
    rest = velocity.copy()
    at = 0
    for stretch in stretches:
        own = log[:, at : at + stretch.frames]
        at += stretch.frames
        local = (np.arange(stretch.length) - 0.5 * (stretch.length - 1)) / sampling_Hz
        wave = np.exp(1j * stretch.angle * sampling_Hz * local)
        delta = own[1] - 1j * stretch.angle * sampling_Hz
        growth = np.stack([np.ones_like(delta), delta, 0.5 * (delta**2 + own[2])], axis=1)
        growth = growth * np.exp(own[0])[:, None]
        _take_off(rest[stretch.first :], growth, wave, local)
    return rest


@njit(cache=True)
@no_type_check
def _take_off(rest, growth, wave, local):
    """Less the real part of each frame's wave, which grows as a parabola of the time in it."""
    for frame in range(growth.shape[0]):
        first = frame * wave.size
        a, b, c = growth[frame]
        for k in range(wave.size):
            size = a + local[k] * (b + local[k] * c)
            rest[first + k] -= size.real * wave[k].real - size.imag * wave[k].imag


def find_lines(
    rest: Float[ndarray, " sample"],
    sampling_Hz: float,
    own_Hz: tuple[float, float],
    strength: float,
    most: int = 4,
    ratio: float = 8.0,
    chunk: int = 64,
) -> list[float]:
    """Frequencies of the clearest lines in the remainder, strongest first.

    Looks at the whole record and at its first parts, since a mode that decays fast is only seen
    in a short one. A line must stand `ratio` above the median level around it and above a
    fifty-thousandth of `strength`, the mode's amplitude. `own_Hz`: the lowest and highest
    frequency of the mode itself.
    """
    low, high = own_Hz
    rest = rest.astype(np.float32)  # half the work, and digits enough to find a line
    found: list[tuple[float, float]] = []
    for part in (1, 4, 16, 64):
        count = fft.next_fast_len(rest.size // part, real=True)  # with a few zeros
        if count < 12.0 * sampling_Hz / low or count < 4 * chunk:
            break
        spectrum = fft.rfft(rest[: rest.size // part], count)
        spectrum = spectrum[1:-1] - 0.5 * (spectrum[:-2] + spectrum[2:])  # Hann's window
        power = spectrum.real**2 + spectrum.imag**2
        width = sampling_Hz / count
        whole = power[: power.size // chunk * chunk].reshape(-1, chunk)
        place = whole.argmax(axis=1) + np.arange(whole.shape[0]) * chunk
        height = power[place]
        frequency = (place + 1) * width
        # a line of amplitude one is half the count high
        share = np.sqrt(height) * 2.0 / count / strength
        gap = np.maximum(low - frequency, frequency - high)
        # close by, what the mode's own curve misses is no line
        clear = (gap > 8.0 * width) & (share > np.where(gap < 0.3 * low, 0.004, 2e-5))
        clear &= (frequency > max(low / 20.0, 8.0 * width)) & (frequency < 0.48 * sampling_Hz)
        floor = np.partition(whole[:, ::4], chunk // 8, axis=1)[:, chunk // 8]
        clear &= height > ratio**2 * np.minimum(floor, 900.0 * np.median(floor))
        near = max(0.05 * low, 4.0 * width)
        candidates = np.flatnonzero(clear)
        for k in candidates[np.argsort(-height[candidates])][: 4 * most]:
            is_peak = height[k] >= power[max(place[k] - 8, 0) : place[k] + 9].max()
            # a longer part has told a line's place better
            if is_peak and all(abs(frequency[k] - line) > near for _, line in found):
                found.append((float(height[k]) / count**2, float(frequency[k])))
    return [line for _, line in sorted(found, reverse=True)[:most]]
