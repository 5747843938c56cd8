"""Follow one mode through a record that holds no other.

A rough log-phasor tells where its cycles lie and how fast it decays (`rough_phasors`); frames
of whole cycles are then fitted anew until what the mode does within them is known (`follow`), with
errors as the blocks scatter (`noise_ratio`, `without_knocks`, and `decay.shaken` for noise that is
alike in many of them).
"""

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray

from bladeroot.decay.shaken import shaken
from bladeroot.signal.phasors import FrameGrid, Frames, Phasors, corrected, fit_frames, gather
from bladeroot.signal.smooth import Spline, coarse, fine

# What was taken off before adds to a phasor's standard error: at times (s) a factor, then a term
# that is added in squares.
Taken = tuple[Float[ndarray, " knot"], Float[ndarray, " knot"], Float[ndarray, " knot"]]
FEWEST_BLOCKS = 5  # blocks, or cycles, that a curve needs
RECUT_CHANGE = 0.02  # of ln frequency, at which frames are cut anew: a cycle stays whole to 1 %
# The blocks' scatter over their stated errors (`noise_ratio`).
MOST_WINDOWS = 12  # along a record, each with a ratio of its own
WINDOW_BLOCKS = 80  # in a window at least, unless there are fewer in all
_CUT_ERRORS = 2.5  # standard errors to which larger values are cut, against knocks
_CUT_MEAN = 0.9765  # mean square of standard normal values that are cut so
LEAST_NOISE_RATIO = 0.1  # a smaller ratio is not believed
LEAST_ERROR = 1e-6  # rad, added in squares: no clock or digitiser is better
# The mode is lost at the first block that is astray together with half of those ahead. Astray is a
# weak block whose log-phasor lies far off what is known.
LOST_BLOCKS = 8  # that are looked at, from the block itself on
LOST_ERRORS = 5.0  # standard errors that it lies off at least, and
LOST_RADIANS = 0.3  # rad of phase, or of ln A, that it lies off at least
DOUBTED_ERROR = 0.03  # rad: a block with a smaller standard error is never astray
# A knock lies far off the straight line through its neighbours (`without_knocks`).
KNOCK_ERRORS = 6.0  # standard errors off
KNOCK_WINDOW = 9  # blocks that the line goes through, the knock among them


def follow(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    line_Hz: float,
    noise: float,
    usable: Bool[ndarray, " sample"] | None = None,
    taken: Taken | None = None,
    least_ratio: float = LEAST_NOISE_RATIO,
) -> tuple[Phasors, Spline]:
    """Block log-phasors of the mode near a line, and their spline.

    least_ratio: of the blocks' scatter over that of `noise`; a smaller one is not believed.
    """
    blocks, fit = _roughly(velocity, sampling_Hz, line_Hz, noise, usable)
    segments = _cut_frames(fit, blocks, velocity.size, sampling_Hz)
    frames = fit_frames(velocity, sampling_Hz, noise, segments, usable)
    blocks = _gathered(frames, blocks, fit, taken, least_ratio)
    duration = velocity.size / sampling_Hz
    before, fit = fit, coarse(blocks.time, blocks.rows, blocks.std, duration, fit.prior)
    for _ in range(3):
        if _as_known(blocks, before, fit):
            break
        before, blocks = fit, _gathered(frames, blocks, fit, taken, least_ratio)
        fit = fine(blocks.time, blocks.rows, blocks.std, fit)
    # velocity V = lambda Y: a kink in ln of the displacement Y is a step in ln V, so Y is smoothed
    _, rate, change = _logs(fit, blocks.time)
    blocks = Phasors(blocks.time, blocks.log - np.log(rate - change / rate), blocks.std)
    fit = fine(blocks.time, blocks.rows, blocks.std, fit)
    found = shaken(blocks, fit)
    if found is None or found[0].size < FEWEST_BLOCKS:
        return blocks, fit
    std, walk = found
    blocks = blocks.first(std.size)
    return blocks, coarse(blocks.time, blocks.rows, std, duration, iterations=6, walk=walk)


def _roughly(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    line_Hz: float,
    noise: float,
    usable: Bool[ndarray, " sample"] | None,
) -> tuple[Phasors, Spline]:
    """Rough blocks of the mode near a line, and their spline."""
    blocks, phase = rough_phasors(velocity, sampling_Hz, line_Hz, noise, usable)
    scatter = noise_ratio(np.stack([blocks.log.real, phase]), blocks.std)
    std = blocks.std * np.maximum(scatter, LEAST_NOISE_RATIO)
    duration = velocity.size / sampling_Hz
    return blocks, coarse(blocks.time, blocks.rows, std, duration, knots=32, iterations=2)


