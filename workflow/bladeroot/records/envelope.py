"""A mode's envelope frame by frame, and what the frames hold besides the mode."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray


@dataclass(frozen=True)
class Envelope:
    """Amplitude and phase of a mode and rms of the rest in frames of a few cycles."""

    time: Float[ndarray, " frame"]
    amplitude: Float[ndarray, " frame"]
    phase: Float[ndarray, " frame"]
    rest: Float[ndarray, " frame"]
    frame_s: float

    def noise(self, white: float, sampling_Hz: float) -> float:
        """Amplitude that white noise of an rms shows in a frame."""
        return white * float(np.sqrt(3.0 * np.pi / 2.0 / (self.frame_s * sampling_Hz)))


def envelope(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    frequency_Hz: float,
    cycles: float = 3.0,
    steps_a_cycle: float = 2.0,
) -> Envelope:
    """Hann-weighted amplitude of the component at a frequency, every half cycle.

    Frames do not reach beyond the record, so a decay that starts at the first sample shows its
    full height there. The component may grow and drift within a frame; `rest` is what remains of
    the frame without it, a mean and a trend. The phase is unwrapped, against `frequency_Hz`.
    """
    width = max(8, round(cycles * sampling_Hz / frequency_Hz))
    step = max(1, round(sampling_Hz / frequency_Hz / steps_a_cycle))
    frames = np.lib.stride_tricks.sliding_window_view(velocity, width)[::step]
    local = (np.arange(width) - 0.5 * (width - 1)) / sampling_Hz
    taper = np.hanning(width + 2)[1:-1]
    angle = 2.0 * np.pi * frequency_Hz * local
    cos, sin, x = np.cos(angle), np.sin(angle), local / local[-1]
    columns = np.stack([cos, sin, x * cos, x * sin, np.ones(width), x], axis=1)
    root = np.sqrt(taper / taper.sum())
    solver = np.linalg.pinv(columns * root[:, None]) * root
    parts = frames @ solver.T
    power = (frames**2) @ root**2
    explained = np.einsum("fi,ij,fj->f", parts, (columns * root[:, None] ** 2).T @ columns, parts)
    time = (np.arange(frames.shape[0]) * step + 0.5 * (width - 1)) / sampling_Hz
    turn = 2.0 * np.pi * frequency_Hz * time
    phase = np.unwrap(np.arctan2(-parts[:, 1], parts[:, 0]) - np.mod(turn, 2.0 * np.pi))
    return Envelope(
        time=time,
        amplitude=np.hypot(parts[:, 0], parts[:, 1]),
        phase=phase,
        rest=np.sqrt(np.maximum(power - explained, 0.0)),
        frame_s=width / sampling_Hz,
    )
