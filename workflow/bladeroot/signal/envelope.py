"""A mode in overlapping tapered frames: its log-phasor, and what the frames hold besides it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.signal.lines import hann

# A frame moves on by half a cycle of the mode.
FRAME_STEPS = 6  # half cycles in it: Hann-weighted, the second mode near twice the first stays out
FEWEST_FRAME_SAMPLES = 10  # it is longer where it would hold fewer, for its six unknowns


@dataclass(frozen=True)
class Tapered:
    """Hann-weighted least squares in each of some frames, `width` samples that begin every `step`.

    Columns of `design` are the cosine and the sine of a frequency, both times x (time over half a
    frame's length), 1, x, and then the cosine and the sine of other lines: a component that grows
    and drifts in a frame beside a mean and a trend. Time counts from a frame's middle, `centre` (in
    samples). `solver` makes the coefficients from samples; `taper` sums to one; `cycles` of the
    frequency have passed at the centre.
    """

    centre: Float[ndarray, " frame"]
    coefficient: Float[ndarray, "frame column"]
    design: Float[ndarray, "width column"]
    solver: Float[ndarray, "column width"]
    taper: Float[ndarray, " width"]
    cycles: Float[ndarray, " frame"]

    @property
    def log(self) -> Complex[ndarray, " frame"]:
        """ln(amplitude) + i phase, unwrapped and taken against the frequency."""
        phasor = self.coefficient[:, 0] - 1j * self.coefficient[:, 1]
        turn = 2.0 * np.pi * np.mod(self.cycles, 1.0)
        return np.log(np.maximum(np.abs(phasor), 1e-300)) + 1j * np.unwrap(np.angle(phasor) - turn)


def tapered(
    x: Float[ndarray, " sample"],
    sampling_Hz: float,
    frequency_Hz: float,
    step: int,
    width: int,
    lines_Hz: tuple[float, ...] = (),
) -> Tapered:
    """The component at a frequency, frame by frame; `width` is a whole number of steps."""
    local = (np.arange(width) - 0.5 * (width - 1)) / sampling_Hz
    ramp = local / local[-1]
    waves = [
        wave(2.0 * np.pi * one * local)
        for one in (frequency_Hz, *lines_Hz)
        for wave in (np.cos, np.sin)
    ]
    own = [*waves[:2], ramp * waves[0], ramp * waves[1], np.ones(width), ramp]
    design = np.stack([*own, *waves[2:]], axis=1)
    taper = hann(width)
    root = np.sqrt(taper)
    solver = np.linalg.pinv(design * root[:, None]) * root
    found = in_frames(x, solver.T, step)
    centre = np.arange(len(found)) * step + 0.5 * (width - 1)
    cycles = frequency_Hz * (centre / sampling_Hz)
    return Tapered(centre, found, design, solver, taper / taper.sum(), cycles)


def in_frames(
    x: Float[ndarray, " sample"], weights: Float[ndarray, "width column"], step: int
) -> Float[ndarray, "frame column"]:
    """Weighted sums of frames that begin every `step` samples, whose width is some steps.

    Each step's samples are multiplied once with each part of the weights, without copies.
    """
    columns = weights.shape[1]
    parts = weights.reshape(-1, step, columns)
    each = x[: x.size // step * step].reshape(-1, step) @ np.hstack(parts)
    count = len(each) - len(parts) + 1
    return sum(each[k : k + count, columns * k : columns * (k + 1)] for k in range(len(parts)))


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
    """Log-phasor of the component at a frequency, every half cycle, and what remains without it.

    Frames do not reach beyond the record, so a decay that starts at the first sample shows its
    full height there. Time and memory grow linearly with the record.
    """
    step = max(1, round(0.5 * sampling_Hz / frequency_Hz))
    width = max(FRAME_STEPS, -(-FEWEST_FRAME_SAMPLES // step)) * step
    if velocity.size < width:
        raise ValueError(f"expected at least {width} samples, got {velocity.size}")
    found = tapered(velocity, sampling_Hz, frequency_Hz, step, width)
    power = in_frames(velocity**2, found.taper[:, None], step)[:, 0]
    gram = (found.design * found.taper[:, None]).T @ found.design
    explained = ((found.coefficient @ gram) * found.coefficient).sum(axis=1)
    return Envelope(
        time=found.centre / sampling_Hz,
        log=found.log,
        rest=np.sqrt(np.maximum(power - explained, 0.0)),
        mean=found.coefficient[:, 4],
        frequency_Hz=frequency_Hz,
        step_s=step / sampling_Hz,
        frame_s=width / sampling_Hz,
    )
