"""A decay inside a band of frequencies that a person gives."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from numpy import ndarray

# Half the filter's length, in inverse widths of the band: shorter lets the neighbours in, longer
# loses more of the decay's ends.
REACH = 2.0


def in_band(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    band_Hz: Sequence[float],
    own_Hz: float,
) -> tuple[Float[ndarray, " sample"], int]:
    """The decay without what lies outside the band, and how many samples at each end are not it.

    A symmetric filter (Hann's window on the ideal band), so that no phase is turned; its gain at
    the mode's frequency `own_Hz` is one.

    Raises:
        ValueError: the mode is not in the band, the band is not below half the sampling frequency,
            or the decay is too short for it.
    """
    from scipy.signal import fftconvolve  # late: few records have a band

    low, high = band_Hz
    if not low < own_Hz < high:
        raise ValueError(f"band_Hz must hold the mode's {own_Hz:g} Hz, got {low:g} to {high:g}")
    if high >= 0.5 * sampling_Hz:
        raise ValueError(
            f"band_Hz must end below half the sampling frequency {sampling_Hz:g} Hz, got {high:g}"
        )
    reach = int(np.ceil(REACH / (high - low) * sampling_Hz))
    if 2 * reach >= velocity.size:
        raise ValueError(
            f"a band of {high - low:g} Hz needs a decay of over {2 * reach / sampling_Hz:.3g} s"
        )
    time = np.arange(-reach, reach + 1) / sampling_Hz
    ideal = 2.0 * (high * np.sinc(2.0 * high * time) - low * np.sinc(2.0 * low * time))
    taps = ideal * np.hanning(time.size + 2)[1:-1]
    taps /= taps @ np.cos(2.0 * np.pi * own_Hz * time)
    return fftconvolve(velocity, taps, mode="same"), reach
