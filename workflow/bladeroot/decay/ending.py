"""Where a free decay ends: in the noise, or where something disturbs it."""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray
from scipy.ndimage import maximum_filter1d

from bladeroot.decay.release import FRAME_OVERLAP, KINK_REACH, LEAST_REACH, log_points
from bladeroot.signal.envelope import FRAME_STEPS, Envelope
from bladeroot.signal.turning import kinks

# Why a decay ends.
NOISE = "the noise"
RECORD_END = "end of the record"
STEPPED = "the digitiser's steps"
# A rise of the smoothed ln A that ends a decay: neither noise nor a decaying mode by itself makes
# the envelope rise by half.
RISE = float(np.log(1.5))
# The decay ends in the noise where the mean square amplitude of some frames is no larger than the
# noise's. They are half of those in which ln A falls by one.
NOISE_ERRORS = 3.0  # standard errors that are allowed for
MOST_NOISE_FRAMES = 4096  # over which the mean square is taken
# A blow is seen in what a frame holds besides the mode.
STRIKE_FRAMES = 16  # half cycles before it, with the largest of which it is compared
STRIKE_FACTOR = 5.0  # ratio to that; noise in a frame of ten samples reaches it once in a million
HARMFUL_PART = 0.005  # of the mode's amplitude; a smaller blow does no harm
# Nor does what has gone soon and has not moved the mode: its log-phasor, by a step or a bend.
STRIKE_GONE = 64  # half cycles
STRIKE_MOVES = 0.02
# The shaker's tip touches the beam again: a kink of the log-phasor (gains: `signal.turning.Kinks`).
# It counts with TIP_GAIN and TIP_BARE_GAIN, or with TIP_ABRUPT_GAIN alone where it is abrupt.
TIP_GAIN = 30.0  # over noise; more than `release.KINK_GAIN`, as every place of a record is tested
TIP_BARE_GAIN = 10.0  # over noise and the ripple after the kink
TIP_ABRUPT_GAIN = 60.0  # over noise
# Fall of ln A over the points before a kink, at most: over a larger one, a joint's damping rises to
# a hump and falls again by itself.
TIP_MOST_FALL = 0.3
TIP_ABRUPT_FALL = 0.2  # of an abrupt kink
# Least step of the log-phasor, or bend times the reach. A joint that begins to stick has neither.
# As much is reached by the beat of a close mode of 8 %, by a frequency that changes at once by
# 0.7 % (over two dozen cycles), and by one that changes by 0.17 % (over a hundred).
TIP_LEAST_SIZE = 1.0
TIP_OVER_NOISE = 5.0  # amplitude over the noise, down to which the phase is known and kinks sought
TIP_SCALES = (16, 8, 4, 2, 1)  # frames (half cycles) in a tested point, one scale after the other
TIP_REFINEMENT = 6  # points of a scale by which it may put the kink later than a coarser one did


