"""The shaker's tip touches again, or samples are missing: the decay makes a step.

Missing or repeated samples, the gap closed up, step in phase alone: that is told as `gap`.
"""

from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.quality.examined import Examined, Finding, block_scale, joined
from bladeroot.quality.findings import wrong_mode
from bladeroot.signal.runs import runs

STATISTIC = "largest step of ln A + i phase beyond its smooth course, in its usual size"
THRESHOLD = 7.0
# Size of a step of ln A + i phase: 0.01 is 1 % of the amplitude, or 0.01 rad.
LARGE_STEP = 0.03  # from here on only one side of the step is used
SLIGHT_STEP = 0.005  # from here on some cycles on either side are masked
SLIGHT_MASK_CYCLES = 16  # that many, as a curve's windows reach as far
MASK_MARGIN_CYCLES = 3  # cycles masked beside a large step, and at a cut
LARGEST_TOUCH_PHASE = 0.3  # rad: a larger step in phase alone is made by missing samples only
PHASE_ALONE = 0.1  # a step is in phase alone where its part in ln A is at most this of its phase's

# Many steps like the largest are a beat, not a touch.
ALIKE_PART = 0.35  # what has this part of the largest step, and of its statistic, is like it
MOST_ALIKE = 4  # with more places like the largest there is no step
ALIKE_APART_CYCLES = 6  # such places that far apart count as two
STEPS_APART_CYCLES = 10  # significant steps that far apart count as two

# Missing or repeated samples (a gap) make a step of known size in ln A and in phase. It fits within
# twice the step's usual error and this part of the step, which slopes on both sides do not tell.
LONGEST_GAP = 4096  # samples
GAP_LEVEL_FIT = 0.06  # part of the step in ln A
GAP_PHASE_FIT = 0.02  # part of the step in phase

# A step for which the decay was cut has a free decay on both sides.
CUT_REACH_CYCLES = 35  # cycles on either side of a cut in which it is looked for
FEWEST_SIDE_FRAMES = 8  # on each side at least
SIDE_MISFIT = 0.3  # part of the step: largest misfit of a parabola through a side
RATE_RATIOS = (0.4, 2.5)  # decay rate before over that after, at least and at most
RELEASE_STEP = 0.5  # in ln A: a larger step is the release
# Below this many standard errors of a frame its ln A tells nothing of how far the mode falls.
LEVEL_OVER_ERROR = 8.0

# The fit of a step, with a quadratic on both sides of it, and the step's usual size.
JUMP_REACH = 7  # farthest frame on either side
JUMP_NEAREST = 2  # nearest one: those between straddle the step
# Where laws bend sharply they look like a step. A hump of damping takes many cycles, a touch one or
# two: a cubic beside the step explains the hump.
MISSED_BEND = 0.15  # part of the quadratic's bend over seven cycles that adds to the usual size
MISSED_HUMP = 0.2  # part of the step's change by the cubic that adds to it
USUAL_FRAMES = 96  # frames in a block, with whose median step each step is compared
RAYLEIGH_MEDIAN = 1.18  # median of a Rayleigh variable of unit parameter; divides that median


@dataclass(frozen=True)
class Step:
    """A step of ln A + i phase: its frame and size, and the missing samples that would make it.

    `lost` is negative for repeated samples, zero where no whole number makes such a step; `cycle`
    is the number of samples in a cycle.
    """

    at: int
    size: complex
    statistic: float
    lost: int
    cycle: float

    @property
    def gap(self) -> bool:
        """Whether the step is in phase alone, and as large as only missing samples make it."""
        size = abs(self.size.imag)
        pure = abs(self.size.real) < PHASE_ALONE * size
        return pure and (size > LARGEST_TOUCH_PHASE or (size > LARGE_STEP and self.lost != 0))

    @property
    def words(self) -> str:
        """The step in words."""
        if self.gap:
            lost = self.size.imag / (2.0 * np.pi) % 1.0 * self.cycle
            return (
                f"samples are missing ({lost:.3g}) or repeated ({self.cycle - lost:.3g}), or whole "
                "cycles more: the phase steps"
            )
        what = "missing" if self.lost > 0 else "repeated"
        lost = f", or samples are {what} ({abs(self.lost)} would fit)" if self.lost else ""
        return (
            f"a disturbance, as if something touched the specimen{lost}: the amplitude steps by "
            f"{100 * np.expm1(self.size.real):+.2g} % and the phase by {self.size.imag:+.2g} rad"
        )


def find(seen: Examined) -> Finding:
    """The largest step; the decay is used on that side of the steps where it falls furthest."""
    step = largest(seen)
    if step is not None and step.statistic > THRESHOLD:
        return step_finding(seen, step)
    beside = at_ends(seen)
    if beside is not None:
        step, moment, span = beside
        text = f"{step.words} at {moment:.4g} s, where the decay was cut"
        return _finding(step, text, (span,), moment * seen.sampling_Hz)
    return _slight(seen)


