"""What rings beside the mode and is no line of its own: a wave that is taken off, and its error."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.decay.envelope_model import Envelopes

# What may be left of it is no more than this part of the mode, where a curve still goes.
HIDDEN = 0.3


@dataclass(frozen=True)
class Beside:
    """A wave in the samples, its error (m/s) at times (s) evenly spaced, and the finding's id.

    alike: cycles of the mode over which the error is one and the same.
    """

    frequency_Hz: float
    wave: Float[ndarray, " sample"]
    time: Float[ndarray, " interval"]
    error: Float[ndarray, " interval"]
    finding: str
    remark: str
    alike: float = 1.0

    def over(self, mode: Complex[ndarray, " middle"], time: Float[ndarray, " middle"]) -> ndarray:
        """Its error over the mode, at times."""
        return np.interp(time, self.time, self.error) / np.maximum(np.abs(mode), 1e-300)

    def doubt(self, mode: Complex[ndarray, " middle"], time: Float[ndarray, " middle"]) -> ndarray:
        """The same as an error of independent cycles, of the mode at most."""
        return np.minimum(self.over(mode, time) * np.sqrt(self.alike), 1.0)

    def hides(self, found: Envelopes, sampling_Hz: float) -> int:
        """Samples until what is left of it may be more than `HIDDEN` of the mode."""
        mode = found.envelope(0)
        time = (np.arange(mode.size) + 0.5) * found.spacing / sampling_Hz
        hidden = np.flatnonzero(self.over(mode, time) > HIDDEN)
        return int(hidden[0]) * found.spacing if hidden.size else found.samples
