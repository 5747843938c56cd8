"""What rings beside the mode, closer than lines can be told apart, and is known as a wave."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.decay.envelope_model import Envelopes

# What may be left of it is no more than this part of the mode, where a curve still goes.
HIDDEN = 0.3


@dataclass(frozen=True)
class Beside:
    """A wave in the samples, its error (m/s) at times (s) evenly spaced, and the finding's id."""

    frequency_Hz: float
    wave: Float[ndarray, " sample"]
    time: Float[ndarray, " interval"]
    error: Float[ndarray, " interval"]
    finding: str
    remark: str

    def over(self, mode: Complex[ndarray, " middle"], time: Float[ndarray, " middle"]) -> ndarray:
        """Its error over the mode, at times."""
        return np.interp(time, self.time, self.error) / np.maximum(np.abs(mode), 1e-300)

    def hides(self, found: Envelopes, sampling_Hz: float) -> int:
        """Samples until what is left of it may be more than `HIDDEN` of the mode."""
        mode = found.envelope(0)
        time = (np.arange(mode.size) + 0.5) * found.spacing / sampling_Hz
        hidden = np.flatnonzero(self.over(mode, time) > HIDDEN)
        return int(hidden[0]) * found.spacing if hidden.size else found.samples
