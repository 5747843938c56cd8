"""Where a decay is let go: the last step or bend of the log-phasor near the top of its fall."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.signal.envelope import FRAME_STEPS, Envelope
from bladeroot.signal.turning import Kinks, expected_gain, kinks

# Where the release may lie: a kink farther down is the decay's end.
DEEPEST_FALL = 1.0  # of ln A below the peak, and
UPPER_PART = 0.3  # of the whole fall of ln A; the smaller of both counts
# The points in which kinks are looked for, means of frames.
KINK_REACH = 12  # points on either side of a tested place: enough for a cubic and its scatter
LEAST_REACH = 7  # of a short record, in which a kink is still looked for
COARSEST_FALL = 0.8  # of ln A over the coarsest scale's points: over more no decay is a plain curve
FRAME_OVERLAP = 4.0  # frames share samples: as many neighbours tell as much as one independent
LEAST_ERROR = 1e-5  # of a point's ln A and phase (rad): no digitiser is better
# When a kink is real. A smaller one does no harm, and a curved backbone makes as much. The scatter
# has 18 degrees of freedom, so that noise reaches a gain of 15 once in 100,000 places.
KINK_GAIN = 15.0  # what the kink explains of the misfit over what noise does on average
KINK_STEP = 0.02  # of the log-phasor, or
KINK_BEND = 0.6  # change of its slope over the decay rate
# Whether a real kink is a step, else a bend.
STEP_ERRORS = 4.0  # standard errors that a step must have
STEP_OVER_BEND = 2.0  # points: step over bend; below it a bend that far away explains the step
# How well the place of either is known.
STEP_MARGIN = 4  # frames by which a step may lie before the place found for it
LEAST_BEND_ERROR = 0.8  # frames: a tip leaves within half a cycle, and frames see it no better
# Without a kink: a first fall that takes much longer than by the later decay rate is still driven.
FLAT_FALL = 0.1  # of ln A, from the peak on
FLAT_SLOWNESS = 3.0  # times as long
# The rise before the release is sudden after a blow or a release from rest; under a shaker it takes
# a third of the mode's time constant.
QUIET_BELOW = np.log(10.0)  # ln A below what follows, where a rise begins: before it, it is quiet
RISEN_BELOW = np.log(3.0)  # ln A below what follows, where the rise ends
SUDDEN_CYCLES = 1.2  # that a sudden rise takes at most; a frame of three makes 0.6 of a jump
# The instant of a step in the raw samples. The smooth decay after it is continued backwards; before
# the step the samples' difference from it has another variance.
FEWEST_SIDE_FRAMES = 8  # of the decay that is continued
MOST_SIDE_FRAMES = 40
STRAIGHT_FRAMES = 16  # up to which ln A and phase are continued as a line, else as a parabola
MOST_RISE = 2.0  # of ln A backwards; the continuation is not believed beyond
VARIANCE_GAIN = 30.0  # nats of a real change of variance: any two pieces of noise differ by less
VARIANCE_SAMPLES = 4  # on either side of the change at least
INSTANT_CYCLES = 0.1  # standard error of the instant; a change so soon after the first is none
AT_ONCE = "at once"  # what a blow excites, or what is let go from rest
SHAKER = "shaker"  # likewise: a drive that ends
BEGUN = "begins in the decay"  # likewise: nothing is seen of it


@dataclass(frozen=True)
class Release:
    """When the decay was let go (s), that time's standard error (s), and how it was excited."""

    time_s: float
    std_s: float
    excitation: str


def find_release(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    seen: Envelope,
    noise: float,
    level: Float[ndarray, " frame"],
    peak: int,
    trough: int,
) -> Release:
    """The release of the fall between two frames (`peak`, `trough`) of the smoothed `level`.

    `noise` is a frame's rms amplitude.

    At scales from coarse to fine, the last place is taken at which the log-phasor has a step (a
    blow, a step release, a knock of the leaving tip) or a bend (a steady or beating drive let go);
    what comes after it is smooth. Where other modes hide the kink, the end of a steady drive is
    still found by its flat top. A bend is placed where two smooth sides meet; a step is placed by
    the raw samples, which before it do not follow the smooth decay continued backwards.
    """
    depth = min(DEEPEST_FALL, UPPER_PART * (level[peak] - level[trough]))
    low = _last_above(level, peak, trough, level[peak] - depth)
    middle = _last_above(level, peak, low, level[peak] - 0.5 * depth)
    pace = max(low - middle, 1) / (0.5 * depth)
    first = max(0, peak - int(pace))
    found = _last_kink(seen, noise, first, low, middle, pace)
    if found is None:
        flat = _last_above(level, peak, trough, level[peak] - FLAT_FALL)
        if flat - peak > FLAT_SLOWNESS * FLAT_FALL * pace + FRAME_STEPS:
            return Release(float(seen.time[flat]), 0.5 * seen.frame_s, SHAKER)
        if peak > 3 * FRAME_STEPS:
            quiet = _quiet(seen, peak)
            return Release(float(seen.time[peak]), 0.5 * seen.frame_s, _excitation(quiet))
        return _sudden(velocity, sampling_Hz, seen, None, peak, low)
    quiet = _quiet(seen, found.clean)
    if quiet is None and not found.sudden:
        return Release(found.time_s, found.std_s, _excitation(quiet))
    near = found.clean - FRAME_STEPS - STEP_MARGIN
    if quiet is not None and found.clean - quiet < 2 * KINK_REACH:
        near = min(near, quiet - STEP_MARGIN)
    return _sudden(velocity, sampling_Hz, seen, quiet, found.clean, low, near)


