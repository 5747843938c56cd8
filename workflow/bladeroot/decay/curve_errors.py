"""What a curve's standard errors hold beside noise: what is no law of amplitude, and how it starts.

A law of amplitude bends a few times while a mode decays. A gain that sways, another mode's rest, a
touch or a slip of phase show in a derivative of ln A or phase as what no law does, and the standard
error there is as large as that.
"""

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray
from numpy.lib.stride_tricks import sliding_window_view
from scipy.signal import find_peaks

from bladeroot.signal.phasors import Phasors
from bladeroot.signal.runs import runs

# The first blocks, in which a blow or a drive may still act (`acting`). They are compared with a
# parabola in time through twice as many later blocks.
STARTS = (12, 6, 3)  # numbers of first blocks that are tried, in turn
UNLIKE = 1.5  # mean square of what the first half of them miss, over its variance, that tells
LIKE = 0.8  # the same of as many blocks that follow: of more, the mode's own law is no parabola
BENDS = 0.25  # part of the parabola's difference from a straight line that is in the variance
PLAIN = 2.0  # fall of ln A in all those blocks, beyond which no law is a parabola in time

# A drive that ends (`driven`). As a mode decays its damping rises no faster than A to this power;
# that of Coulomb friction rises with the first.
STEEPEST = 2.0
DRIVEN_FALL = 0.3  # of ln A from the start, in which it is looked for
DRIVEN_ERRORS = 3.0  # standard errors by which the damping is too small

# A free mode gains nothing (`gains`).
GAIN_ERRORS = 3.0  # standard errors by which it does where another one is followed, or acts on it
GAIN_REACH = 2  # times their number, points on either side that are as wrong

# What waves all along a decay is no law of amplitude, which bends a few times (`waves`).
SEGMENT = 1.0  # fall of ln A in a segment through which a parabola in ln A is laid
FEWEST_SEGMENTS = 4
FEWEST_WAVING = 3  # segments that miss their parabola by more than noise lets them
POINTS_EACH = 8  # fewest, in a segment

# What beats in a part of a decay alone is none either (`beats`).
TURNS = 5  # turning points of a rate
TURNS_WITHIN = 2.0  # fall of ln A between the first and the last of them
TURNS_CLEAR = 3.0  # standard errors by which each stands out of its neighbours

# What stands out where ln A falls by next to nothing is none (`bumps`): a touch, a slip of phase.
BUMP_WITHIN = 0.2  # fall of ln A over its width at half its height
BUMP_CLEAR = 6.0  # standard errors by which it stands out
BUMP_REACH = 1.5  # times that width, on either side, that are as wrong

# What else rings, and how laws bend, is largest at the start, where a curve has one side only. The
# standard error of the first point is larger by this part, which falls by e in so many blocks:
# three errors of the first six points then hold as often as those of the others
# (benchmarks/real_like.py, seeds 62200 to 62379).
START = 1.25
START_BLOCKS = 3.0
# The worse the loss factor is known, the less sure is how well: errors of both rates are larger by
# so many times its relative error, up to that, if not at the start by more. Three errors then hold
# as often where it is known to 5 to 20 % as where it is known better (seeds 62200 to 63699).
WEAK, WEAKEST = 4.0, 0.2


def widened(
    value: Float[ndarray, "order part point"],
    std: Float[ndarray, "order part point"],
    act: Float[ndarray, " point"],
    since: Float[ndarray, " point"],
) -> Float[ndarray, "order part point"]:
    """Standard errors of ln A, phase and two derivatives with all that this file looks for.

    value: ln A and phase, and their derivatives; std: their standard errors from noise; act: as of
    `acting`; since: blocks from the start.
    """
    level, wide = value[0, 0], std.copy()
    for order in (1, 2):
        rates, error = value[order], std[order]
        sways = [waves(level, *one) for one in zip(rates, error, strict=True)]
        wide[order] = np.hypot(error, np.maximum(sways, beats(level, rates, error)))
    act = np.hypot(act, gains(value[1, 0], wide[1, 0]))
    wide[1] = np.hypot(wide[1], np.hypot(act, driven(level, -value[1, 0], wide[1, 0])))
    # what is unsure at the start is so for some blocks more
    blocks = since / START_BLOCKS
    wide[1:] = np.exp(
        np.maximum.accumulate(np.log(np.maximum(wide[1:], 1e-300)) + blocks, axis=-1) - blocks
    )
    for order in (1, 2):
        wide[order] = np.hypot(wide[order], bumps(level, value[order], std[order]))
    return wide


