"""A mode followed roughly: its blocks, their spline, frames for it, and what it leaves over."""

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray

from bladeroot.decay.other_lines import remainder
from bladeroot.signal.carrier import rough_phasors
from bladeroot.signal.phasors import Phasors, Stretch
from bladeroot.signal.scatter import noise_ratio
from bladeroot.signal.smooth import Spline, coarse


def parts(log: Complex[ndarray, " block"]) -> Float[ndarray, "2 block"]:
    """Log-amplitude and phase, as the splines want them."""
    return np.stack([log.real, log.imag])


def roughly(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    line_Hz: float,
    noise: float,
    usable: Bool[ndarray, " sample"] | None,
) -> tuple[Phasors, Spline, list[Stretch], Float[ndarray, " sample"]]:
    """Rough blocks of the mode near a line, their spline, its frames, and what it leaves over."""
    blocks, phase = rough_phasors(velocity, sampling_Hz, line_Hz, noise, usable)
    scatter = noise_ratio(np.stack([blocks.log.real, phase]), blocks.std)
    std = blocks.std * np.maximum(scatter, 0.1)
    duration = velocity.size / sampling_Hz
    fit = coarse(blocks.time, parts(blocks.log), std, duration, knots=32, iterations=2)
    stretches = cut_frames(fit, blocks, velocity.size, sampling_Hz, 1)
    middle = np.concatenate([_middles(one, sampling_Hz) for one in stretches])
    value = fit.value(np.minimum(middle, blocks.time[-1]))
    log = value[:, 0] + 1j * value[:, 1]
    log[0, middle > blocks.time[-1]] = -np.inf
    rest = remainder(velocity, sampling_Hz, stretches, log)
    if usable is not None:
        rest = np.where(usable, rest, 0.0)
    return blocks, fit, stretches, rest


def cut_frames(
    fit: Spline, blocks: Phasors, samples: int, sampling_Hz: float, cycles: int
) -> list[Stretch]:
    """The record cut into frames of whole cycles, anew where the frequency has moved."""
    grid = np.linspace(blocks.time[0], blocks.time[-1], min(100, max(8, blocks.time.size)))
    omega = fit.value(grid)[1, 1]
    # where the mode is lost its phase may stand still or even turn back
    omega = np.clip(omega, 0.5 * np.median(omega), 2.0 * np.median(omega))
    step = 0.02 / cycles
    class_ = np.round(np.log(omega / np.median(omega)) / step)
    change = np.flatnonzero(np.diff(class_)) + 1
    found: list[Stretch] = []
    first = 0
    starts = np.concatenate([[0], change])
    ends = np.concatenate([grid[change] * sampling_Hz, [samples]])
    for start, end in zip(starts, ends, strict=True):
        angle = float(np.median(omega) * np.exp(class_[start] * step)) / sampling_Hz
        length = max(round(cycles * 2.0 * np.pi / angle), 8)
        frames = int(min(end, samples) - first) // length
        if frames > 0:
            found.append(Stretch(first, length, frames, angle))
            first += frames * length
    return found


def _middles(stretch: Stretch, sampling_Hz: float) -> Float[ndarray, " frame"]:
    middle = stretch.first + 0.5 * (stretch.length - 1)
    return (middle + np.arange(stretch.frames) * stretch.length) / sampling_Hz