def _cut_frames(fit: Spline, blocks: Phasors, samples: int, sampling_Hz: float) -> list[FrameGrid]:
    """The record cut into frames of a cycle, anew where the frequency has moved."""
    grid = np.linspace(blocks.time[0], blocks.time[-1], min(100, max(8, blocks.time.size)))
    omega = fit.value(grid)[1, 1]
    # where the mode is lost its phase may stand still or even turn back
    omega = np.clip(omega, 0.5 * np.median(omega), 2.0 * np.median(omega))
    class_ = np.round(np.log(omega / np.median(omega)) / RECUT_CHANGE)
    change = np.flatnonzero(np.diff(class_)) + 1
    found: list[FrameGrid] = []
    first = 0
    starts = np.concatenate([[0], change])
    ends = np.concatenate([grid[change] * sampling_Hz, [samples]])
    for start, end in zip(starts, ends, strict=True):
        angle = float(np.median(omega) * np.exp(class_[start] * RECUT_CHANGE)) / sampling_Hz
        length = max(round(2.0 * np.pi / angle), 8)
        frames = int(min(end, samples) - first) // length
        if frames > 0:
            found.append(FrameGrid(first, length, frames, angle))
            first += frames * length
    return found


def _logs(fit: Spline, time: Float[ndarray, " at"]) -> Complex[ndarray, "3 at"]:
    """The log-phasor and its first two derivatives."""
    value = fit.value(time)
    return value[:, 0] + 1j * value[:, 1]


def _gathered(
    frames: Frames,
    known: Phasors,
    fit: Spline,
    taken: Taken | None,
    least_ratio: float,
) -> Phasors:
    """Blocks of the frames, freed of what the mode does within them, with errors as they scatter.

    known: blocks to which the spline `fit` reaches; beyond them it goes on as a straight line.
    """
    # not far beyond: a straight line soon tells nothing about a mode that was lost
    reach = known.time[-1] + 0.05 * (known.time[-1] - known.time[0])
    near = slice(0, int(np.searchsorted(frames.time, reach)))
    time = frames.time[near]
    inside = np.clip(time, known.time[0], known.time[-1])
    log = _logs(fit, inside)
    guess = log[0] + log[1] * (time - inside)
    phasor = corrected(frames, near, log[1], log[2])
    blocks, miss = gather(time, phasor, frames.std[near], guess)
    # lost, where it is weak and half of the blocks ahead do not follow what is known
    astray = (np.abs(miss) > np.maximum(LOST_ERRORS * blocks.std, LOST_RADIANS)) & (
        blocks.std > DOUBTED_ERROR
    )
    lost = np.flatnonzero(
        astray
        & (
            np.convolve(np.append(astray, False), np.ones(LOST_BLOCKS))[LOST_BLOCKS - 1 : -1]
            >= 0.5 * LOST_BLOCKS
        )
    )
    if lost.size:
        blocks, miss = blocks.first(int(lost[0])), miss[: lost[0]]
    if blocks.time.size < FEWEST_BLOCKS:
        raise ValueError(
            f"expected {FEWEST_BLOCKS} blocks of cycles above the noise, got {blocks.time.size}"
        )
    off = np.stack([miss.real, miss.imag])
    std = blocks.std * np.maximum(noise_ratio(off, blocks.std), least_ratio)
    if taken is not None and taken[0].size:
        time, factor, doubt = taken
        std = np.hypot(
            std * np.interp(blocks.time, time, factor), np.interp(blocks.time, time, doubt)
        )
    std = np.hypot(std, LEAST_ERROR)
    return Phasors(blocks.time, blocks.log, without_knocks(off, std))


def _as_known(blocks: Phasors, before: Spline, now: Spline) -> bool:
    """Whether growth and chirp within frames were known well enough when the blocks were made.

    A cycle's fit answers to a wrong rate with about that over twice the frequency.
    """
    rate = now.value(blocks.time)[1]
    change = np.abs(before.value(blocks.time)[1] - rate).max(axis=0) / (2.0 * rate[1])
    return bool((change < 0.5 * blocks.std).all())