def factors(
    unsure: Float[ndarray, " point"], since: Float[ndarray, " point"]
) -> tuple[Float[ndarray, " point"], Float[ndarray, " point"]]:
    """By how much a curve's standard errors are larger: that of the amplitude, those of the rates.

    unsure: standard error over the loss factor; since: blocks from the start.
    """
    start = 1.0 + START * np.exp(-since / START_BLOCKS)
    return start, np.maximum(start, 1.0 + WEAK * np.minimum(unsure, WEAKEST))


def waves(
    level: Float[ndarray, " point"], rate: Float[ndarray, " point"], std: Float[ndarray, " point"]
) -> Float[ndarray, " point"]:
    """Standard error of a derivative of ln A or phase for what sways: a gain, another mode's rest.

    A law of amplitude bends a few times over a decay. What waves about a parabola in ln A in many
    of its segments, by more than noise lets it, is no law; a kink does so in one or two of them.
    The error holds in a segment and in its neighbours.

    level: ln A; rate: the derivative; std: its standard error.
    """
    segments = int((level.max() - level.min()) / SEGMENT)
    if segments < FEWEST_SEGMENTS or level.size < POINTS_EACH * segments:
        return np.zeros(level.size)
    left, noise = np.empty((2, segments))
    parts = np.array_split(np.arange(level.size), segments)
    for k, part in enumerate(parts):
        powers = np.vander(np.linspace(-1.0, 1.0, part.size), 3)
        off = rate[part] - powers @ np.linalg.lstsq(powers, rate[part], rcond=None)[0]
        left[k], noise[k] = np.mean(off**2), np.mean(std[part] ** 2)
    if np.count_nonzero(left > 2.0 * noise) < FEWEST_WAVING:
        return np.zeros(level.size)
    near = np.max(sliding_window_view(np.pad(left, 1), 3), axis=1)
    return np.repeat(np.sqrt(near), [part.size for part in parts])


def beats(
    level: Float[ndarray, " point"],
    rates: Float[ndarray, "part point"],
    std: Float[ndarray, "part point"],
) -> Float[ndarray, "part point"]:
    """Standard errors of derivatives of ln A and phase for what beats in a part of a decay alone.

    A law of amplitude turns a few times over a decay. Where a rate turns as often while ln A falls
    by little, and by more than noise lets it, its error is half of what it swings by, a wave before
    and half a wave after included: another mode that dies sooner. It sways ln A as it does phase,
    so that the error of ln A's derivative is as large, if that moves by so much.

    level: ln A; rates: a derivative of ln A and that of the phase; std: their standard errors.
    """
    error = np.zeros(rates.shape)
    for part, (rate, noise) in enumerate(zip(rates, std, strict=True)):
        sides = [find_peaks(side, prominence=TURNS_CLEAR * noise)[0] for side in (rate, -rate)]
        turns = np.sort(np.concatenate(sides))
        fall = level[turns[: 1 - TURNS]] - level[turns[TURNS - 1 :]]
        for first in np.flatnonzero(fall < TURNS_WITHIN):
            some = turns[first : first + TURNS]
            begin, end = 3 * some[0] - 2 * some[1], 2 * some[-1] - some[-2]
            here = np.arange(max(begin, 0), min(end + 1, rate.size))
            swing = 0.5 * np.abs(np.diff(rate[some]))
            swing = np.interp(here, 0.5 * (some[1:] + some[:-1]), swing)
            for other in range(part + 1):
                most = 0.5 * np.ptp(rates[other, here])
                error[other, here] = np.maximum(error[other, here], np.minimum(swing, most))
    return error


