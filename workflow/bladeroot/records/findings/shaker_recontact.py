"""The shaker's tip touches again: amplitude and phase make a step within the decay."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from bladeroot.records.finding import Finding
from bladeroot.records.findings import wrong_mode
from bladeroot.records.runs import joined, runs
from bladeroot.records.sight import Sight

STATISTIC = "largest step of ln A + i phase beyond its smooth course, in its usual size"
THRESHOLD = 7.0
# Steps below this (3 % of the amplitude, or 0.03 rad) are no fault.
LEAST = 0.03
# More steps than this of a like size are none.
MOST = 4


def find(sight: Sight) -> Finding | None:
    """The largest step; the decay is used on that side of the steps where it falls furthest."""
    at, size, statistic = largest(sight)
    if at is not None and statistic > THRESHOLD and not gap(size):
        return step_finding(sight, at, statistic, THRESHOLD, told(size))
    statistic = 0.0 if gap(size) else statistic
    beside = at_ends(sight)
    if beside is not None and not gap(beside[1]):
        statistic, step, moment, span = beside
        text = f"{told(step)} at {moment:.4g} s, where the decay was cut"
        return Finding(statistic, THRESHOLD, "mask", text, (span,))
    return Finding(statistic, THRESHOLD, "mask", "")


def at_ends(sight: Sight) -> tuple[float, complex, float, tuple[int, int]] | None:
    """Statistic, size and time of a step for which the decay was cut, and the samples at the cut.

    Looked for at the end and at the start; the decay's own side goes no further than the cut.
    """
    count, margin = sight.velocity.size, 3 * sight.frames.hop
    reach = int(35 * sight.sampling_Hz / sight.own_Hz)
    start, stop = sight.first, sight.first + count
    ends = (
        (max(stop - reach, start), stop + reach, (count - margin, count)),
        (start - reach, min(start + reach, stop), (0, margin)),
    )
    for low, high, span in ends:
        if low >= 0 and high <= sight.whole.size:
            statistic, step, moment = _beside(sight, low, high)
            if statistic > THRESHOLD:
                return statistic, step, moment, span
    return None


def _beside(sight: Sight, low: int, high: int) -> tuple[float, complex, float]:
    """Statistic, size and time of a step between two samples, with free decay on both sides.

    The cut begins and ends where something strikes. If that is the release, the mode did not fall
    before; if it is the tip's return for good, the mode dies at once.
    """
    nothing = 0.0, 0j, 0.0
    near = replace(sight, velocity=sight.whole[low:high], blind=())
    frames = near.frames
    if frames.clear < frames.log.size:
        return nothing
    step, scale = near.jumps
    ratio = np.abs(step) / np.maximum(scale, LEAST / THRESHOLD)
    at = int(np.argmax(ratio))
    size = complex(step[at])
    sides = frames.log[: max(at - 2, 0)], frames.log[at + 3 :]
    if abs(size.real) > 0.5 or min(side.size for side in sides) < 8:
        return nothing
    slopes = []
    for side in sides:
        x = np.arange(side.size)
        for part in (side.real, side.imag):
            fit = np.polyfit(x, part, 2)
            if np.abs(part - np.polyval(fit, x)).max() > 0.3 * abs(size):
                return nothing
        slopes.append(float(side.real[-1] - side.real[0]) / side.size)
    free = slopes[1] < 0.0 and 0.4 < slopes[0] / slopes[1] < 2.5
    moment = sight.seconds(low - sight.first + frames.centre[at])
    return (float(ratio[at]), size, moment) if free else nothing


def told(size: complex) -> str:
    """A step in words."""
    return (
        f"the shaker touched again: the amplitude steps by {100 * np.expm1(size.real):+.2g} % and "
        f"the phase by {size.imag:+.2g} rad"
    )


def gap(size: complex) -> bool:
    """Whether a step is in phase alone and too large for a touch: samples are missing."""
    return abs(size.imag) > 0.3 and abs(size.real) < 0.1 * abs(size.imag)


def largest(sight: Sight) -> tuple[int | None, complex, float]:
    """Frame, size and statistic of the largest step."""
    other = wrong_mode.find(sight)
    step, scale = sight.jumps
    ratio = np.abs(step) / np.maximum(scale, LEAST / THRESHOLD)
    if not ratio.any() or (other is not None and other.counts):
        return None, 0j, 0.0
    at = int(np.argmax(ratio))
    # of neighbours with the same step, the one where the step is largest
    near = slice(max(at - 2, 0), at + 3)
    at = near.start + int(np.argmax(np.abs(step[near])))
    # many places nearly as bad are a beat and not a touch
    like = np.abs(step) > 0.35 * np.abs(step[at])
    like = joined(runs(like & (ratio > 0.35 * ratio.max())), 6)
    if len(like) > MOST:
        return None, 0j, 0.0
    return at, complex(step[at]), float(ratio.max())


def step_finding(sight: Sight, at: int, statistic: float, threshold: float, what: str) -> Finding:
    """A step at a frame: the lesser side of it is masked, with three cycles around it."""
    frames = sight.frames
    step, scale = sight.jumps
    ratio = np.abs(step) / np.maximum(scale, LEAST / THRESHOLD)
    over = np.flatnonzero(ratio > threshold)
    edges = [0]
    for k in over:  # steps more than ten cycles apart are different ones
        if k - edges[-1] > 10:
            edges.append(int(k))
    edges = edges[1:] or [at]
    bounds = [0, *edges, frames.clear - 1]
    level = np.maximum(frames.log.real, np.log(frames.std * frames.amplitude * 8.0))
    fall = [level[min(a + 3, b)] - level[max(b - 3, a)] for a, b in pairwise(bounds)]
    best = int(np.argmax(fall))
    margin = 3 * frames.hop
    first = 0 if best == 0 else int(frames.centre[bounds[best]]) + margin
    final = best == len(fall) - 1
    last = sight.velocity.size if final else int(frames.centre[bounds[best + 1]]) - margin
    spans = tuple(s for s in ((0, first), (last, sight.velocity.size)) if s[1] > s[0])
    moment = sight.seconds(frames.centre[at])
    kept = f"from {sight.seconds(first):.4g} to {sight.seconds(last):.4g} s"
    text = f"{what} at {moment:.4g} s; only the decay {kept} is used"
    return Finding(statistic, threshold, "mask", text, spans)