@dataclass(frozen=True)
class _Kink:
    """A kink, with the first frame wholly after it, and whether it is a step or a bend."""

    time_s: float
    std_s: float
    clean: int
    sudden: bool


def _last_kink(
    seen: Envelope, noise: float, first: int, low: int, middle: int, pace: float
) -> _Kink | None:
    """The last kink between two frames, at scales (frames a point) from coarse to fine."""
    error = noise * np.exp(-seen.level[middle]) * np.sqrt(0.5 * FRAME_OVERLAP)
    coarsest = max(1, int(np.ceil(COARSEST_FALL * pace / KINK_REACH)))
    sizes = [coarsest >> k for k in range(coarsest.bit_length())]
    # a scale is left out if the next finer one would see a release with enough gain
    fine = [
        size
        for size, finer in zip(sizes, [*sizes[1:], 0], strict=True)
        if not finer
        or expected_gain(finer / pace, error / finer**0.5, KINK_REACH) <= 3.0 * KINK_GAIN
    ]
    found, stop = None, low
    for size in fine:
        log, std, start = log_points(seen, noise, first, stop + KINK_REACH * size, size)
        reach = min(KINK_REACH, log.size // 2)
        if reach < LEAST_REACH:
            continue
        tested = kinks(log, std, reach, +1, max(1.0, FRAME_OVERLAP / size))
        best = _latest(tested, reach, KINK_BEND * size * reach / pace, (low - start) // size)
        if best is None:
            continue
        place, sudden, shift = best
        at = start + place * size
        clean = min(at + size // 2 + FRAME_STEPS // 2 + 1, seen.time.size - 1)
        kink = _Kink(float(seen.time[at]), seen.frame_s, clean, True)
        if not sudden:
            offset, std_points = _bend(log[place - reach : place + reach], std[place:][:reach])
            time = float(seen.time[0] + (at + offset * size - 0.5) * seen.step_s)
            std_points = np.hypot(std_points, 0.5 * shift)
            kink = _Kink(time, max(std_points * size, LEAST_BEND_ERROR) * seen.step_s, clean, False)
            if found is not None and not found.sudden and found.std_s < kink.std_s:
                later = time - found.time_s > 3.0 * (kink.std_s + found.std_s)
                # a coarser scale's time is the better one, unless this is another kink
                kink = kink if later else replace(found, clean=clean)
        found = kink
        first, stop = max(first, at - reach * size), min(stop, at + 2 * reach * size)
    return found


def _last_above(level: ndarray, first: int, last: int, limit: float) -> int:
    return first + int(np.flatnonzero(level[first : last + 1] >= limit)[-1])


def log_points(
    seen: Envelope, noise: float, first: int, stop: int, size: int
) -> tuple[Complex[ndarray, " point"], Float[ndarray, " point"], int]:
    """Means of `size` frames each, standard errors of ln A and of phase alike, the first frame."""
    stop = min(stop, seen.log.size)
    count = (stop - first) // size
    first = stop - count * size
    log = seen.log[first:stop].reshape(count, size).mean(axis=1)
    std = np.minimum(noise * np.exp(-log.real), 1.0) * np.sqrt(0.5 * FRAME_OVERLAP / size)
    return log, np.maximum(std, LEAST_ERROR), first


def _latest(tested: Kinks, reach: int, turn: float, last: int) -> tuple[int, bool, float] | None:
    """Place of the last kink up to a place `last`; whether it is a step rather than a bend.

    Also the step over the bend, in points: a lone bend that far away would look like the step.
    turn: least bend times `reach`.
    """
    step = np.abs(tested.step)
    stepped = (step > KINK_STEP) & (step > STEP_ERRORS * tested.step_std)
    bent = (np.abs(tested.bend) * reach > turn) & (tested.bare > KINK_GAIN)
    real = np.flatnonzero((tested.gain > KINK_GAIN) & (stepped | bent) & (tested.place <= last))
    if not real.size:
        return None
    # places near a large kink gain from it, too: it lies where it explains most
    near = np.arange(max(0, real[-1] - 2 * reach), real[-1] + 1)
    best = near[np.argmax(tested.gain[near])]
    shift = step[best] / max(np.abs(tested.bend[best]), 1e-300)
    return int(tested.place[best]), bool(stepped[best] and shift > STEP_OVER_BEND), float(shift)


def _bend(log: Complex[ndarray, " point"], std: Float[ndarray, " later"]) -> tuple[float, float]:
    """Offset from the middle at which two parabolas that meet fit best, and its error; points."""
    reach = log.size // 2
    log = log - log[reach]
    x = np.arange(-reach, reach) + 0.5
    offsets = np.linspace(-0.6 * reach, 0.6 * reach, 6 * reach + 1)
    away = x - offsets[:, None]
    early, late = np.minimum(away, 0.0), np.maximum(away, 0.0)
    basis = np.linalg.qr(np.stack([np.ones_like(away), early, late, early**2, late**2], 2))[0]
    explained = np.abs(np.einsum("ojk,j->ok", basis, log)) ** 2
    misfit = (np.abs(log) ** 2).sum() - explained.sum(axis=1)
    best = int(np.argmin(misfit))
    variance = max(np.mean(std**2), misfit[best] / (2.0 * (x.size - 6)))
    # the values within one standard error raise the misfit by no more than the variance
    near = offsets[misfit <= misfit[best] + variance]
    return float(offsets[best]), float(max(0.5 * (near[-1] - near[0]), offsets[1] - offsets[0]))


def _excitation(quiet: int | None) -> str:
    return SHAKER if quiet is None else AT_ONCE


def _quiet(seen: Envelope, at: int) -> int | None:
    """The last quiet frame before frame `at`, if the rise after it was sudden; else None."""
    after = seen.level[min(at + FRAME_STEPS, seen.log.size - 1)]
    quiet = np.flatnonzero(seen.level[: at + 1] < after - QUIET_BELOW)
    if not quiet.size:
        return None
    # a second blow may have doubled or halved what the first one left
    up = np.flatnonzero(seen.level[quiet[-1] :] > after - RISEN_BELOW)
    rise = (up[0] if up.size else 0) * seen.step_s * seen.frequency_Hz
    return int(quiet[-1]) if rise < SUDDEN_CYCLES else None


def _sudden(
    velocity: ndarray,
    sampling_Hz: float,
    seen: Envelope,
    quiet: int | None,
    clean: int,
    low: int,
    near: int = 0,
) -> Release:
    """The release at the instant from which on the raw samples follow the smooth decay.

    It is looked for from frame `near` to frame `clean`, the first known to lie after it; `quiet` is
    the last quiet frame, if there is one, and `low` one where the decay has fallen.
    """
    cycle = 1.0 / seen.frequency_Hz
    head = max(min(clean, seen.log.size - FEWEST_SIDE_FRAMES), 0)
    tail = min(max(low, head + FEWEST_SIDE_FRAMES), head + MOST_SIDE_FRAMES, seen.log.size)
    order = 2 if tail - head > STRAIGHT_FRAMES else 1
    polynomial = np.polynomial.polynomial
    curve = polynomial.polyfit(seen.time[head:tail] - seen.time[head], seen.log[head:tail], order)
    first = max(0, int((seen.time[max(near, 0)] - 0.5 * seen.frame_s) * sampling_Hz))
    if near > 0:
        first = int(seen.time[near] * sampling_Hz)
    stop = int((seen.time[head] + 0.5 * seen.frame_s) * sampling_Hz)
    time = np.arange(first, stop) / sampling_Hz
    model = polynomial.polyval(time - seen.time[head], curve)
    model.real = np.minimum(model.real, curve[0].real + MOST_RISE)
    decay = np.exp(model + 2j * np.pi * np.mod(seen.frequency_Hz * time, 1.0))
    piece = velocity[first:stop] - seen.mean[head]
    pick, gain = _variance_change(piece - decay.real, 1e-6 * np.exp(curve[0].real))
    nothing = gain < VARIANCE_GAIN or pick < INSTANT_CYCLES * cycle * sampling_Hz
    still = np.std(piece[:pick]) < 0.5 * np.std(decay[:pick]) if pick > 1 else False
    if first == 0 and (nothing or not still):
        return Release(0.0, 0.0, BEGUN)
    if nothing:
        return Release(float(seen.time[head]), 0.5 * seen.frame_s, _excitation(quiet))
    excitation = AT_ONCE if first == 0 else _excitation(quiet)
    return Release((first + pick) / sampling_Hz, INSTANT_CYCLES * cycle, excitation)


def _variance_change(x: Float[ndarray, " sample"], least: float) -> tuple[int, float]:
    """Sample at which the variance changes most likely, and the gain in log-likelihood."""
    total = np.concatenate([[0.0], np.cumsum(x**2)])
    k = np.arange(VARIANCE_SAMPLES, x.size - VARIANCE_SAMPLES)
    early = total[k] / k + least**2
    late = (total[-1] - total[k]) / (x.size - k) + least**2
    cost = 0.5 * (k * np.log(early) + (x.size - k) * np.log(late))
    best = int(np.argmin(cost))
    whole = 0.5 * x.size * np.log(total[-1] / x.size + least**2)
    return int(k[best]), float(whole - cost[best])
