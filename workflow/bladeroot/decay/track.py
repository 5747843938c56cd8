"""Follow one mode through a record, other modes fitted along with it."""

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray

from bladeroot.decay.close_modes import (
    CLOSE,
    SPOILT_BEATS,
    near_waves,
    quieter_s,
    widened,
    within,
)
from bladeroot.decay.other_lines import find_lines
from bladeroot.decay.rough import cut_frames, parts, roughly
from bladeroot.signal.carrier import strongest_line
from bladeroot.signal.phasors import (
    Frames,
    Phasors,
    corrected,
    fit_frames,
    gather,
    refined,
    unleaked,
)
from bladeroot.signal.scatter import noise_ratio, without_knocks
from bladeroot.signal.smooth import Spline, coarse, fine

# Of what was taken off before: times (s), factor of a phasor's standard error, and one to add.
Taken = tuple[Float[ndarray, " knot"], Float[ndarray, " knot"], Float[ndarray, " knot"]]
# A first block belongs to the blow where ln A + i phase bends so many times more than after it.
STRUCK = 8.0
# Most cycles in a frame.
LONGEST = 4


def follow(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    band_Hz: tuple[float, float],
    noise: float,
    usable: Bool[ndarray, " sample"] | None = None,
    widening: Taken | None = None,
) -> tuple[Phasors, Spline, list[float]]:
    """Block log-phasors of the strongest mode in a band, their spline, and the other lines."""
    duration = velocity.size / sampling_Hz
    line_Hz = strongest_line(velocity, sampling_Hz, *band_Hz)
    blocks, fit, stretches, rest = roughly(velocity, sampling_Hz, line_Hz, noise, usable)
    stop = int(blocks.time[-1] * sampling_Hz)
    rest = rest[:stop] if usable is None else _longest(rest[:stop], usable[:stop])
    value = fit.value(blocks.time)
    swept = np.quantile(value[1, 1], (0.02, 0.98)) / (2.0 * np.pi)
    own_Hz = (float(swept[0]), float(swept[1]))
    over = _taken_over(rest, sampling_Hz, blocks, value[1, 1])
    if over is not None:
        usable = None if usable is None else usable[:over]
        return follow(velocity[:over], sampling_Hz, band_Hz, noise, usable, widening)
    found = find_lines(rest, sampling_Hz, own_Hz, float(np.exp(value[0, 0].max())))
    others = [other for other in found if _apart(other, own_Hz)]
    near = [other for other in found if not _apart(other, own_Hz)]
    first_s, last_s, beat_s = 0.0, duration, 0.0
    if near:
        waves = near_waves(velocity, sampling_Hz, line_Hz, near, noise, usable)
        velocity = velocity - sum(waves)
        blocks, fit, stretches, _ = roughly(velocity, sampling_Hz, line_Hz, noise, usable)
        gaps = {k: abs(other - line_Hz) for k, other in enumerate(near)}
        close = [k for k, gap in gaps.items() if gap < CLOSE * line_Hz]
        if close:
            beat_s = 1.0 / min(gaps[k] for k in close)
            spoilt_s = SPOILT_BEATS * beat_s
            taken = sum(waves[k] for k in close)
            first_s, last_s = quieter_s(taken, sampling_Hz, fit, beat_s)
            first_s, last_s = first_s + spoilt_s, last_s - spoilt_s
    cycles = _cycles(others, line_Hz, duration)
    if cycles > 1:
        stretches = cut_frames(fit, blocks, velocity.size, sampling_Hz, cycles)
    rates = [2j * np.pi * other for other in others]
    frames = fit_frames(velocity, sampling_Hz, noise, stretches, rates, usable)
    if others:
        rates = refined(rates, frames)
        frames = fit_frames(velocity, sampling_Hz, noise, stretches, rates, usable)
        _, rate, change = _logs(fit, np.clip(frames.time, blocks.time[0], blocks.time[-1]))
        frames = unleaked(frames, rates, rate, change)
    blocks = _gathered(frames, blocks, fit, widening)
    before, fit = fit, coarse(blocks.time, parts(blocks.log), blocks.std, duration, fit.prior)
    for _ in range(3):
        if _as_known(blocks, before, fit):
            break
        before, blocks = fit, _gathered(frames, blocks, fit, widening)
        fit = fine(blocks.time, parts(blocks.log), blocks.std, fit)
    # V = lambda Y: a kink in the displacement's decline is a step in the velocity's, so it is
    # the displacement that is smoothed
    _, rate, change = _logs(fit, blocks.time)
    blocks = Phasors(blocks.time, blocks.log - np.log(rate - change / rate), blocks.std)
    fit = fine(blocks.time, parts(blocks.log), blocks.std, fit)
    if beat_s:
        blocks, fit = widened(blocks, fit, beat_s)
    return within(blocks, first_s, last_s), fit, found


