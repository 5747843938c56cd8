"""Which lines a decay holds besides its mode: found in what the known ones leave over."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy import fft

from bladeroot.decay.envelope_model import Envelopes
from bladeroot.signal.lines import lines_of, magnitudes, one_sided, peaks
from bladeroot.signal.runs import medians

# A line counts from this part of the mode's amplitude on (where it lies above the mode, the more
# the further: frames of whole cycles tell it off), and from this many times the median around it.
LEAST, CLEAR = 3e-3, 8.0
# Nor is one looked for above this part of the sampling frequency.
HIGHEST = 0.48
# Lines of a spectrum that share a median.
CHUNK = 64
# Lines nearer to the mode than this part of its frequency are left to it, unless a known one is
# nearer, or its envelope reaches less far by that factor, and a segment tells them apart by so many
# lines of its spectrum; nearer to one another than that part, or that part of the distance from the
# mode to the nearest, are one.
APART, REACHES, TOLD, SAME, SAME_NEAR = 0.17, 1.25, 8.0, 0.1, 0.3
# Nor is one that lies so near to a louder one (over its frequency) with less than that part of it:
# that is its skirt, where it is chirping.
SKIRT, FAINT = 0.35, 0.03
# Cycles of the mode in the first segment that is searched (samples, at least); each next one ends
# that many times later, so that what is steady is seen beside what then is left of the mode.
# Lines that are added at a time.
FIRST_CYCLES, SHORTEST, LONGER, AT_ONCE = 16.0, 64, 4.0, 3
# Beside a line that is not known yet, what has less than this part of its harm may be its image.
IMAGE = 0.1
# Modes of the campaign within this part of the mode's frequency are looked for by name: where they
# are expected (relative), from this part of the loudest within that many times as far on, in so
# many of their beats.
CLOSE, ABOUT, HEARD, AROUND, RESOLVING = 0.3, 0.04, 0.01, 1.2, 8.0
# A beat is looked for in so many first intervals, before the mode has fallen to that part. Its line
# is over the median one by that factor (by the other one half a segment later, where it turns
# alike within so many turns), and makes the logarithm's change in an interval swing by that much,
# or by that part of its mean.
BEATEN, ALIVE = (20, 40, 80, 160, 266), 0.02
CLEAR_BEAT, AGAIN, ALIKE, SWING, SWAYED = 10.0, 3.0, 1.5, 0.015, 0.2
# A line moves by this part of the distance to the next one at most when it is placed better.
MOVED = 0.1


def more_lines(
    velocity: Float[ndarray, " sample"],
    found: Envelopes,
    sampling_Hz: float,
    slowest_Hz: float,
) -> list[float]:
    """Up to `AT_ONCE` lines (Hz) that what is left over shows clearly, the most harmful first.

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
    return chosen[:AT_ONCE]


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
    peak = peaks(level)
    harm = level * np.minimum(1.0, own_Hz / frequency) / own
    peak &= (harm > LEAST) & (level > CLEAR * floor) & (frequency > max(slowest_Hz, 2.0 * width))
    peak &= frequency < HIGHEST * sampling_Hz
    # within the resolution of a segment what leaks from the mode looks like a line
    others_Hz = found.lines_Hz[1:]
    nearest = np.abs(others_Hz - own_Hz).min(initial=np.inf)
    left = min(APART * own_Hz, nearest, REACHES * 0.5 * sampling_Hz / found.spacing)
    peak &= np.abs(frequency - own_Hz) > max(left, TOLD * width)
    first = min(part.start // found.spacing, found.samples // found.spacing - 1)
    near = slice(first, max(part.stop // found.spacing, first + 1))
    others = range(1, found.lines_Hz.size)
    loud = [float(np.sqrt(np.mean(np.abs(found.envelope(k)[near]) ** 2))) for k in others]
    made = []
    for k in np.flatnonzero(peak):
        away = np.abs(frequency[k] - found.lines_Hz)
        skirt = (away[1:] < SKIRT * found.lines_Hz[1:]) & (level[k] < FAINT * np.array(loud))
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
    count = min(int(RESOLVING * sampling_Hz / apart), x.size)
    frequency, level = magnitudes(x[:count], sampling_Hz)
    wanted = [expected_Hz, *close]
    inside = np.abs(frequency / expected_Hz - 1.0) < AROUND * CLOSE
    heard = level > HEARD * level.max(where=inside, initial=0.0)
    seen = np.flatnonzero(peaks(level) & inside & heard)
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
    best, line = CLEAR_BEAT, []
    if log.size < BEATEN[0]:
        return line
    least = min(SWING, SWAYED * (log[0] - log[-1]).real / log.size)
    for count in BEATEN:
        if count + count // 2 > log.size:
            break
        clear, turns = one_sided(log[:count], least)
        again, then = one_sided(log[count // 2 : count // 2 + count], least)
        # a beat goes on, a bend of the mode's own laws does not
        if clear > best and again > AGAIN and abs(turns - then) * count < ALIKE:
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
