"""The components of a decay: the mode asked for by itself, all others found and taken off."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float
from numpy import ndarray
from scipy import fft

from bladeroot.records.envelopes import SHARE, Envelopes, demodulated
from bladeroot.records.lines import loudest, magnitudes, mode_Hz
from bladeroot.records.runs import medians

# Most lines besides the mode, and how often what the known ones leave over is searched for more.
MOST, ROUNDS = 8, 8
# A line counts from this part of the mode's amplitude on (where it lies above the mode, the more
# the further: frames of whole cycles tell it off), and from this many times the median around it.
LEAST, CLEAR = 1e-3, 8.0
# Lines nearer to the mode than this part of its frequency are left to it, and nearer to one another
# than that part are one.
APART, SAME = 0.17, 0.1
# Nor is one that lies so near to a louder one (over its frequency) with less than that part of it:
# that is its skirt, where it is chirping.
SKIRT, FAINT = 0.35, 0.03
# Cycles of the mode in the shortest stretch that is searched; each next one is longer by a factor.
FIRST_CYCLES, LONGER = 16.0, 4.0
# What lies below this part of the mode's frequency belongs to the baseline, which is then followed
# up to this multiple of it, but not beyond this part of the mode's frequency.
LOW, ABOVE, HIGHEST = 0.15, 2.5, 0.45
# Harmonics of lines from this part of the mode's amplitude on may lie nearer, but not nearer than
# the other part of its frequency.
OVERTONES, NEAREST = 0.3, 0.05
# Knots in the time in which the mode and its nearest neighbour differ by a turn; fewest cycles of
# the mode from knot to knot; most intervals.
KNOTS, FEWEST_CYCLES, INTERVALS = 0.8, 1.5, 400
# A blow rises to this part of the record's largest step out of what is quieter than that part, and
# within two cycles of the mode to that part of it.
RISEN, QUIET, SUDDEN, FEWEST_QUIET = 0.1, 0.03, 0.3, 8
# Its contact lasts as long as the components leave over this many times what they do later; the
# start is moved so many times at most.
STRUCK, AGAIN, BLOWS = 1.7, 6.0, 4
# A mode has drowned where its envelope is no more than so many times what is left of it at the end,
# if it began so many times higher; fewest cycles that are left to a decay.
ABOVE_FLOOR, DEEP, LIFE_CYCLES = 2.0, 30.0, 12.0
# Modes of the campaign within this part of the mode's frequency are looked for by name: where they
# are expected (relative), from this part of the loudest on, in so many of their beats.
CLOSE, ABOUT, HEARD, RESOLVING = 0.3, 0.04, 0.03, 8.0
# Part of what two notions of smoothness differ by that is taken as a standard error.
DOUBT = 0.5
# A line moves by this part of the distance to the next one at most when it is placed better.
MOVED = 0.1
# An envelope is followed down to this many of its standard errors.
LOST = 4.0


@dataclass(frozen=True)
class Separated:
    """A record with one mode only from sample `first` on: what is left, and what was taken off.

    `lines_Hz`: frequencies of what was taken off, strongest first. `time` (s, from the record's
    start) and `widening`: by how much the standard error of the mode's phasor is larger than if it
    were alone; `doubt` is by how much (relative) it depends on how smooth the others are taken to
    be, as an error of independent cycles.
    """

    velocity: Float[ndarray, " sample"]
    first: int
    lines_Hz: list[float]
    time: Float[ndarray, " knot"]
    widening: Float[ndarray, " knot"]
    doubt: Float[ndarray, " knot"]


def separated(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    modes_Hz: tuple[float, ...] = (),
    first: int = 0,
    usable: Bool[ndarray, " sample"] | None = None,
) -> Separated:
    """A record whose decay begins at a sample, without all that is not the mode, nor noise."""
    x = velocity[first:]
    known = None if usable is None else usable[first:]
    own_Hz = mode_Hz(*loudest(x, sampling_Hz, expected_Hz), expected_Hz)
    lines = np.array(_told_apart(x, sampling_Hz, expected_Hz, modes_Hz) or [own_Hz])
    own_Hz, base_Hz = float(lines[0]), 0.0
    trimmed = False
    for turn in range(ROUNDS):
        found = _followed(x, sampling_Hz, lines, base_Hz, known)
        lines = np.array([_moved(found, k, sampling_Hz) for k in range(lines.size)])
        more = _more_lines(x, found, sampling_Hz, lines, base_Hz, known)
        if not trimmed and (turn or not more):
            last, trimmed = _lasting(found), True
            x, known = x[:last], None if known is None else known[:last]
            if last < found.samples:
                continue
        if not more:
            break
        slow = [line for line in more if line < LOW * own_Hz]
        base_Hz = max([base_Hz, *(min(ABOVE * line, HIGHEST * own_Hz) for line in slow)])
        fast = [line for line in more if line >= LOW * own_Hz][: MOST + 1 - lines.size]
        lines = np.concatenate([lines, fast])
    overtones = _overtones(found, lines)
    lines = np.concatenate([lines, overtones])
    if lines.size == 1 and not base_Hz:
        return Separated(velocity, first, [], *np.zeros((3, 0)))
    for _ in range(BLOWS):
        found = _followed(x, sampling_Hz, lines, base_Hz, known)
        struck = _struck(x - found.waves(), found.spacing)
        if not struck or x.size - struck < FEWEST_CYCLES * LIFE_CYCLES * sampling_Hz / own_Hz:
            break
        first += struck
        x, known = x[struck:], None if known is None else known[struck:]
        found = _followed(x, sampling_Hz, lines, base_Hz, known)
    course = np.stack([_course(found, k) for k in range(lines.size)])
    spacing, before = found.spacing, found.envelope(0)
    found = demodulated(x, sampling_Hz, lines, spacing, known, base_Hz, course)
    single = demodulated(x, sampling_Hz, lines[:1], spacing, known, 0.0, course[:1])
    widening = np.sqrt(np.maximum(found.variance(0) / single.variance(0), 1.0))
    nearest = np.abs(np.concatenate([[0.0], lines[1:]]) - own_Hz).min()
    doubt = np.abs(found.envelope(0) - before) / np.maximum(np.abs(found.envelope(0)), 1e-300)
    doubt = np.minimum(doubt, 1.0) * DOUBT * np.sqrt(own_Hz / (SHARE * nearest))
    others = list(range(1, lines.size))
    left = velocity[: first + x.size].copy()
    left[first:] -= found.waves(others)
    time = (first + (np.arange(widening.size) + 0.5) * spacing) / sampling_Hz
    loud = np.argsort([-np.abs(found.envelope(k)).max() for k in others])
    return Separated(left, first, [float(lines[1 + k]) for k in loud], time, widening, doubt)


def onset(velocity: Float[ndarray, " sample"], cycle: float) -> int:
    """The sample in which something strikes what was quiet; 0 for a record that begins in motion.

    A blow shows in all modes at once, and to the sample. cycle: samples in a cycle of the mode.
    """
    size = np.abs(np.diff(velocity, prepend=velocity[0]))  # without offset and drift
    first = int(np.argmax(size > RISEN * size.max()))
    quiet = size[:first]
    if first < FEWEST_QUIET or np.sqrt(np.mean(quiet**2)) > QUIET * size.max():
        return 0
    return first if size[first : first + int(2 * cycle) + 1].max() > SUDDEN * size.max() else 0


def _lasting(found: Envelopes) -> int:
    """Samples until the mode has drowned in what its envelope shows where nothing is left of it."""
    size = np.abs(found.envelope(0))
    size = np.maximum.accumulate(size[::-1])[::-1]
    floor = float(np.median(size[-max(size.size // 5, 1) :]))
    if size[0] < DEEP * floor:
        return found.samples
    last = int(np.flatnonzero(size > ABOVE_FLOOR * floor)[-1])
    return min(int((1.1 * last + 4) * found.spacing), found.samples)


def _struck(rest: Float[ndarray, " sample"], spacing: int, blocks: int = 4) -> int:
    """Samples at the start in which what is left over is far more than after: a blow's contact."""
    length = max(spacing // blocks, 4)
    count = min(rest.size // length, 3 * blocks)
    if count < 3 * blocks:
        return 0
    power = np.sqrt(np.mean(rest[: count * length].reshape(-1, length) ** 2, axis=1))
    at = 0
    while at < blocks and power[at] > STRUCK * np.median(power[at + 1 : at + 1 + blocks]):
        at += 1
    return at * length


def _followed(velocity, sampling_Hz, lines, base_Hz, usable) -> Envelopes:
    own_Hz = lines[0]
    nearest = np.abs(np.concatenate([[0.0], lines[1:]]) - own_Hz).min()
    spacing = max(KNOTS / nearest, FEWEST_CYCLES / own_Hz)
    spacing = min(spacing, 0.5 / max(base_Hz, 1e-9))
    spacing = int(max(spacing * sampling_Hz, velocity.size / INTERVALS, 8.0))
    return demodulated(velocity, sampling_Hz, lines, spacing, usable, base_Hz)


def _more_lines(velocity, found, sampling_Hz, lines, base_Hz, usable) -> list[float]:
    own_Hz = lines[0]
    mode = found.waves([0], base=False)
    rest = velocity - found.waves()
    if usable is not None:
        rest = np.where(usable, rest, 0.0)
    count = FIRST_CYCLES * sampling_Hz / own_Hz
    candidates: list[tuple[float, float]] = []
    while count < LONGER * rest.size:
        size = fft.prev_fast_len(min(int(count), rest.size), real=True)
        count *= LONGER
        if size < 64:
            continue
        own = float(np.sqrt(2.0 * np.mean(mode[:size] ** 2)))
        spectrum = fft.rfft(rest[:size])
        level = np.abs(spectrum[1:-1] - 0.5 * (spectrum[:-2] + spectrum[2:])) * (2.0 / size)
        width = sampling_Hz / size
        frequency = np.arange(1, level.size + 1) * width
        chunk = min(64, level.size)
        whole = level[: level.size // chunk * chunk].reshape(-1, chunk)
        floor = np.repeat(medians(whole), chunk)
        floor = np.concatenate([floor, np.full(level.size - floor.size, floor[-1])])
        peak = np.zeros(level.size, bool)
        peak[1:-1] = (level[1:-1] > level[:-2]) & (level[1:-1] >= level[2:])
        harm = level * np.minimum(1.0, own_Hz / frequency) / own
        peak &= (harm > LEAST) & (level > CLEAR * floor)
        peak &= (frequency > base_Hz / ABOVE * 1.05) | (frequency > LOW * own_Hz)
        peak &= (frequency > 2.0 * width) & (frequency < 0.48 * sampling_Hz)
        peak &= np.abs(frequency - own_Hz) > max(APART * own_Hz, 8.0 * width)
        last = max(size // found.spacing, 1)
        loud = [
            float(np.sqrt(np.mean(np.abs(found.envelope(j)[:last]) ** 2)))
            for j in range(1, lines.size)
        ]
        for k in np.flatnonzero(peak):
            if any(
                abs(frequency[k] - line) < SKIRT * line and level[k] < FAINT * one
                for line, one in zip(lines[1:], loud, strict=True)
            ):
                continue
            near = max(SAME * min(frequency[k], own_Hz), 2.0 * width)
            if np.abs(frequency[k] - lines).min() > near:
                # parabola through the logarithms: a third of a bin at most is left
                before, at, after = np.log(level[k - 1 : k + 2])
                shift = 0.5 * (before - after) / (before - 2.0 * at + after)
                score = harm[k] * np.sqrt(size)
                candidates.append((float(score), float(frequency[k] + shift * width)))
    chosen: list[float] = []
    for _, line in sorted(candidates, reverse=True):
        if all(abs(line - one) > max(SAME * min(line, own_Hz), 0.0) for one in chosen):
            chosen.append(line)
    return chosen[:3]


def _told_apart(
    x: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    modes_Hz: tuple[float, ...],
) -> list[float]:
    """Frequencies of the mode and of known modes close to it, if the spectrum shows each of them."""
    close = [one for one in modes_Hz if 0.0 < abs(one - expected_Hz) < CLOSE * expected_Hz]
    if not close:
        return []
    apart = min(abs(one - expected_Hz) for one in close)
    count = min(int(RESOLVING * sampling_Hz / apart), x.size)
    frequency, level = magnitudes(x[:count], sampling_Hz)
    wanted = [expected_Hz, *close]
    inside = np.abs(frequency / expected_Hz - 1.0) < 1.2 * CLOSE
    peak = np.zeros(level.size, bool)
    peak[1:-1] = (level[1:-1] > level[:-2]) & (level[1:-1] >= level[2:]) & inside[1:-1]
    peaks = np.flatnonzero(peak & (level > HEARD * level.max(where=inside, initial=0.0)))
    off = [(abs(np.log(frequency[k] / one)), n, k) for n, one in enumerate(wanted) for k in peaks]
    found: dict[int, float] = {}
    used: set[int] = set()
    for size, n, k in sorted(off):
        if size < ABOUT and n not in found and k not in used:
            found[n] = float(frequency[k])
            used.add(k)
    return [found[n] for n in sorted(found)] if 0 in found and len(found) > 1 else []


def _overtones(found: Envelopes, lines: ndarray) -> list[float]:
    """Second and third harmonics of loud lines that lie too near to the mode to be seen beside it."""
    size = [np.abs(found.envelope(k)).max() for k in range(lines.size)]
    near = [
        order * line
        for line, own in zip(lines[1:], size[1:], strict=True)
        for order in (2, 3)
        if own > OVERTONES * size[0]
    ]
    near = [one for one in near if abs(one - lines[0]) < APART * lines[0]]
    return [one for one in near if np.abs(one - lines).min() > NEAREST * lines[0]]


def _moved(found: Envelopes, line: int, sampling_Hz: float) -> float:
    """A line's mean frequency, from how its envelope turns, not far from what it was."""
    z = found.envelope(line)
    turn = np.angle(np.vdot(z[:-1], z[1:])) if z.size > 1 else 0.0
    was = float(found.lines_Hz[line])
    other = np.concatenate([[0.0], np.delete(found.lines_Hz, line)])
    most = MOVED * np.abs(other - was).min()
    return was + float(np.clip(turn * sampling_Hz / (2 * np.pi * found.spacing), -most, most))


def _course(found: Envelopes, line: int) -> Complex[ndarray, " knot"]:
    """The logarithm of a line's envelope at the knots, smoothed; level where it is lost."""
    z = found.envelope(line)
    steps = z[1:] * z[:-1].conj()
    power = np.abs(z[:-1]) ** 2
    reach = 2
    kernel = np.ones(2 * reach + 1)
    advance = np.convolve(steps, kernel, mode="same") / np.maximum(
        np.convolve(power, kernel, mode="same"), 1e-300
    )
    rate = np.log(np.maximum(np.abs(advance), 0.05)) + 1j * np.angle(advance)
    log = np.concatenate([[0.0], np.cumsum(rate)]) + np.log(max(abs(z[0]), 1e-300))
    middle = np.arange(log.size)
    at = np.arange(log.size + 3) - 1.5
    slope0, slope1 = rate[0], rate[-1]
    inside = np.interp(at, middle, log.real) + 1j * np.interp(at, middle, log.imag)
    inside = inside + slope0 * np.minimum(at, 0.0) + slope1 * np.maximum(at - middle[-1], 0.0)
    inside.real = np.maximum(inside.real, inside.real.max() - 12.0)
    return inside