def running_power(seen: Envelope, size: int) -> Float[ndarray, " frame"]:
    """Mean square amplitude over `size` frames about each frame (fewer at the ends)."""
    total = np.concatenate([[0.0], np.cumsum(np.exp(2.0 * seen.level))])
    at = np.arange(seen.level.size)
    low, high = np.maximum(at - size // 2, 0), np.minimum(at + (size + 1) // 2, at.size)
    return np.maximum(total[high] - total[low], 0.0) / (high - low)


def strikes(seen: Envelope, white: float) -> Bool[ndarray, " frame"]:
    """First frames in which something strikes: the mean, or what is beside the mode, jumps.

    white: rms of the record's white noise (m/s), the least that a jump is compared with.
    """
    lag = FRAME_STEPS // 2
    moved = np.zeros_like(seen.mean)
    moved[FRAME_STEPS:] = np.abs(seen.mean[FRAME_STEPS:] - seen.mean[:-FRAME_STEPS])
    struck = np.zeros(seen.level.size, bool)
    own = HARMFUL_PART * np.exp(seen.level[STRIKE_FRAMES - 1 + lag :])
    for size in (seen.rest, moved):
        # the largest from each frame on
        before = maximum_filter1d(size, STRIKE_FRAMES, origin=-(STRIKE_FRAMES // 2))
        now = size[STRIKE_FRAMES - 1 + lag :]
        limit = np.maximum(STRIKE_FACTOR * np.maximum(before[: now.size], white), own)
        over = now > limit
        for k in np.flatnonzero(over & ~np.concatenate([[False], over[:-1]])):
            first, later = STRIKE_FRAMES - 1 + lag + int(k), now[k : k + STRIKE_GONE] > limit[k]
            struck[first] = not _unmoved(seen, first, first + int(np.flatnonzero(later)[-1]))
    return struck


def _unmoved(seen: Envelope, first: int, last: int) -> bool:
    """Whether the mode goes on behind some frames as if nothing had been there.

    Its log-phasor on either side is a parabola, with a step and a bend between.
    """
    lag = FRAME_STEPS // 2
    begin, end = first - lag - STRIKE_FRAMES, last + lag + 1 + STRIKE_FRAMES
    if last - first >= STRIKE_GONE - 1 or begin < 0 or end > seen.log.size:
        return False
    frame = np.arange(begin, end)
    frame = frame[(frame < first - lag) | (frame > last + lag)]
    x = (frame - 0.5 * (first + last)) / STRIKE_FRAMES
    design = np.stack([np.ones(x.size), x, x**2, x > 0.0, np.maximum(x, 0.0)], axis=1)
    change = np.linalg.lstsq(design, seen.log[frame], rcond=None)[0][3:]
    return bool(np.abs(change).max() < STRIKE_MOVES)


def find_end(
    seen: Envelope,
    noise: float,
    least: float,
    level: Float[ndarray, " frame"],
    broken: Bool[ndarray, " frame"],
    begin: int,
    trough: int,
    ratio: float,
) -> tuple[float, str]:
    """Time at which the decay from frame `begin` on ends, and why.

    noise: rms amplitude that noise shows in a frame, m/s. least: amplitude (m/s) below which a
    digitiser's steps show. level: smoothed ln of the amplitude, not below what noise may show.
    broken: where something strikes. trough: frame in which the fall of `level` ends. ratio: part of
    its first value at which the envelope shall end (0: go on to the noise).
    """
    last = seen.level.size - 1
    ends = []
    over = trough + np.flatnonzero(broken[trough:] | (level[trough:] > level[trough] + RISE))
    if over.size:
        # a slow rise is seen late: it begins at the trough, unless that lies in the noise
        creeps = not broken[over[0]] and level[trough] > level.min()
        at = trough if creeps else over[0]
        ends.append((seen.time[at] - 0.5 * seen.frame_s, "disturbed"))
    pace = (trough - begin) / max(seen.level[begin] - seen.level[trough], 0.1)
    size = int(np.clip(0.5 * pace, FRAME_STEPS, MOST_NOISE_FRAMES))
    power = running_power(seen, size)[begin:]
    limit = noise**2 * (1.0 + NOISE_ERRORS * np.sqrt(FRAME_OVERLAP / size))
    lost = np.flatnonzero(power <= limit)
    if lost.size:
        last = begin + int(lost[0])
        ends.append((seen.time[last], NOISE))
    coarse = np.flatnonzero(power <= least**2)
    if coarse.size:
        ends.append((seen.time[begin + coarse[0]], STEPPED))
    if ratio:
        calm = running_power(seen, FRAME_STEPS)[begin : last + 1]
        below = np.flatnonzero(calm < ratio**2 * calm[0])
        if below.size:
            ends.append((seen.time[begin + below[0]], f"{ratio:g} of the first envelope"))
    back = tip_return(seen, noise, begin, last)
    if back is not None:
        ends.append((back, "disturbed"))
    if not ends:
        return float(seen.time[-1] + 0.5 * seen.frame_s), RECORD_END
    time, reason = min(ends)
    return float(time), reason


def tip_return(seen: Envelope, noise: float, begin: int, last: int) -> float | None:
    """Time of the first kink in an otherwise smooth decay, found at several scales."""
    weak = np.flatnonzero(
        seen.level[begin : last + 1] < np.log(max(TIP_OVER_NOISE * noise, 1e-300))
    )
    stop = begin + int(weak[0]) if weak.size else last + 1
    found: int | None = None
    for size in TIP_SCALES:
        log, std, start = log_points(seen, noise, begin, stop, size)
        reach = min(KINK_REACH, log.size // 2)
        if reach < LEAST_REACH:
            continue
        tested = kinks(log, std, reach, -1, max(1.0, FRAME_OVERLAP / size))
        moved = np.maximum(np.abs(tested.step), np.abs(tested.bend) * reach)
        fall = log.real[tested.place - reach] - log.real[tested.place - 1]
        kinked = (tested.gain > TIP_GAIN) & (tested.bare > TIP_BARE_GAIN) & (fall < TIP_MOST_FALL)
        kinked |= (tested.gain > TIP_ABRUPT_GAIN) & (fall < TIP_ABRUPT_FALL)
        real = np.flatnonzero(kinked & (moved > TIP_LEAST_SIZE))
        if real.size:
            near = slice(real[0], real[0] + 2 * reach)
            place = tested.place[near][np.argmax(tested.gain[near])]
            early = min(place, tested.place[real[0]] + reach)
            at = max(int(start + (early - 1) * size), 0)
            # a finer scale places the same kink better
            if found is None or at < found + TIP_REFINEMENT * size:
                found = at
    return None if found is None else float(seen.time[found] - 0.5 * seen.frame_s)
