"""Stick frequency of a record that does not reach its plateau: where its curve tends to.

Slip that begins at once lowers the frequency by c A^q at small amplitudes A: q is 0.3 to 1 by
Iwan's density, 1 by Mindlin's contact, more where a threshold rounds off. The limit at no amplitude
is stated for q = 1; what other q would give is an error that records of one mode share, as they
have one joint.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

REACH = 1.2  # of ln A, from the smallest amplitude up, over which a curve is straightened
POWERS = (0.4, 1.0, 2.0)
FEWEST = 4  # points
# Part of the error of the power that a record has to itself: its own friction.
OWN = 0.3


@dataclass(frozen=True)
class Limits:
    """ln of the limit at no amplitude by record, NaN where a curve has none; its standard error in
    the record, and the error by the law's power that records of a mode share.
    """

    ln_f: Float[ndarray, " record"]
    std: Float[ndarray, " record"]
    shared: Float[ndarray, " record"]


def limits(seen: xr.Dataset) -> Limits:
    """Of all records with a curve, from `bladeroot.diagnosis.observations`."""
    count = seen.sizes["record"]
    made = np.full((3, count), np.nan)
    amplitude = seen["amplitude"].values
    if amplitude.size:
        curves = zip(seen["frequency"].values, seen["frequency_std"].values, strict=True)
        for k, (frequency, std) in enumerate(curves):
            known = np.flatnonzero(np.isfinite(frequency) & np.isfinite(std) & (std > 0.0))
            if known.size >= FEWEST:
                near = known[amplitude[known] <= amplitude[known[0]] * np.exp(REACH)]
                if near.size >= FEWEST:
                    f = frequency[near]
                    made[:, k] = _limit(amplitude[near], np.log(f), std[near] / f)
    return Limits(*made)


def _limit(amplitude: ndarray, ln_f: ndarray, std: ndarray) -> tuple[float, float, float]:
    """Limit for q = 1, its standard error if all points err alike, and half of what q does."""
    ends, error = [], 0.0
    for power in POWERS:
        rows = np.stack([np.ones(amplitude.size), (amplitude / amplitude[-1]) ** power], axis=1)
        inverse = np.linalg.inv((rows.T / std**2) @ rows)
        fitted = inverse @ (rows.T @ (ln_f / std**2))
        ends.append(fitted[0])
        if power == 1.0:
            error = np.sqrt(inverse[0, 0] * amplitude.size)
    middle = ends[POWERS.index(1.0)]
    return middle, float(error), 0.5 * float(np.ptp(ends))
