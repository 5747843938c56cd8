"""What rings beside the mode and is no line of its own: a wave that is taken off, and its error."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.decay.envelope_model import Envelopes

# Standard error of what was taken off over the mode's amplitude: above it the mode counts as hidden
# and its curve ends.
HIDDEN_ABOVE = 0.3


@dataclass(frozen=True)
class Beside:
    """What was found beside the mode, as it is taken off.

    wave: m/s, at the record's samples. error: its standard error (m/s) at `time` (s), evenly
    spaced. finding: the finding's id. alike: how many cycles of the mode share the same error.
    """

    frequency_Hz: float
    wave: Float[ndarray, " sample"]
    time: Float[ndarray, " interval"]
    error: Float[ndarray, " interval"]
    finding: str
    remark: str
    alike: float = 1.0

    def over(self, mode: Complex[ndarray, " middle"], time: Float[ndarray, " middle"]) -> ndarray:
        """The wave's error over the mode's amplitude, at times (s)."""
        return np.interp(time, self.time, self.error) / np.maximum(np.abs(mode), 1e-300)

    def doubt(self, mode: Complex[ndarray, " middle"], time: Float[ndarray, " middle"]) -> ndarray:
        """`over` as an error of independent cycles, larger by the root of `alike`; 1 at most."""
        return np.minimum(self.over(mode, time) * np.sqrt(self.alike), 1.0)

    def hides(self, found: Envelopes, sampling_Hz: float) -> int:
        """Samples until the wave's error is more than `HIDDEN_ABOVE` of the mode."""
        mode = found.envelope(0)
        time = (np.arange(mode.size) + 0.5) * found.spacing / sampling_Hz
        hidden = np.flatnonzero(self.over(mode, time) > HIDDEN_ABOVE)
        return int(hidden[0]) * found.spacing if hidden.size else found.samples
