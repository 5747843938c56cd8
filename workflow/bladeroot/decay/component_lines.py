"""Which lines a decay holds besides its mode: found in what the known ones leave over."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy import fft

from bladeroot.decay.envelope_model import Envelopes
from bladeroot.signal.lines import lines_of, local_maxima, magnitudes, one_sided
from bladeroot.signal.runs import medians

# Which maxima of a spectrum of what is left over count as lines.
LEAST_LINE = 3e-3  # amplitude over the mode's; of a faster line, times their frequencies' ratio
PEAK_OVER_FLOOR = 8.0  # amplitude over the median around it
CHUNK = 64  # neighbouring bins of the spectrum that share a median
HIGHEST = 0.48  # frequency over the sampling frequency

# The spectra are those of segments: the first begins with the decay, each next one where the last
# ends, so that what is steady is seen beside what then is left of the mode.
FIRST_CYCLES = 16.0  # of the mode in the first segment
SHORTEST = 64  # samples of a segment
LONGER = 4.0  # end of a segment over the end of the one before

# A maximum close to the mode is the mode itself, whose envelope varies. Close is what lies within
# the smallest of three distances (APART, ENVELOPE_REACH, and that to the nearest known line), and
# what a segment does not resolve.
APART = 0.17  # distance from the mode over its frequency
ENVELOPE_REACH = 1.25  # times the fastest change that the envelope's knots can follow (Hz)
RESOLVED_BINS = 8.0  # bins of the segment's spectrum
# A maximum is a line that is known already where it is nearer to it than both of these.
SAME = 0.1  # over the maximum's frequency, or the mode's where that is lower
SAME_NEAR = 0.3  # over the distance from the mode to the nearest known line

# A maximum beside a louder known line is that line's skirt: its frequency varies.
SKIRT = 0.35  # distance over the louder one's frequency
SKIRT_LEVEL = 0.03  # amplitude over the louder one's

# Lines are added a few at a time, the most harmful first.
LINES_AT_ONCE = 3
IMAGE = 0.1  # harm over the worst line's: what has less may be an image of that one, and waits

# Modes of the campaign that are close to the one asked for are looked for by name.
CLOSE = 0.3  # distance over the mode's frequency
ABOUT = 0.04  # of a frequency, by which a mode may lie off where the sheet expects it
AUDIBLE = 0.01  # amplitude over the largest in the band that is searched
LOOK_AROUND = 1.2  # times CLOSE: the band that is searched
BEATS_TO_RESOLVE = 8.0  # of the closest two modes in the spectrum

# A mode too close to be seen as a line makes the envelope beat: the envelope's logarithm then has a
# spectral line on one side of zero.
BEAT_SPANS = (20, 40, 80, 160, 266)  # first intervals of the envelope that are searched
ALIVE = 0.02  # envelope over its largest: beyond, it is not searched
BEAT_OVER_MEDIAN = 10.0  # the line over the spectrum's median, in a span
LATER_OVER_MEDIAN = 3.0  # the same in a span that begins half a span later
TURNS_ALIKE = 1.5  # turns a span by which the two spans' lines may differ
SWING = 0.015  # change of the logarithm in an interval that the line makes, at least
SWING_OF_DECAY = 0.2  # the same, over the logarithm's mean fall in an interval

# How far a line's frequency is corrected at most, over the distance to the next line.
MOVED = 0.1


def more_lines(
    velocity: Float[ndarray, " sample"],
    found: Envelopes,
    sampling_Hz: float,
    slowest_Hz: float,
) -> list[float]:
    """Up to `LINES_AT_ONCE` lines (Hz) that stand out of what is left over, the most harmful first.

    found: the envelopes of the lines known so far, the mode's first. slowest_Hz: what is slower is
    known to belong to the baseline.
    """
    own_Hz = float(found.lines_Hz[0])
    mode, rest = found.waves([0], base=False), velocity - found.waves()
    begin, count = 0.0, FIRST_CYCLES * sampling_Hz / own_Hz
    candidates: list[tuple[float, float]] = []
    while count < LONGER * rest.size:
        stop = min(int(count), rest.size)
        size = fft.prev_fast_len(stop - int(begin), real=True)
        begin, count = count, count * LONGER
        if size >= SHORTEST:
            part = slice(stop - size, stop)
            own = float(np.sqrt(2.0 * np.mean(mode[part] ** 2)))
            candidates += _peaks(rest[part], own, found, part, sampling_Hz, slowest_Hz)
    chosen: list[float] = []
    for harm, line in sorted(candidates, reverse=True):
        if harm > IMAGE * max(candidates)[0] and all(
            abs(line - one) > SAME * min(line, own_Hz) for one in chosen
        ):
            chosen.append(line)
    return chosen[:LINES_AT_ONCE]


def _peaks(
    rest: Float[ndarray, " sample"],
    own: float,
    found: Envelopes,
    part: slice,
    sampling_Hz: float,
    slowest_Hz: float,
) -> list[tuple[float, float]]:
    """Clear lines of a segment as (harm, Hz): amplitude over the mode's, by root of the length."""
    own_Hz, size = float(found.lines_Hz[0]), rest.size
    frequency, level = lines_of(rest, sampling_Hz)
    width = sampling_Hz / size
    floor = _floor(level, frequency, found, sampling_Hz)
    peak = local_maxima(level)
    harm = level * np.minimum(1.0, own_Hz / frequency) / own
    peak &= (
        (harm > LEAST_LINE)
        & (level > PEAK_OVER_FLOOR * floor)
        & (frequency > max(slowest_Hz, 2.0 * width))
    )
    peak &= frequency < HIGHEST * sampling_Hz
    # what leaks from the mode looks like a line within the resolution of a segment
    others_Hz = found.lines_Hz[1:]
    nearest = np.abs(others_Hz - own_Hz).min(initial=np.inf)
    left = min(APART * own_Hz, nearest, ENVELOPE_REACH * 0.5 * sampling_Hz / found.spacing)
    peak &= np.abs(frequency - own_Hz) > max(left, RESOLVED_BINS * width)
    first = min(part.start // found.spacing, found.samples // found.spacing - 1)
    near = slice(first, max(part.stop // found.spacing, first + 1))
    others = range(1, found.lines_Hz.size)
    loud = [float(np.sqrt(np.mean(np.abs(found.envelope(k)[near]) ** 2))) for k in others]
    made = []
    for k in np.flatnonzero(peak):
        away = np.abs(frequency[k] - found.lines_Hz)
        skirt = (away[1:] < SKIRT * found.lines_Hz[1:]) & (level[k] < SKIRT_LEVEL * np.array(loud))
        same = min(SAME * min(frequency[k], own_Hz), SAME_NEAR * nearest)
        if skirt.any() or away.min() <= max(same, 2.0 * width):
            continue
        # a parabola through the logarithms: a third of a step at most is left
        before, at, after = np.log(level[k - 1 : k + 2])
        shift = 0.5 * (before - after) / (before - 2.0 * at + after)
        made.append((float(harm[k] * np.sqrt(size)), float(frequency[k] + shift * width)))
    return made


def _floor(
    level: Float[ndarray, " line"],
    frequency: Float[ndarray, " line"],
    found: Envelopes,
    sampling_Hz: float,
) -> Float[ndarray, " line"]:
    """Median level around each frequency; where the known lines' envelopes reach, beside them.

    They follow the noise about their lines, too, as fast as their knots lie: that band is quieter
    than the noise, and noise at its edges would look like lines.
    """
    chunk = min(CHUNK, level.size)
    rows = level[: level.size // chunk * chunk].reshape(-1, chunk)
    floor = medians(rows)
    taken, reach = np.zeros(level.size, bool), 0.5 * sampling_Hz / found.spacing
    for line in (0.0, *found.lines_Hz):
        taken[slice(*np.searchsorted(frequency, [line - reach, line + reach]))] = True
    reached = np.flatnonzero(taken[: rows.size].reshape(rows.shape).any(axis=1))
    beside = np.flatnonzero(~taken)
    if beside.size and reached.size:
        few = min(CHUNK, beside.size)
        beside = beside[: beside.size // few * few].reshape(-1, few)
        middle = frequency[: rows.size].reshape(rows.shape)[reached].mean(axis=1)
        around = np.interp(middle, frequency[beside].mean(axis=1), medians(level[beside]))
        floor[reached] = np.maximum(floor[reached], around)
    return floor[np.minimum(np.arange(level.size) // chunk, floor.size - 1)]


def lines_by_name(
    x: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    modes_Hz: tuple[float, ...],
) -> list[float]:
    """Frequencies of the mode and of known modes close to it, if the spectrum shows each."""
    close = [one for one in modes_Hz if 0.0 < abs(one - expected_Hz) < CLOSE * expected_Hz]
    if not close:
        return []
    apart = min(abs(one - expected_Hz) for one in close)
    count = min(int(BEATS_TO_RESOLVE * sampling_Hz / apart), x.size)
    frequency, level = magnitudes(x[:count], sampling_Hz)
    wanted = [expected_Hz, *close]
    inside = np.abs(frequency / expected_Hz - 1.0) < LOOK_AROUND * CLOSE
    heard = level > AUDIBLE * level.max(where=inside, initial=0.0)
    seen = np.flatnonzero(local_maxima(level) & inside & heard)
    off = [(abs(np.log(frequency[k] / one)), n, k) for n, one in enumerate(wanted) for k in seen]
    found: dict[int, float] = {}
    used: set[int] = set()
    for size, n, k in sorted(off):
        if size < ABOUT and n not in found and k not in used:
            found[n] = float(frequency[k])
            used.add(k)
    return [found[n] for n in sorted(found)] if 0 in found and len(found) > 1 else []


def beating_line(found: Envelopes, sampling_Hz: float) -> list[float]:
    """A line (Hz) too close to the mode to be seen beside it: the mode's envelope beats."""
    z = found.envelope(0)[: found.samples // found.spacing]
    weak = np.flatnonzero(np.abs(z) < ALIVE * np.abs(z).max(initial=0.0))
    z = z[: weak[0]] if weak.size else z
    log = np.log(np.maximum(np.abs(z), 1e-300)) + 1j * np.unwrap(np.angle(z))
    best, line = BEAT_OVER_MEDIAN, []
    if log.size < BEAT_SPANS[0]:
        return line
    least = min(SWING, SWING_OF_DECAY * (log[0] - log[-1]).real / log.size)
    for count in BEAT_SPANS:
        if count + count // 2 > log.size:
            break
        clear, turns = one_sided(log[:count], least)
        again, then = one_sided(log[count // 2 : count // 2 + count], least)
        # a beat goes on, a bend of the mode's own laws does not
        if clear > best and again > LATER_OVER_MEDIAN and abs(turns - then) * count < TURNS_ALIKE:
            best = clear
            line = [float(found.lines_Hz[0] + turns * sampling_Hz / found.spacing)]
    return line


def meant(
    lines: Float[ndarray, " line"], expected_Hz: float, modes_Hz: tuple[float, ...]
) -> Float[ndarray, " line"]:
    """The lines with the mode first, which of two close ones (the first and the last) is meant.

    The one nearer to where it is expected, where the other is left to another mode of the sheet;
    where neither is one's, the louder, unless that is further off than a sheet may be.
    """
    first, last = both = lines[[0, -1]]
    close_Hz = CLOSE * expected_Hz
    near = [
        one
        for one in modes_Hz
        if 0.0 < abs(one - expected_Hz) < close_Hz and np.abs(np.log(both / one)).min() < ABOUT
    ]
    if not near and abs(np.log(first / expected_Hz)) < ABOUT:
        return lines

    def off(own: float, other: float) -> float:
        theirs = min((abs(np.log(other / one)) for one in near), default=0.0)
        return abs(np.log(own / expected_Hz)) + theirs

    swapped = off(last, first) < off(first, last)
    return np.array([last, *lines[1:-1], first]) if swapped else lines


def moved(found: Envelopes, line: int, sampling_Hz: float) -> float:
    """A line's mean frequency, from how its envelope turns, not far from what it was."""
    z = found.envelope(line)
    turn = np.angle(np.vdot(z[:-1], z[1:])) if z.size > 1 else 0.0
    was = float(found.lines_Hz[line])
    other = np.concatenate([[0.0], np.delete(found.lines_Hz, line)])
    most = MOVED * np.abs(other - was).min()
    return was + float(np.clip(turn * sampling_Hz / (2 * np.pi * found.spacing), -most, most))