def _logs(fit: Spline, time: Float[ndarray, " at"]) -> Complex[ndarray, "3 at"]:
    """The log-phasor and its first two derivatives."""
    value = fit.value(time)
    return value[:, 0] + 1j * value[:, 1]


def _taken_over(
    rest: Float[ndarray, " sample"],
    sampling_Hz: float,
    blocks: Phasors,
    omega: Float[ndarray, " block"],
    wide: float = 0.05,
    loud: float = 0.1,
) -> int | None:
    """The sample where the rough phasors go over to a line that outlives the mode, if they do.

    The mode's own frequencies are then those of its loud part; the other line rings before, too.
    """
    amplitude = np.exp(blocks.log.real)
    weak = np.flatnonzero(amplitude < loud * amplitude[: amplitude.size // 4 + 1].max())
    if not weak.size:
        return None
    own = np.quantile(omega[: weak[0] + 1], (0.02, 0.98)) / (2.0 * np.pi)
    own_Hz = (float(own[0]), float(own[1]))
    frequency = omega / (2.0 * np.pi)
    away = (frequency < own_Hz[0] * (1.0 - wide)) | (frequency > own_Hz[1] * (1.0 + wide))
    gone = weak[0] + np.flatnonzero(away[weak[0] :])
    if not gone.size:
        return None
    until = int(blocks.time[gone[0]] * sampling_Hz)
    lines = find_lines(rest[:until], sampling_Hz, own_Hz, float(amplitude.max()))
    low, high = frequency[gone].min() * (1.0 - wide), frequency[gone].max() * (1.0 + wide)
    if not any(low < line < high for line in lines):
        return None
    return until


def _longest(
    rest: Float[ndarray, " sample"], usable: Bool[ndarray, " sample"]
) -> Float[ndarray, " part"]:
    """The longest usable stretch where there are many holes: at every peak they look like lines.

    The whole where the holes are few, or where that leaves less than a quarter.
    """
    starts = np.flatnonzero(np.diff(usable.astype(int), prepend=1, append=1) > 0)
    if starts.size < 10:
        return rest
    edges = np.concatenate([[-1], np.flatnonzero(~usable), [rest.size]])
    longest = int(np.argmax(np.diff(edges)))
    part = rest[edges[longest] + 1 : edges[longest + 1]]
    return part if part.size > 0.25 * rest.size else rest


def _apart(other_Hz: float, own_Hz: tuple[float, float], cycles: float = 3.0) -> bool:
    """Whether frames of some cycles tell another line from the mode, and from a mean."""
    gap = max(own_Hz[0] - other_Hz, other_Hz - own_Hz[1])
    return min(gap, other_Hz) * cycles > 0.9 * own_Hz[1]


def _gathered(
    frames: Frames,
    known: Phasors,
    fit: Spline,
    widening: Taken | None,
) -> Phasors:
    """Blocks of the frames, freed of what the mode does within them, with errors as they scatter.

    known: blocks to which the spline `fit` reaches; beyond them it goes on as a straight line.
    """
    # not far beyond: a straight line soon says nothing about a mode that was lost
    reach = known.time[-1] + 0.05 * (known.time[-1] - known.time[0])
    near = slice(0, int(np.searchsorted(frames.time, reach)))
    time = frames.time[near]
    inside = np.clip(time, known.time[0], known.time[-1])
    log = _logs(fit, inside)
    guess = log[0] + log[1] * (time - inside)
    phasor = corrected(frames, near, log[1], log[2])
    blocks, miss = gather(time, phasor, frames.std[near], guess)
    # lost, where it is weak and half of the blocks ahead do not follow what is known
    astray = (np.abs(miss) > np.maximum(5.0 * blocks.std, 0.3)) & (blocks.std > 0.03)
    lost = np.flatnonzero(astray & (np.convolve(astray, np.full(8, 0.125))[7:] >= 0.5))
    if lost.size:
        part = slice(0, int(lost[0]))
        blocks, miss = Phasors(blocks.time[part], blocks.log[part], blocks.std[part]), miss[part]
    if blocks.time.size < 8:
        raise ValueError(f"expected 8 blocks of cycles above the noise, got {blocks.time.size}")
    off = parts(miss)
    std = blocks.std * np.maximum(noise_ratio(off, blocks.std), 0.1)
    if widening is not None:
        time, factor, doubt = widening
        std = np.hypot(
            std * np.interp(blocks.time, time, factor), np.interp(blocks.time, time, doubt)
        )
    # a clock and a digitiser are never better than a millionth of a radian
    std = np.hypot(std, 1e-6)
    doubted = without_knocks(off, std)
    free = slice(_struck(blocks.log), _shaped(doubted > std))
    return Phasors(blocks.time[free], blocks.log[free], doubted[free])


def _struck(log: Complex[ndarray, " block"], most: int = 3, reach: int = 5) -> int:
    """Number of first blocks in which what a blow set going still rings; a spline would follow.

    There the log-phasor bends far more than anywhere in the blocks after it.
    """
    bend = np.abs(np.diff(log[: most + reach + 2], n=2))
    for first in range(min(most, bend.size - reach)):
        if bend[first] < STRUCK * bend[first + 1 : first + 1 + reach].max():
            return first
    return most if bend.size == most + reach else 0


def _shaped(knocked: Bool[ndarray, " block"], reach: int = 9, gap: int = 4) -> int:
    """Number of blocks before the transient that a filter leaves at a record's end.

    Two of the last blocks are then thrown off. It grows towards the end, so it is taken to
    begin as far again before the first of those. One that the curve can follow is not seen.
    """
    at = np.flatnonzero(knocked)
    if np.count_nonzero(knocked[-reach:]) < 2:
        return knocked.size
    far = np.flatnonzero(np.diff(at) > gap)
    first = 2 * int(at[far[-1] + 1 if far.size else 0]) - knocked.size
    return first if first > 0.75 * knocked.size else knocked.size


def _as_known(blocks: Phasors, before: Spline, now: Spline) -> bool:
    """Whether growth and chirp within frames were known well enough when the blocks were made.

    A cycle's fit answers to a wrong rate with about that over twice the frequency.
    """
    rate = now.value(blocks.time)[1]
    change = np.abs(before.value(blocks.time)[1] - rate).max(axis=0) / (2.0 * rate[1])
    return bool((change < 0.5 * blocks.std).all())


def _cycles(others: list[float], line_Hz: float, duration: float) -> int:
    """Cycles in a frame: enough to tell the mode from other lines and these from a mean.

    And the other lines from one another, while frames remain plenty.
    """
    plenty = int(np.clip(duration * line_Hz / 150.0, 1, LONGEST))
    for cycles in range(1, LONGEST + 1):
        frame = cycles / line_Hz
        own = min((abs(line - b) * frame for line in others for b in (line_Hz, 0.0)), default=1.0)
        lines = [*others, line_Hz, 0.0]
        every = min(abs(a - b) * frame for k, a in enumerate(lines) for b in lines[:k])
        if every > 0.9 or (own > 0.75 and cycles >= plenty):
            return cycles
    return LONGEST
