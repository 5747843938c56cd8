"""Where a decay is let go: the last step or bend of the log-phasor near the top of its fall."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.signal.envelope import FRAME_STEPS, Envelope
from bladeroot.signal.turning import Kinks, expected_gain, kinks

# Points on either side of a tested place: enough for a cubic and its scatter; at least so many.
REACH, FEWEST = 12, 7
# The coarsest scale's points reach over this fall of ln A: further, no decay is a plain curve.
COARSEST = 0.8
# Neighbouring frames share samples: so many hold as much as one that stands alone.
OVERLAP = 4.0
# A kink is real when it explains this many times what noise does (1 on average; the scatter has
# 18 degrees of freedom, so 15 comes up once in 100,000 places), and when its step is 2 % or its
# bend this part of the decay rate: less does no harm, and a curved backbone does as much.
GAIN, STEP, BEND = 15.0, 0.02, 0.6
# Frames by which a step may lie before the place found for it.
SURE = 4
# What is struck or let go from rest grows from a tenth to a third within so many cycles (a frame of
# three cycles makes 0.6 of a jump); a shaker takes a third of the mode's time constant.
SUDDEN_CYCLES = 1.2
# A tip leaves within half a cycle and frames see it no better: no bend is surer than this (frames).
LETTING_GO = 0.8
# The release lies within so much of ln A below the peak and this part of the fall: a kink further
# down is the decay's end.
DEEPEST, UPPER = 1.0, 0.3
# A step counts from so many of its standard errors on, and is no bend where a bend that makes as
# much would lie more than so many points away.
STEP_ERRORS, BESIDE = 4.0, 2.0
# Without a kink, what takes that many times as long over its first fall (ln A) as it then would is
# driven until there.
FLAT, SLOWER = 0.1, 3.0
# Least error of ln A and phase that a point is given: no digitiser is better.
BEST = 1e-5
# Before a blow it is quiet: ln A below what follows by the first. A rise begins there and ends at
# the second.
QUIET, RISEN = np.log(10.0), np.log(3.0)
# Frames of the smooth decay that is continued backwards, at least and at most; a parabola from more
# than so many on, else a line. It is not believed to rise by more than this (ln).
SIDE, LONGEST_SIDE, STRAIGHT, HIGHEST = 8, 40, 16, 2.0
# A change of the variance by so many nats is real: less is what any two pieces of noise differ by.
# Samples on either side of it at least.
CHANGE, APART = 30.0, 4
# Where samples tell the instant, to this part of a cycle; what is earlier is none.
INSTANT = 0.1
AT_ONCE = "at once"  # what a blow excites, or what is let go from rest


@dataclass(frozen=True)
class Release:
    """When the decay was let go, standard error of that, and how it had been excited."""

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
    what comes after it is smooth. Where other modes hide it, a steady drive still ends. A bend is
    placed where two smooth sides meet, a step by the raw samples: before it they are not what the
    smooth decay, continued backwards, says.
    """
    depth = min(DEEPEST, UPPER * (level[peak] - level[trough]))
    low = _last_above(level, peak, trough, level[peak] - depth)
    middle = _last_above(level, peak, low, level[peak] - 0.5 * depth)
    pace = max(low - middle, 1) / (0.5 * depth)
    first = max(0, peak - int(pace))
    found = _last_kink(seen, noise, first, low, middle, pace)
    if found is None:
        flat = _last_above(level, peak, trough, level[peak] - FLAT)
        if flat - peak > SLOWER * FLAT * pace + FRAME_STEPS:
            return Release(float(seen.time[flat]), 0.5 * seen.frame_s, "shaker")
        if peak > 3 * FRAME_STEPS:
            quiet = _quiet(seen, peak)
            return Release(float(seen.time[peak]), 0.5 * seen.frame_s, _excitation(quiet))
        return _sudden(velocity, sampling_Hz, seen, None, peak, low)
    quiet = _quiet(seen, found.clean)
    if quiet is None and not found.sudden:
        return Release(found.time_s, found.std_s, _excitation(quiet))
    near = found.clean - FRAME_STEPS - SURE
    if quiet is not None and found.clean - quiet < 2 * REACH:
        near = min(near, quiet - SURE)
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
    error = noise * np.exp(-seen.level[middle]) * np.sqrt(0.5 * OVERLAP)
    coarsest = max(1, int(np.ceil(COARSEST * pace / REACH)))
    sizes = [coarsest >> k for k in range(coarsest.bit_length())]
    # a scale is left out when the next finer one would see a release as well
    fine = [
        size
        for size, finer in zip(sizes, [*sizes[1:], 0], strict=True)
        if not finer or expected_gain(finer / pace, error / finer**0.5, REACH) <= 3.0 * GAIN
    ]
    found, stop = None, low
    for size in fine:
        log, std, start = log_points(seen, noise, first, stop + REACH * size, size)
        reach = min(REACH, log.size // 2)
        if reach < FEWEST:
            continue
        tested = kinks(log, std, reach, +1, max(1.0, OVERLAP / size))
        best = _latest(tested, reach, BEND * size * reach / pace, (low - start) // size)
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
            kink = _Kink(time, max(std_points * size, LETTING_GO) * seen.step_s, clean, False)
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
    """Means of `size` frames each, their standard errors (per part), and the first frame."""
    stop = min(stop, seen.log.size)
    count = (stop - first) // size
    first = stop - count * size
    log = seen.log[first:stop].reshape(count, size).mean(axis=1)
    std = np.minimum(noise * np.exp(-log.real), 1.0) * np.sqrt(0.5 * OVERLAP / size)
    return log, np.maximum(std, BEST), first


def _latest(tested: Kinks, reach: int, turn: float, last: int) -> tuple[int, bool, float] | None:
    """Place of the last kink up to a place `last`; whether it is a step rather than a bend.

    And how many points apart a bend would seem to lie that has such a step beside it.
    """
    step = np.abs(tested.step)
    stepped = (step > STEP) & (step > STEP_ERRORS * tested.step_std)
    bent = (np.abs(tested.bend) * reach > turn) & (tested.bare > GAIN)
    real = np.flatnonzero((tested.gain > GAIN) & (stepped | bent) & (tested.place <= last))
    if not real.size:
        return None
    # a large kink is felt before a place reaches it: it lies where it explains most
    near = np.arange(max(0, real[-1] - 2 * reach), real[-1] + 1)
    best = near[np.argmax(tested.gain[near])]
    shift = step[best] / max(np.abs(tested.bend[best]), 1e-300)
    return int(tested.place[best]), bool(stepped[best] and shift > BESIDE), float(shift)


def _bend(log: Complex[ndarray, " point"], std: Float[ndarray, " later"]) -> tuple[float, float]:
    """Offset from the middle (in points) where two parabolas that meet fit best; its error."""
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
    return "shaker" if quiet is None else AT_ONCE


def _quiet(seen: Envelope, at: int) -> int | None:
    """The last quiet frame before frame `at`, if what led up to `at` was sudden; else None."""
    after = seen.level[min(at + FRAME_STEPS, seen.log.size - 1)]
    quiet = np.flatnonzero(seen.level[: at + 1] < after - QUIET)
    if not quiet.size:
        return None
    # a second blow may have doubled or halved what the first one left
    up = np.flatnonzero(seen.level[quiet[-1] :] > after - RISEN)
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
    """The instant, by the raw samples, from which on they follow the smooth decay.

    It is looked for from frame `near` to frame `clean`, the first known to lie after it; `quiet` is
    the last quiet frame, if there is one, and `low` one where the decay has fallen.
    """
    cycle = 1.0 / seen.frequency_Hz
    head = max(min(clean, seen.log.size - SIDE), 0)
    tail = min(max(low, head + SIDE), head + LONGEST_SIDE, seen.log.size)
    order = 2 if tail - head > STRAIGHT else 1
    polynomial = np.polynomial.polynomial
    curve = polynomial.polyfit(seen.time[head:tail] - seen.time[head], seen.log[head:tail], order)
    first = max(0, int((seen.time[max(near, 0)] - 0.5 * seen.frame_s) * sampling_Hz))
    if near > 0:
        first = int(seen.time[near] * sampling_Hz)
    stop = int((seen.time[head] + 0.5 * seen.frame_s) * sampling_Hz)
    time = np.arange(first, stop) / sampling_Hz
    model = polynomial.polyval(time - seen.time[head], curve)
    model.real = np.minimum(model.real, curve[0].real + HIGHEST)
    decay = np.exp(model + 2j * np.pi * np.mod(seen.frequency_Hz * time, 1.0))
    piece = velocity[first:stop] - seen.mean[head]
    pick, gain = _variance_change(piece - decay.real, 1e-6 * np.exp(curve[0].real))
    nothing = gain < CHANGE or pick < INSTANT * cycle * sampling_Hz
    still = np.std(piece[:pick]) < 0.5 * np.std(decay[:pick]) if pick > 1 else False
    if first == 0 and (nothing or not still):
        return Release(0.0, 0.0, "begins in the decay")
    if nothing:
        return Release(float(seen.time[head]), 0.5 * seen.frame_s, _excitation(quiet))
    excitation = AT_ONCE if first == 0 else _excitation(quiet)
    return Release((first + pick) / sampling_Hz, INSTANT * cycle, excitation)


def _variance_change(x: Float[ndarray, " sample"], least: float) -> tuple[int, float]:
    """Sample at which the variance changes most likely, and the gain in log-likelihood."""
    total = np.concatenate([[0.0], np.cumsum(x**2)])
    k = np.arange(APART, x.size - APART)
    early = total[k] / k + least**2
    late = (total[-1] - total[k]) / (x.size - k) + least**2
    cost = 0.5 * (k * np.log(early) + (x.size - k) * np.log(late))
    best = int(np.argmin(cost))
    whole = 0.5 * x.size * np.log(total[-1] / x.size + least**2)
    return int(k[best]), float(whole - cost[best])
