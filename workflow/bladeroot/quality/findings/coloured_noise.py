"""Noise that is stronger around the mode than the white floor that standard errors assume."""

import numpy as np

from bladeroot.quality.finding import Finding
from bladeroot.quality.sight import Sight

STATISTIC = "ln(noise power around the mode / white floor) in standard errors, later half"
THRESHOLD = 6.0
# Less than twice the power (3 dB) does not matter.
LEAST = np.log(2.0)


def find(sight: Sight) -> Finding | None:
    """Median power from 0.3 to 0.8 and 1.3 to 1.8 of the mode's frequency, against the floor.

    The later half of the decay is looked at, where the modes have died down most; what remains
    of them near 0.8 and 1.3 cannot raise the median.
    """
    frequency, spectra, count = sight.halves
    relative = frequency / sight.own_Hz
    around = ((relative > 0.3) & (relative < 0.8)) | ((relative > 1.3) & (relative < 1.8))
    around &= frequency < 0.9 * frequency[-1]
    if around.sum() < 24:
        return None
    # power of white noise through a Blackman-Harris taper (2.004 lines wide), median of chi2_2
    white = 2.0 * 2.0044 * sight.floor**2 / (count * sight.few) * 2.0 * np.log(2.0)
    excess = float(np.log(np.median(np.abs(spectra[1, around]) ** 2) / white))
    error = 1.2 / np.sqrt(around.sum() / 2.0)
    statistic = excess / max(error, LEAST / THRESHOLD)
    noise = float(sight.floor * np.exp(0.5 * excess))
    text = (
        f"coloured noise: {10.0 * excess / np.log(10.0):.1f} dB stronger around the mode than the "
        f"white floor, {noise:.2g} m/s; what of it shakes the mode itself is in no standard error"
    )
    return Finding(statistic, THRESHOLD, "warn", text, noise=noise)
