"""Follow one mode through a record, other modes fitted along with it."""

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray

from bladeroot.decay.carrier import rough_phasors, strongest_line
from bladeroot.decay.lines import find_lines, remainder
from bladeroot.decay.phasors import Frames, Phasors, Stretch, corrected, fit_frames, gather, refined
from bladeroot.decay.scatter import noise_ratio
from bladeroot.decay.smooth import Spline, coarse, fine


def follow(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    band_Hz: tuple[float, float],
    noise: float,
    usable: Bool[ndarray, " sample"] | None = None,
) -> tuple[Phasors, Spline, list[float]]:
    """Block log-phasors of the strongest mode in a band, their spline, and the other lines."""
    duration = velocity.size / sampling_Hz
    line_Hz = strongest_line(velocity, sampling_Hz, *band_Hz)
    blocks = rough_phasors(velocity, sampling_Hz, line_Hz, noise, usable)
    fit = _rough_fit(blocks, duration)
    stretches = cut_frames(fit, blocks, velocity.size, sampling_Hz, 1)
    middles = np.concatenate([_middles(one, sampling_Hz) for one in stretches])
    value = fit.value(np.minimum(middles, blocks.time[-1]))
    rest = remainder(velocity, sampling_Hz, stretches, value[:, 0] + 1j * value[:, 1])
    if usable is not None:
        rest = np.where(usable, rest, 0.0)
    stop = int(blocks.time[-1] * sampling_Hz)
    strength = float(np.exp(value[0, 0].max()))
    swept = value[1, 1] / (2.0 * np.pi)
    own_Hz = (float(swept.min()), float(swept.max()))
    others = find_lines(rest[:stop], sampling_Hz, own_Hz, strength)
    cycles = _cycles(others, line_Hz, duration)
    if cycles > 1:
        stretches = cut_frames(fit, blocks, velocity.size, sampling_Hz, cycles)
    rates = [2j * np.pi * other for other in others]
    frames = fit_frames(velocity, sampling_Hz, noise, stretches, rates, usable)
    if others:
        rates = refined(rates, frames)
        frames = fit_frames(velocity, sampling_Hz, noise, stretches, rates, usable)
    blocks = _gathered(frames, blocks, fit)
    fit = coarse(blocks.time, _parts(blocks.log), blocks.std, duration, fit.prior)
    blocks = _gathered(frames, blocks, fit)
    # V = lambda Y: a kink in the displacement's decline is a step in the velocity's, so it is
    # the displacement that is smoothed
    value = fit.value(blocks.time)
    rate, change = value[1, 0] + 1j * value[1, 1], value[2, 0] + 1j * value[2, 1]
    blocks = Phasors(blocks.time, blocks.log - np.log(rate - change / rate), blocks.std)
    return blocks, fine(blocks.time, _parts(blocks.log), blocks.std, fit), others


def _gathered(frames: Frames, known: Phasors, fit: Spline) -> Phasors:
    """Blocks of the frames, freed of what the mode does within them, with errors as they scatter.

    known: blocks to which the spline `fit` reaches; beyond them it goes on as a straight line.
    """
    # not far beyond: a straight line soon says nothing about a mode that was lost
    reach = known.time[-1] + 0.05 * (known.time[-1] - known.time[0])
    near = slice(0, int(np.searchsorted(frames.time, reach)))
    time = frames.time[near]
    inside = np.clip(time, known.time[0], known.time[-1])
    value = fit.value(inside)
    log = value[:, 0] + 1j * value[:, 1]
    guess = log[0] + log[1] * (time - inside)
    phasor = corrected(frames, near, log[1], log[2])
    blocks, miss = gather(time, phasor, frames.std[near], guess)
    if blocks.time.size < 8:
        raise ValueError(f"expected 8 blocks of cycles above the noise, got {blocks.time.size}")
    std = blocks.std * np.maximum(noise_ratio(_parts(miss), blocks.std), 0.5)
    # a clock and a digitiser are never better than a millionth of a radian
    return Phasors(blocks.time, blocks.log, np.hypot(std, 1e-6))


def _parts(log: Complex[ndarray, " block"]) -> Float[ndarray, "2 block"]:
    return np.stack([log.real, log.imag])


def _rough_fit(blocks: Phasors, duration: float) -> Spline:
    y = _parts(blocks.log)
    std = blocks.std * np.maximum(noise_ratio(y, blocks.std), 0.5)
    return coarse(blocks.time, y, std, duration, knots=36, iterations=2)


def cut_frames(
    fit: Spline, blocks: Phasors, samples: int, sampling_Hz: float, cycles: int
) -> list[Stretch]:
    """The record cut into frames of whole cycles, anew where the frequency has moved."""
    grid = np.linspace(blocks.time[0], blocks.time[-1], min(100, max(8, blocks.time.size)))
    omega = fit.value(grid)[1, 1]
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


def _cycles(others: list[float], line_Hz: float, duration: float) -> int:
    """Cycles in a frame: enough to tell the other lines apart, while frames remain plenty."""
    most = int(np.clip(duration * line_Hz / 150.0, 1, 8))
    for cycles in range(1, most + 1):
        frame = cycles / line_Hz
        lines = [*others, line_Hz, 0.0]
        apart = [abs(a - b) * frame for k, a in enumerate(lines) for b in lines[:k]]
        if min(apart) > 0.9:
            return cycles
    return most