def _finding(
    step: Step, text: str, spans: tuple[tuple[int, int], ...], at: float | np.number
) -> Finding:
    name = "gap" if step.gap else ""
    return Finding(step.statistic, THRESHOLD, "mask", text, spans, name=name, at=float(at))


def _slight(seen: Examined) -> Finding:
    """Steps too small to give up what lies beyond them: the cycles beside them are masked."""
    step = largest(seen, SLIGHT_STEP)
    if step is None:
        return Finding(0.0, THRESHOLD, "mask", "")
    frames, reach = seen.frames, SLIGHT_MASK_CYCLES * seen.frames.hop
    at = frames.centre[step.at]
    if step.statistic <= THRESHOLD:
        return _finding(step, "", (), at)
    places = joined(runs(_ratio(seen, SLIGHT_STEP) > THRESHOLD), STEPS_APART_CYCLES)
    spans = tuple(
        (
            max(int(frames.centre[first]) - reach, 0),
            min(int(frames.centre[last - 1]) + reach, seen.velocity.size),
        )
        for first, last in places
    )
    moments = ", ".join(f"{seen.seconds(0.5 * (first + last)):.4g}" for first, last in spans)
    text = f"{step.words} at {moments} s; {SLIGHT_MASK_CYCLES} cycles on either side are masked"
    return _finding(step, text, spans, at)


def _ratio(seen: Examined, least: float = LARGE_STEP) -> Float[ndarray, " frame"]:
    """Steps over their usual size; a step smaller than `least` stays below the threshold."""
    step, scale = jumps(seen)
    return np.abs(step) / np.maximum(scale, least / THRESHOLD)


def at_ends(seen: Examined) -> tuple[Step, float, tuple[int, int]] | None:
    """A step for which the decay was cut, its time, and the samples at the cut.

    Looked for at the end and at the start; the decay's own side goes no further than the cut.
    """
    count, margin = seen.velocity.size, MASK_MARGIN_CYCLES * seen.frames.hop
    reach = int(CUT_REACH_CYCLES * seen.sampling_Hz / seen.own_Hz)
    start, stop = seen.first, seen.first + count
    ends = (
        (max(stop - reach, start), stop + reach, (count - margin, count)),
        (start - reach, min(start + reach, stop), (0, margin)),
    )
    for low, high, span in ends:
        if low >= 0 and high <= seen.whole.size:
            beside = _beside(seen, low, high)
            if beside is not None and beside[0].statistic > THRESHOLD:
                return *beside, span
    return None


def _beside(seen: Examined, low: int, high: int) -> tuple[Step, float] | None:
    """A step between two samples, with free decay on both sides, and its time.

    The cut begins and ends where something strikes. If that is the release, the mode did not fall
    before; if it is the tip's return for good, the mode dies at once.
    """
    near = replace(seen, velocity=seen.whole[low:high], blind=())
    frames = near.frames
    if frames.clear < frames.log.size:
        return None
    step, ratio = jumps(near)[0], _ratio(near)
    at = int(np.argmax(ratio))
    size = complex(step[at])
    sides = frames.log[: max(at - 2, 0)], frames.log[at + 3 :]
    if abs(size.real) > RELEASE_STEP or min(side.size for side in sides) < FEWEST_SIDE_FRAMES:
        return None
    slopes = []
    for side in sides:
        x = np.arange(side.size)
        for part in (side.real, side.imag):
            fit = np.polyfit(x, part, 2)
            if np.abs(part - np.polyval(fit, x)).max() > SIDE_MISFIT * abs(size):
                return None
        slopes.append(float(side.real[-1] - side.real[0]) / side.size)
    free = slopes[1] < 0.0 and RATE_RATIOS[0] < slopes[0] / slopes[1] < RATE_RATIOS[1]
    if not free:
        return None
    moment = seen.seconds(low - seen.first + frames.centre[at])
    return _step(near, at, size, float(ratio[at])), moment


def _lost(seen: Examined, at: int, size: complex) -> int:
    """Fewest missing samples that make a step: after them the decay goes on where it would be."""
    frames, log = seen.frames, seen.frames.log
    before, after = (
        log[at - JUMP_REACH : at - JUMP_NEAREST + 1],
        log[at + JUMP_NEAREST :][:JUMP_REACH],
    )
    slope = 0.5 * sum((side[-1] - side[0]) / (side.size - 1) for side in (before, after))
    count = np.arange(-LONGEST_GAP, LONGEST_GAP + 1)
    made = count * (slope / frames.hop + 2j * np.pi * frames.frequency_Hz / seen.sampling_Hz)
    level = made.real - size.real
    phase = np.mod(made.imag - size.imag + np.pi, 2.0 * np.pi) - np.pi
    scale = jumps(seen)[1][at]
    fits = np.abs(level) < 2.0 * scale + GAP_LEVEL_FIT * abs(size.real)
    fits &= (np.abs(phase) < 2.0 * scale + GAP_PHASE_FIT * abs(size.imag)) & (count != 0)
    found = count[fits]
    return int(found[np.argmin(np.abs(found))]) if found.size else 0