def bumps(
    level: Float[ndarray, " point"],
    rates: Float[ndarray, "part point"],
    std: Float[ndarray, "part point"],
) -> Float[ndarray, "part point"]:
    """Standard errors of derivatives of ln A and phase where one has a bump too narrow for a law.

    level: ln A; rates: a derivative of ln A and that of the phase; std: their standard errors.
    """
    error, own = np.zeros(rates.shape), np.arange(float(level.size))
    for rate, noise in zip(rates, std, strict=True):
        for side in (rate, -rate):
            peaks, found = find_peaks(side, prominence=BUMP_CLEAR * noise, width=1)
            first, last = (np.interp(found[name], own, level) for name in ("left_ips", "right_ips"))
            facts = (peaks, BUMP_REACH * found["widths"], found["prominences"], first - last)
            for at, reach, size, fall in zip(*facts, strict=True):
                if fall < BUMP_WITHIN:
                    near = slice(max(int(at - reach), 0), int(at + reach) + 2)
                    most = 0.5 * np.minimum(size, np.ptp(rates[:, near], axis=1))[:, None]
                    error[:, near] = np.maximum(error[:, near], most)
    return error


def acting(blocks: Phasors) -> Float[ndarray, " block"]:
    """Standard error of either rate (1/s) in blocks in which something may still act: the first.

    What they miss of those that follow grows by so much, if these are alike: what misses its errors
    further on, too, is the mode's own law, or sways all along.
    """
    error = np.zeros(blocks.time.size)
    for count in STARTS:
        miss, unlike = _missed(blocks, 0, count)
        if unlike > UNLIKE and _missed(blocks, count, count)[1] < LIKE:
            error[:count] = np.abs(np.gradient(miss, blocks.time[:count]))
            break
    return error


def _missed(blocks: Phasors, first: int, count: int) -> tuple[Complex[ndarray, " early"], float]:
    """What so many blocks miss of a parabola through twice as many later ones.

    And the mean square, in errors, of the first half of them; NaN where nothing can be said.
    """
    early, later = slice(count), slice(count, 3 * count)
    near = slice(first, first + 3 * count)
    time, log, std = (one[near] for one in (blocks.time, blocks.log, blocks.std))
    if blocks.time.size < first + 4 * count or log[0].real - log[-1].real > PLAIN:
        return np.zeros(count, complex), np.nan
    x = (time - time[count]) / (time[-1] - time[count])
    misses = []
    for terms in (2, 3):
        powers = np.vander(x, terms, increasing=True)
        inverse = np.linalg.pinv(powers[later] / std[later, None])
        misses.append(log - powers @ (inverse @ (log[later] / std[later])))
    straight, bent = misses
    variance = std[early] ** 2 + np.sum((powers[early] @ inverse) ** 2, axis=1)
    variance += (BENDS * np.abs(bent - straight)[early]) ** 2
    missed = 0.5 * np.abs(bent[early]) ** 2 / variance
    return bent[early], float(np.mean(missed[: (count + 1) // 2]))


def gains(
    growth: Float[ndarray, " point"], std: Float[ndarray, " point"]
) -> Float[ndarray, " point"]:
    """Standard error of either rate (1/s) where a mode gains, as no free one does.

    growth: the rate at which ln A rises (1/s); std: its standard error.
    """
    error = np.zeros(growth.size)
    for first, stop in runs(growth > GAIN_ERRORS * std):
        reach = GAIN_REACH * (stop - first)
        near = slice(max(first - reach, 0), stop + reach)
        error[near] = np.maximum(error[near], growth[first:stop].max())
    return error


def driven(
    level: Float[ndarray, " point"], decay: Float[ndarray, " point"], std: Float[ndarray, " point"]
) -> Float[ndarray, " point"]:
    """Standard error of either rate (1/s) at the start, where a drive may still hold the mode up.

    There the mode decays more slowly than any law lets it, by what it does soon after. A drive that
    acts at one time has acted before.

    level: ln A; decay: the rate at which it falls (1/s); std: its standard error.
    """
    count = int(np.argmax(np.append(level < level[0] - DRIVEN_FALL, True)))
    fall, own, error = level[0] - level[:count], decay[:count], std[:count]
    least = own * np.exp(-STEEPEST * (fall - fall[:, None]))
    miss = np.triu(least - own[:, None], 1)
    clear = miss > DRIVEN_ERRORS * np.hypot(error, error[:, None])
    acts = np.where(clear, miss, 0.0).max(axis=1, initial=0.0)
    found = np.zeros(level.size)
    found[:count] = np.maximum.accumulate(acts[::-1])[::-1]
    return found