def noise_ratio(
    values: Float[ndarray, "part block"],
    std: Float[ndarray, " block"],
) -> Float[ndarray, " block"]:
    """Observed over assumed standard error of the blocks, running along the record.

    From second differences of the blocks, or of the residuals of a smooth curve: noise near the
    mode that is not that of the full band, remains of other modes and a wrong noise level all show
    here. There are at most `MOST_WINDOWS` windows, of at least `WINDOW_BLOCKS` blocks, since a
    scatter known too roughly spoils every standard error that rests on it. Knocks are cut off.
    """
    count = std.size - 2
    if count < 10:
        return np.ones(std.size)
    variance = std[2:] ** 2 + 4.0 * std[1:-1] ** 2 + std[:-2] ** 2
    square = np.diff(values, 2, axis=1) ** 2 / variance
    windows = int(np.clip(count // WINDOW_BLOCKS, 1, MOST_WINDOWS))
    length = count // windows
    near = square[:, : windows * length].reshape(-1, windows, length)
    near = near.transpose(1, 0, 2).reshape(windows, -1)
    mean = np.median(near, axis=1, keepdims=True) / 0.4549
    for _ in range(3):
        mean = np.minimum(near, _CUT_ERRORS**2 * mean).mean(axis=1, keepdims=True) / _CUT_MEAN
    centre = (np.arange(windows) + 0.5) * length + 0.5
    return np.sqrt(np.interp(np.arange(std.size), centre, mean[:, 0]))


def without_knocks(
    miss: Float[ndarray, "part block"],
    std: Float[ndarray, " block"],
) -> Float[ndarray, " block"]:
    """Larger standard errors for the few blocks that a knock or a glitch threw off.

    miss: residuals of a smooth curve. Such a block lies far from the straight line through its
    neighbours' residuals (by medians). At the ends the window shifts inwards.
    """
    count = std.size
    jump = np.abs(np.diff(miss, 2, axis=1)).max(axis=0) / np.sqrt(6.0)
    if count < 2 * KNOCK_WINDOW or not (jump > KNOCK_ERRORS * std[1:-1]).any():
        return std
    own = np.arange(count)
    start = np.clip(own - KNOCK_WINDOW // 2, 0, count - KNOCK_WINDOW)
    near = miss[:, start[:, None] + np.arange(KNOCK_WINDOW)]
    slope = np.median(np.diff(near, axis=2), axis=2)
    level = np.median(near - slope[:, :, None] * np.arange(KNOCK_WINDOW), axis=2)
    off = np.abs(miss - level - slope * (own - start)).max(axis=0)
    return np.where(off > KNOCK_ERRORS * std, np.maximum(off, std), std)


def rough_phasors(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    line_Hz: float,
    noise: float,
    usable: Bool[ndarray, " sample"] | None = None,
) -> tuple[Phasors, Float[ndarray, " block"]]:
    """Log-phasors of blocks of the mode near a frequency, good to some per cent of a radian.

    Also returns their phases less a smoothed advance, in which their scatter shows.

    Raises ValueError where fewer than five cycles can be followed.
    """
    cycle = sampling_Hz / line_Hz
    length = round(np.ceil(12.0 / cycle) * cycle)  # enough samples for the fit's three columns
    count = velocity.size // length
    if count < FEWEST_BLOCKS:
        raise ValueError(
            f"expected at least {FEWEST_BLOCKS * length / cycle:.3g} cycles near {line_Hz:.4g} Hz "
            f"to follow the mode, got {velocity.size / cycle:.3g}"
        )
    angle = 2.0 * np.pi * line_Hz / sampling_Hz
    frames = fit_frames(velocity, sampling_Hz, noise, [FrameGrid(0, length, count, angle)], usable)
    if frames.time.size < FEWEST_BLOCKS:
        raise ValueError(
            f"expected at least {FEWEST_BLOCKS} usable cycles near {line_Hz:.4g} Hz, "
            f"got {frames.time.size}"
        )
    turn = _turning(frames)
    still = frames.phasor * np.exp(-1j * turn)
    envelope, last = _envelope(frames, still)
    level = np.log(np.maximum(envelope, 1e-3 * frames.std))
    blocks, miss = gather(
        frames.time[:last], frames.phasor[:last], frames.std[:last], (level + 1j * turn)[:last]
    )
    if blocks.time.size < FEWEST_BLOCKS:
        raise ValueError(
            f"expected at least {FEWEST_BLOCKS} cycles near {line_Hz:.4g} Hz above the noise, got "
            f"{blocks.time.size}"
        )
    return blocks, miss.imag


def _turning(frames: Frames) -> Float[ndarray, " frame"]:
    """The phase, as the sum of the smoothed advances from frame to frame."""
    base = frames.phasor * np.exp(-1j * frames.omega * frames.time)
    step = np.diff(frames.time)
    advance = base[1:] * base[:-1].conj()
    advance[step > 1.5 * step.min()] = 0.0  # across a gap the advance is ambiguous
    detune = np.angle(_moving_sum(advance, int(np.clip(step.size // 100, 1, 10)))) / step.min()
    turn = np.concatenate([[0.0], np.cumsum(detune * step)])
    return turn + frames.omega * frames.time


def _envelope(frames: Frames, still: ndarray) -> tuple[Float[ndarray, " frame"], int]:
    """Amplitude of the frames, averaged over more of them where it is weak; where it drowns."""
    found, last = np.abs(still), still.size
    for reach in (2, 8, 32):
        weak = found < 6.0 * frames.std
        if 4 * reach > found.size or not weak.any():
            break
        count = _moving_sum(np.ones(found.size), reach)
        wider = np.abs(_moving_sum(still, reach)) / count
        drowned = np.flatnonzero(weak & (wider < 3.0 * frames.std / np.sqrt(count)))
        last = int(drowned[0]) if drowned.size else still.size
        found = np.where(weak, wider, found)
    return found, max(last, min(8, still.size))


def _moving_sum(values: ndarray, reach: int) -> ndarray:
    """Sum over `reach` neighbours on either side."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    own = np.arange(values.size)
    return total[np.minimum(own + reach + 1, values.size)] - total[np.maximum(own - reach, 0)]