def largest(seen: Examined, least: float = LARGE_STEP) -> Step | None:
    """The largest step; one below `least` is not significant."""
    other = wrong_mode.find(seen)
    step, ratio = jumps(seen)[0], _ratio(seen, least)
    if not ratio.any() or (other is not None and other.counts):
        return None
    at = int(np.argmax(ratio))
    # neighbouring frames see the same step: where it is largest
    near = slice(max(at - 2, 0), at + 3)
    at = near.start + int(np.argmax(np.abs(step[near])))
    like = np.abs(step) > ALIKE_PART * np.abs(step[at])
    like = joined(runs(like & (ratio > ALIKE_PART * ratio.max())), ALIKE_APART_CYCLES)
    if len(like) > MOST_ALIKE:
        return None
    size = complex(step[at])
    return _step(seen, at, size, float(ratio.max()))


def _step(seen: Examined, at: int, size: complex, statistic: float) -> Step:
    cycle = seen.sampling_Hz / seen.own_Hz
    return Step(at, size, statistic, _lost(seen, at, size), cycle)


def step_finding(seen: Examined, found: Step) -> Finding:
    """A step: all but the side on which the decay falls furthest is masked, with some cycles."""
    frames = seen.frames
    over = np.flatnonzero(_ratio(seen) > THRESHOLD)
    edges = [0]
    for k in over:
        if k - edges[-1] > STEPS_APART_CYCLES:
            edges.append(int(k))
    edges = edges[1:] or [found.at]
    bounds = [0, *edges, frames.clear - 1]
    level = np.maximum(frames.log.real, np.log(frames.std * frames.amplitude * LEVEL_OVER_ERROR))
    fall = [level[min(a + 3, b)] - level[max(b - 3, a)] for a, b in pairwise(bounds)]
    best = int(np.argmax(fall))
    margin = MASK_MARGIN_CYCLES * frames.hop
    first = 0 if best == 0 else int(frames.centre[bounds[best]]) + margin
    final = best == len(fall) - 1
    last = seen.velocity.size if final else int(frames.centre[bounds[best + 1]]) - margin
    spans = tuple(s for s in ((0, first), (last, seen.velocity.size)) if s[1] > s[0])
    moment = seen.seconds(frames.centre[found.at])
    kept = f"from {seen.seconds(first):.4g} to {seen.seconds(last):.4g} s"
    text = f"{found.words} at {moment:.4g} s; only the decay {kept} is used"
    return _finding(found, text, spans, frames.centre[found.at])


def jumps(seen: Examined) -> tuple[Complex[ndarray, " frame"], Float[ndarray, " frame"]]:
    """Step of the log-phasor at each frame beyond a smooth course, and its usual size.

    A quadratic and a step are fitted to six frames on each side; the three between are left out.
    Zero where there are too few frames, or the mode is near the noise.
    """
    frames, reach = seen.frames, JUMP_REACH
    step, scale = np.zeros(frames.log.size, complex), np.ones(frames.log.size)
    if frames.clear < 2 * reach + 2:
        return step, scale
    kernels = _step_and_bend()
    inner = slice(reach, frames.clear - reach)
    pieces = np.lib.stride_tricks.sliding_window_view(
        np.where(frames.whole, frames.log, np.nan)[: frames.clear], len(kernels)
    )
    step[inner], curve, sharp = np.nan_to_num(pieces @ kernels).T
    summed = np.zeros(frames.row.size + 2 * reach * frames.hop, complex)
    for k, weight in enumerate(kernels[:, 0]):  # frames share samples: one row for the step
        summed[k * frames.hop : k * frames.hop + frames.row.size] += weight * frames.row
    gain = np.linalg.norm(summed) / np.linalg.norm(frames.row.real)
    late = np.minimum(np.arange(frames.log.size) + reach, frames.log.size - 1)
    bent = np.zeros(frames.log.size)
    # where laws bend sharply a quadratic misses some of the bend
    bent[inner] = MISSED_BEND * np.abs(curve) + MISSED_HUMP * np.abs(step[inner] - sharp)
    scale = gain * frames.std[late] + bent
    # what is rough throughout hides a step
    rough = block_scale(np.abs(step[inner]) / scale[inner], USUAL_FRAMES) / RAYLEIGH_MEDIAN
    scale[inner] *= np.maximum(rough, 1.0)
    return step, scale


@cache
def _step_and_bend() -> Float[ndarray, "frame 3"]:
    """Weights of frames: step beyond a quadratic, the quadratic's bend, step beyond a cubic."""
    x = np.arange(-JUMP_REACH, JUMP_REACH + 1.0)
    used = np.abs(x) >= JUMP_NEAREST
    design = np.stack([0.5 * np.sign(x), np.ones(x.size), x, x * x, x**3], axis=1)[used]
    quadratic, cubic = np.linalg.pinv(design[:, :4]), np.linalg.pinv(design)
    weights = np.zeros((x.size, 3))
    weights[used] = np.stack([quadratic[0], quadratic[3] * JUMP_REACH**2, cubic[0]], axis=1)
    return weights
