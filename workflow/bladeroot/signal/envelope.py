"""A mode's envelope frame by frame, and what the frames hold besides the mode."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.signal.runs import in_frames

# A frame is six half cycles: Hann-weighted, the second mode near twice the first stays out of it.
# It is moved on by half a cycle, and holds at least ten samples for its six unknowns.
FRAME_STEPS = 6
FEWEST_SAMPLES = 10


@dataclass(frozen=True)
class Envelope:
    """A mode's log-phasor, and rms and mean of the rest, in frames of three cycles.

    `log` is ln(amplitude) + i phase, the phase unwrapped and taken against `frequency_Hz`.
    """

    time: Float[ndarray, " frame"]
    log: Complex[ndarray, " frame"]
    rest: Float[ndarray, " frame"]
    mean: Float[ndarray, " frame"]
    frequency_Hz: float
    step_s: float
    frame_s: float

    @property
    def level(self) -> Float[ndarray, " frame"]:
        """Natural logarithm of the amplitude."""
        return self.log.real

    def noise(self, white: float, sampling_Hz: float) -> float:
        """Rms amplitude that white noise (rms) shows in a frame (Hann: 1.5 over its samples)."""
        return white * float(np.sqrt(4.0 * 1.5 / (self.frame_s * sampling_Hz)))


def envelope(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, frequency_Hz: float
) -> Envelope:
    """Hann-weighted log-phasor of the component at a frequency, every half cycle.

    Frames do not reach beyond the record, so a decay that starts at the first sample shows its
    full height there. The component may grow and drift within a frame; `rest` is what remains of
    the frame without it, a mean and a trend. Time and memory grow linearly with the record.
    """
    step = max(1, round(0.5 * sampling_Hz / frequency_Hz))
    parts = max(FRAME_STEPS, -(-FEWEST_SAMPLES // step))
    width = parts * step
    if velocity.size < width:
        raise ValueError(f"expected at least {width} samples, got {velocity.size}")
    local = (np.arange(width) - 0.5 * (width - 1)) / sampling_Hz
    taper = np.hanning(width + 2)[1:-1]
    taper = taper / taper.sum()
    angle = 2.0 * np.pi * frequency_Hz * local
    cos, sin, x = np.cos(angle), np.sin(angle), local / local[-1]
    columns = np.stack([cos, sin, x * cos, x * sin, np.ones(width), x], axis=1)
    root = np.sqrt(taper)[:, None]
    solver = (np.linalg.pinv(columns * root) * root.T).T
    found = in_frames(velocity, solver, step)
    power = in_frames(velocity**2, taper[:, None], step)[:, 0]
    gram = (columns * taper[:, None]).T @ columns
    explained = ((found @ gram) * found).sum(axis=1)
    time = (np.arange(power.size) * step + 0.5 * (width - 1)) / sampling_Hz
    turn = 2.0 * np.pi * np.mod(frequency_Hz * time, 1.0)
    amplitude = np.maximum(np.hypot(found[:, 0], found[:, 1]), 1e-300)
    phase = np.unwrap(np.arctan2(-found[:, 1], found[:, 0]) - turn)
    return Envelope(
        time=time,
        log=np.log(amplitude) + 1j * phase,
        rest=np.sqrt(np.maximum(power - explained, 0.0)),
        mean=found[:, 4],
        frequency_Hz=frequency_Hz,
        step_s=step / sampling_Hz,
        frame_s=width / sampling_Hz,
    )
