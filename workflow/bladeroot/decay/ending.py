"""Where a free decay ends: in the noise, or where something disturbs it."""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray
from scipy.ndimage import maximum_filter1d

from bladeroot.decay.release import FEWEST, OVERLAP, REACH, log_points
from bladeroot.signal.envelope import FRAME_STEPS, Envelope
from bladeroot.signal.turning import kinks

# A blow is seen in what a frame holds besides the mode: this grows beyond its largest over the
# eight cycles before by the factor STRIKE (noise in a frame of ten samples does so once in a
# million), and is more than the part HARMFUL of the mode's amplitude; a smaller one does no harm.
STRIKE, HARMFUL = 5.0, 0.005
# The shaker's tip touches the beam again: a kink counts with GAIN over noise (see `release.GAIN`;
# larger here, where every place of a record is tested) and BARE over noise and the ripple after
# it, or with ALL_AT_ONCE over noise where it is abrupt.
GAIN, BARE, ALL_AT_ONCE = 30.0, 10.0, 60.0
# Least step of the log-phasor, or bend times the reach, of a kink. A joint that begins to stick has
# neither. As much is reached by the beat of a close mode of 8 %, by a frequency that changes at
# once by 0.7 % (over two dozen cycles), and by one that changes by 0.17 % (over a hundred).
MOVED = 1.0
# SIZES: frames (half cycles) in a tested point. STEEPEST, ABRUPT: a bend is a kink, or an abrupt
# one, only if ln A falls by less than this over the points before it: over a larger fall, a joint's
# damping rises to a hump and falls again by itself.
SIZES, STEEPEST, ABRUPT = (16, 8, 4, 2, 1), 0.3, 0.2
STEPPED = "the digitiser's steps"  # why a decay ends
# Neither noise nor a decaying mode by itself makes the smoothed envelope rise by half.
RISE = float(np.log(1.5))
# Frames over which the largest before a strike is taken.
BEFORE = 16
# The noise's mean square and so many of its standard errors end a decay, over half the frames in
# which ln A falls by one, these at most; from so many times the noise on a phase is known.
ERRORS, LONGEST, KNOWN = 3.0, 4096, 5.0
# Points of a coarser scale by which a finer one may find the same kink later, in its own.
LATER = 6


def running_power(seen: Envelope, size: int) -> Float[ndarray, " frame"]:
    """Mean square amplitude over `size` frames about each frame (fewer at the ends)."""
    total = np.concatenate([[0.0], np.cumsum(np.exp(2.0 * seen.level))])
    at = np.arange(seen.level.size)
    low, high = np.maximum(at - size // 2, 0), np.minimum(at + (size + 1) // 2, at.size)
    return np.maximum(total[high] - total[low], 0.0) / (high - low)


def strikes(seen: Envelope, white: float) -> Bool[ndarray, " frame"]:
    """Frames in which something strikes: the mean, or the rest besides the mode, jumps."""
    lag = FRAME_STEPS // 2
    moved = np.zeros_like(seen.mean)
    moved[FRAME_STEPS:] = np.abs(seen.mean[FRAME_STEPS:] - seen.mean[:-FRAME_STEPS])
    struck = np.zeros(seen.level.size, bool)
    for size in (seen.rest, moved):
        before = maximum_filter1d(size, BEFORE, origin=-(BEFORE // 2))  # from each frame on
        now = size[BEFORE - 1 + lag :]
        usual = np.maximum(before[: now.size], white)
        own = np.exp(seen.level[BEFORE - 1 + lag :])
        struck[BEFORE - 1 + lag :] |= (now > STRIKE * usual) & (now > HARMFUL * own)
    return struck & ~np.concatenate([[False], struck[:-1]])


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

    `noise` is the rms amplitude that noise shows in a frame, `least` the amplitude below which a
    digitiser's steps show, `level` the smoothed ln of the amplitude, not below what noise may show,
    `broken` where something strikes, `trough` the frame in which the fall of `level` ends, `ratio`
    the part of its first value at which the envelope shall end (0: go on to the noise).
    """
    last = seen.level.size - 1
    ends = []
    over = trough + np.flatnonzero(broken[trough:] | (level[trough:] > level[trough] + RISE))
    if over.size:
        # a slow rise begins at the trough, before it is seen; out of the noise it has no such start
        creeps = not broken[over[0]] and level[trough] > level.min()
        at = trough if creeps else over[0]
        ends.append((seen.time[at] - 0.5 * seen.frame_s, "disturbed"))
    pace = (trough - begin) / max(seen.level[begin] - seen.level[trough], 0.1)
    size = int(np.clip(0.5 * pace, FRAME_STEPS, LONGEST))
    power = running_power(seen, size)[begin:]
    limit = noise**2 * (1.0 + ERRORS * np.sqrt(OVERLAP / size))
    lost = np.flatnonzero(power <= limit)
    if lost.size:
        last = begin + int(lost[0])
        ends.append((seen.time[last], "the noise"))
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
        return float(seen.time[-1] + 0.5 * seen.frame_s), "end of the record"
    time, reason = min(ends)
    return float(time), reason


def tip_return(seen: Envelope, noise: float, begin: int, last: int) -> float | None:
    """Time of the first kink in an otherwise smooth decay, found at several scales."""
    weak = np.flatnonzero(seen.level[begin : last + 1] < np.log(max(KNOWN * noise, 1e-300)))
    stop = begin + int(weak[0]) if weak.size else last + 1
    found: int | None = None
    for size in SIZES:
        log, std, start = log_points(seen, noise, begin, stop, size)
        reach = min(REACH, log.size // 2)
        if reach < FEWEST:
            continue
        tested = kinks(log, std, reach, -1, max(1.0, OVERLAP / size))
        moved = np.maximum(np.abs(tested.step), np.abs(tested.bend) * reach)
        fall = log.real[tested.place - reach] - log.real[tested.place - 1]
        kinked = (tested.gain > GAIN) & (tested.bare > BARE) & (fall < STEEPEST)
        kinked |= (tested.gain > ALL_AT_ONCE) & (fall < ABRUPT)
        real = np.flatnonzero(kinked & (moved > MOVED))
        if real.size:
            near = slice(real[0], real[0] + 2 * reach)
            place = tested.place[near][np.argmax(tested.gain[near])]
            early = min(place, tested.place[real[0]] + reach)
            at = max(int(start + (early - 1) * size), 0)
            # a finer scale sees the same kink more sharply
            if found is None or at < found + LATER * size:
                found = at
    return None if found is None else float(seen.time[found] - 0.5 * seen.frame_s)
