"""The components of a decay: the mode asked for by itself, all others found and taken off."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray
from numpy.lib.stride_tricks import sliding_window_view

from bladeroot.decay.component_lines import (
    ABOUT,
    APART,
    LEAST_LINE,
    beating_line,
    lines_by_name,
    meant,
    more_lines,
    moved,
)
from bladeroot.decay.envelope_model import ENVELOPE_BANDWIDTH, Beside, Envelopes, demodulated
from bladeroot.decay.harmonic import clearest_harmonic, veiled_harmonics
from bladeroot.decay.steady import REMARK as STEADY
from bladeroot.decay.steady import STEADY_DECAY_RATIO, steady_line
from bladeroot.decay.twofold import twofold
from bladeroot.signal.lines import CLOSE_MODE_DISTANCE, LOUD_CYCLES, loudest, mode_Hz

# The search for lines in what the known ones leave over.
MOST_LINES = 8  # besides the mode
ROUNDS = 8  # of following all that is known, and searching what is left over

# What is slow is no line but the baseline, which splines follow as they do envelopes.
LOW = 0.15  # frequency over the mode's: what is slower is the baseline's
ABOVE = 2.5  # the baseline is followed up to this many times the frequency of what it holds,
HIGHEST = 0.45  # but no further than this part of the mode's frequency
FOLLOWED = 1.05  # a maximum up to this many times as fast as what it holds is the baseline's, too

# Distance of an envelope's knots: as short as telling the mode from its nearest neighbour needs.
KNOTS = 0.8  # in turns by which the two differ
FEWEST_CYCLES = 1.5  # of the mode
FEWEST_SAMPLES = 8.0
MOST_INTERVALS = 400  # of a record, which bounds the cost of a long one

# A blow is seen in the changes from sample to sample, a smooth release in those of means, over the
# largest of the record.
RISEN = 0.1  # the blow begins with the first change above this,
QUIET = 0.03  # where the changes before are smaller than this (rms)
SUDDEN = 0.3  # and one within two cycles of the mode is larger than this
FEWEST_QUIET = 8  # samples, or means, before the blow
MEANS_A_CYCLE = (8, 4)  # that a smooth release is looked for in, one after the other

# Something still acts at the start (a blow's contact, a drive that fades) where the rms of what the
# components leave over in a part of an interval is larger than all of these; the decay then begins
# after it.
STILL_ACTS = 3.0  # times the largest rms of the next two intervals
BURST = 4.0  # times the median rms
HARMFUL = 0.01  # of the mode's envelope
EARLY = 24  # first intervals in which it is looked for
BLOWS = 4  # the start is moved so many times at most
# The mode is driven still where its envelope grows beyond the sum of these.
GROWN = 1.02  # times its first value
GROWN_NOISES = 6.0  # times its standard error

# A mode has drowned where its envelope is but a floor, which its last fifth shows.
ABOVE_FLOOR = 2.0  # envelope over the floor where the mode is lost
DEEP = 30.0  # envelope's start over the floor: of less, no floor is seen yet
FALLING = 0.85  # median over that of a tenth of the record earlier: what is less falls still
LONGER = 1.1  # the record is kept for this many times the time until then,
MORE_INTERVALS = 4  # and so many intervals more
LIFE_CYCLES = 16.0  # of the mode, that must be left after a blow

# Envelopes are fitted twice, with two notions of what is smooth. The mode is uncertain by what the
# two differ by and by what neither follows.
DOUBT = 0.5  # part of that which is a standard error; set on drawn records of close modes
ALIKE = 2  # intervals on either side that share the largest difference, which passes through zero
CLOSE_MODE = (
    "two modes beat, near {:.5g} and {:.5g} Hz: the first is taken for the one that is asked for, "
    "the other is taken off; name both: modes of a campaign, other_modes_Hz in Python"
)
# The course of an envelope's logarithm, to which a second fit's smoothness refers.
DEEPEST = 12.0  # fall of ln A below its top: what is lower is noise
SLOPE_REACH = 2  # intervals on either side whose mean is its slope


@dataclass(frozen=True)
class Separated:
    """A record with one mode only from sample `first` on: what is left, and what was taken off.

    `lines_Hz`: frequencies of what was taken off, strongest first. At `time` (s, from the record's
    start) `widening` is by how much the standard error of the mode's phasor is larger than if it
    were alone, and `doubt` by how much (relative) the phasor depends on how smooth the others are
    taken to be, as an error of independent cycles. `remarks`: findings, by id. `crowded`: there are
    more lines than are followed.
    """

    velocity: Float[ndarray, " sample"]
    first: int
    lines_Hz: list[float]
    time: Float[ndarray, " knot"]
    widening: Float[ndarray, " knot"]
    doubt: Float[ndarray, " knot"]
    remarks: tuple[tuple[str, str], ...] = ()
    crowded: bool = False


def separated(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    modes_Hz: tuple[float, ...] = (),
    first: int = 0,
    blows: int = BLOWS,
    quiet: int = 0,
) -> Separated:
    """A record whose decay begins at a sample, without all that is not the mode, nor noise.

    velocity: m/s; as it is, if nothing else is found. It ends where the mode has drowned in the
    noise. modes_Hz: where other modes are expected; close ones are separated from it.
    first: the sample in which the decay begins, moved on (so many `blows` times at most) where
    what is left over shows that something still acts: a blow's contact, a drive that fades, a
    second blow. quiet: so many samples at the record's start come before all that.

    All components are followed at once (`decay.envelope_model`), first with none of their
    courses known, then with what that found of them; where the two differ the result depends on how
    smooth they are taken to be.
    """
    short = (velocity.size - first) * expected_Hz < 2.0 * FEWEST_CYCLES * sampling_Hz
    if short or not velocity[first:].any():
        return Separated(velocity, first, [], *np.zeros((3, 0)))
    search = _Search(velocity, first, quiet, sampling_Hz, expected_Hz, modes_Hz)
    if abs(search.own_Hz / expected_Hz - 1.0) > APART:  # so far off that others may be its own
        return Separated(velocity, first, [], *np.zeros((3, 0)))
    found = search.followed()
    x, lines, base_Hz, own_Hz = search.decay, search.lines, search.base_Hz, search.own_Hz
    near = search.beside + veiled_harmonics(x, found, sampling_Hz, search.beside)
    lone = lines.size == 1 and not base_Hz and not near and not _sways(found)
    if not lone:
        found = _followed(x, sampling_Hz, lines, base_Hz)
    acts = _still_acts(found, x, sampling_Hz, lines, base_Hz)
    if blows and acts and x.size - acts >= LIFE_CYCLES * sampling_Hz / own_Hz:
        # lines that were found in what is not free are no lines
        again = velocity, sampling_Hz, expected_Hz, modes_Hz, first + acts, blows - 1, quiet
        return separated(*again)
    if lone:
        return Separated(search.velocity, first, [], *np.zeros((3, 0)))
    course, before = np.stack([_course(found, k) for k in range(lines.size)]), found.envelope(0)
    found = demodulated(x, sampling_Hz, lines, found.spacing, base_Hz, course)
    time = (first + (np.arange(before.size) + 0.5) * found.spacing) / sampling_Hz
    doubt = _doubt(found, before, x, sampling_Hz, own_Hz)
    for one in near:
        doubt = np.hypot(doubt, one.doubt(found.envelope(0), time - first / sampling_Hz))
    single = demodulated(
        x, sampling_Hz, lines[:1], found.spacing, course=course[:1], beside=lines[1:]
    )
    widening = np.sqrt(np.maximum(found.variance(0) / single.variance(0), 1.0))
    others = list(range(1, lines.size))
    left = search.velocity[: first + x.size].copy()
    left[first:] -= found.waves(others)
    loud = np.argsort([-np.abs(found.envelope(k)).max() for k in others])
    taken_Hz = [float(lines[1 + k]) for k in loud] + [
        one.frequency_Hz for one in near if one.wave.any()
    ]
    remarks = tuple((one.finding, one.remark) for one in near)
    if search.close and abs(search.close[0] / own_Hz - 1.0) < CLOSE_MODE_DISTANCE:
        k = 1 + int(np.argmin(np.abs(lines[1:] - search.close[0])))
        remarks += (_beside_it(found, k),)
    return Separated(left, first, taken_Hz, time, widening, doubt, remarks, search.crowded)


class _Search:
    """What is known of a decay's components while they are looked for.

    velocity: the record, `decay` its samples from the decay's start on, both without the waves of
    `beside`; `decay` ends where the mode has drowned. lines: Hz, the mode's (`own_Hz`) first.
    base_Hz: what is slower is the baseline. close: the line of a mode that beats with it, if any.
    last: the envelopes that were followed last.
    """

    last: Envelopes

    def __init__(
        self,
        velocity: Float[ndarray, " sample"],
        first: int,
        quiet: int,
        sampling_Hz: float,
        expected_Hz: float,
        modes_Hz: tuple[float, ...],
    ) -> None:
        """Arguments as of `separated`."""
        self.velocity, self.first, self.sampling_Hz = velocity, first, sampling_Hz
        self.expected_Hz, self.modes_Hz = expected_Hz, modes_Hz
        self.before = velocity[:quiet]
        self.decay = velocity[first:]
        frequency, level = loudest(self.decay, sampling_Hz, expected_Hz)
        for other in modes_Hz:
            if abs(other / expected_Hz - 1.0) > 2.0 * ABOUT:  # what is another's is not this one's
                level = np.where(np.abs(frequency / other - 1.0) < ABOUT, 0.0, level)
        own_Hz = mode_Hz(frequency, level, expected_Hz)
        named = lines_by_name(self.decay, sampling_Hz, expected_Hz, modes_Hz) or [own_Hz]
        self.lines = self.named = np.array(named)
        self.own_Hz, self.base_Hz = float(self.lines[0]), 0.0
        self.beside: list[Beside] = []
        self.close: list[float] = []
        self.heard = self.trimmed = self.searched = self.beaten = self.paired = self.crowded = False

    def followed(self) -> Envelopes:
        """The envelopes of all components, once nothing more is found in what they leave over."""
        resolved_Hz = self.own_Hz / LOUD_CYCLES
        most = resolved_Hz  # while lines are not known that would draw the mode's to them
        for turn in range(ROUNDS):
            self.last = found = _followed(self.decay, self.sampling_Hz, self.lines, self.base_Hz)
            self.lines = np.array(
                [moved(found, k, self.sampling_Hz) for k in range(self.lines.size)]
            )
            self.lines[0] = np.clip(self.lines[0], self.own_Hz - most, self.own_Hz + most)
            slowest_Hz = _slowest(self.base_Hz, self.own_Hz)
            more = more_lines(self.decay, found, self.sampling_Hz, slowest_Hz)
            most = resolved_Hz if more else np.inf
            if (turn and not self.trimmed) or not (more or self.searched):
                last = _lasting(found)
                if self._takes_beside(last):
                    continue
                self.searched = not more
                if self._trims(last):
                    continue
            if more:
                self._add(more)
            elif not (self._beats() or self._splits()):
                break
        return found

    def _takes_beside(self, last: int) -> bool:
        """Whether a steady line or a harmonic beside the mode is found, and taken off.

        last: samples until the mode has drowned.
        """
        one = None
        if not self.heard:
            rest = self.first - self.before.size
            one = steady_line(
                self.decay, self.last, last, self.sampling_Hz, APART, self.before, rest
            )
        if one is not None:  # without it the mode is followed for longer
            self.heard, self.lines = True, self.named
        one = one or clearest_harmonic(self.decay, self.last, self.sampling_Hz, APART)
        if one is None:
            return False
        self._take(one)
        self.trimmed = False
        return True

    def _trims(self, last: int) -> bool:
        """Whether samples are left out at the end, where the mode has drowned or is hidden."""
        if self.trimmed:
            return False
        self.trimmed = True
        last = min([last, *(one.hides(self.last, self.sampling_Hz) for one in self.beside)])
        # what is hidden from its start on leaves nothing that could be followed
        if not 0 < last < self.last.samples:
            return False
        self.decay = self.decay[:last]
        return True

    def _beats(self) -> bool:
        """Whether a mode too close to be seen as a line is found, once."""
        if self.beaten:
            return False
        self.beaten, close = True, beating_line(self.last, self.sampling_Hz)
        if close:
            both = np.concatenate([self.lines, close])
            self.lines = meant(both, self.expected_Hz, self.modes_Hz)
            self.own_Hz, self.close = float(self.lines[0]), [float(self.lines[-1])]
        return bool(close)

    def _splits(self) -> bool:
        """Whether the mode is a pair of modes, once; the one that is not meant is taken off."""
        if self.paired:
            return False
        self.paired = True
        pair = twofold(self.last, self.sampling_Hz, self.expected_Hz, self.modes_Hz)
        if pair is None:
            return False
        self.own_Hz, other = pair
        self.lines = np.concatenate([[self.own_Hz], self.lines[1:]])
        self._take(other)
        return True

    def _take(self, one: Beside) -> None:
        """Take a wave off the record."""
        self.beside.append(one)
        self.velocity = self.velocity.copy()
        self.velocity[self.first : self.first + one.wave.size] -= one.wave
        self.decay = self.velocity[self.first : self.first + self.decay.size]

    def _add(self, more: list[float]) -> None:
        """Add lines (Hz), the slow ones to the baseline, which follows what its knots resolve."""
        resolved = 0.5 * self.sampling_Hz * MOST_INTERVALS / self.decay.size / ABOVE
        resolved = min(LOW * self.own_Hz, resolved)
        slow = [line for line in more if line < resolved]
        reach = (min(ABOVE * line, HIGHEST * self.own_Hz) for line in slow)
        self.base_Hz = max([self.base_Hz, *reach])
        fast = [line for line in more if line >= resolved]
        room = max(MOST_LINES + 1 - self.lines.size, 0)
        self.crowded |= len(fast) > room
        self.lines = np.concatenate([self.lines, fast[:room]])


def _still_acts(
    found: Envelopes,
    x: Float[ndarray, " sample"],
    sampling_Hz: float,
    lines: Float[ndarray, " line"],
    base_Hz: float,
) -> int:
    """Samples at a decay's start in which something still acts; found: its envelopes."""
    rest = x - found.waves()
    struck = _struck(found, rest)
    if struck and lines.size == 1:  # splines that do not know how fast it falls leave some over
        course = _course(found, 0)[None]
        own = demodulated(x, sampling_Hz, lines, found.spacing, base_Hz, course)
        struck = min(struck, _struck(own, x - own.waves()))
    return struck or _grows(found, rest)


def _doubt(
    found: Envelopes,
    before: Complex[ndarray, " interval"],
    x: Float[ndarray, " sample"],
    sampling_Hz: float,
    own_Hz: float,
) -> Float[ndarray, " interval"]:
    """Relative error of the mode's envelope for how smooth the components are taken to be.

    before: the same envelope with the other notion of what is smooth. own_Hz: the mode's.
    """
    nearest = np.abs(np.concatenate([[0.0], found.lines_Hz[1:]]) - own_Hz).min()
    few = max(int(0.25 * sampling_Hz / own_Hz), 1)
    missed = _missed(x - found.waves(), found.spacing, few)
    doubt = np.hypot(np.abs(found.envelope(0) - before), missed)
    doubt /= np.maximum(np.abs(found.envelope(0)), 1e-300)
    doubt = np.max(sliding_window_view(np.pad(doubt, ALIKE, mode="edge"), 2 * ALIKE + 1), axis=1)
    reach = np.sqrt(found.lines_Hz[0] / (ENVELOPE_BANDWIDTH * nearest))
    return np.minimum(doubt, 1.0) * DOUBT * reach


def onset(velocity: Float[ndarray, " sample"], cycle: float) -> int:
    """The sample in which something sets in motion what was quiet; 0 for a record that begins so.

    A blow shows in all modes at once, and to the sample; what a displacement sensor sees of a
    specimen that is let go drowns in the noise of single samples, and shows in means of them.
    cycle: samples in a cycle of the mode.
    """
    for few in (1, *(max(int(cycle / count), 1) for count in MEANS_A_CYCLE)):
        whole = velocity[: velocity.size // few * few]
        means = whole.reshape(-1, few).mean(axis=1)
        first = _first_change(means, cycle / few) if means.size else 0
        if first:
            return (first + (few > 1)) * few  # behind the mean that it is seen in
    return 0


def _first_change(samples: Float[ndarray, " mean"], cycle: float) -> int:
    """`onset` in means of samples, so many a cycle."""
    size = np.abs(np.diff(samples, prepend=samples[0]))  # without offset and drift
    first = int(np.argmax(size > RISEN * size.max()))
    quiet = size[:first]
    if first < FEWEST_QUIET or np.sqrt(np.mean(quiet**2)) > QUIET * size.max():
        return 0
    return first if size[first : first + int(2 * cycle) + 1].max() > SUDDEN * size.max() else 0


def _lasting(found: Envelopes) -> int:
    """Samples until the mode has drowned in what its envelope shows where nothing is left of it."""
    size = np.abs(found.envelope(0))
    size = np.maximum.accumulate(size[::-1])[::-1]
    part = max(size.size // 10, 1)
    floor, before = (float(np.median(one)) for one in (size[-2 * part :], size[-3 * part : -part]))
    if size[0] < DEEP * floor or floor < FALLING * before:
        return found.samples
    last = int(np.flatnonzero(size > ABOVE_FLOOR * floor)[-1])
    return min(int((LONGER * last + MORE_INTERVALS) * found.spacing), found.samples)


def _struck(found: Envelopes, rest: Float[ndarray, " sample"], blocks: int = 4) -> int:
    """Samples at the start until what is left over falls at once: there something still acts.

    Splines smear it over a spacing; what unknown lines leave over falls as slowly as they do.
    """
    length = max(found.spacing // blocks, 8)
    power = np.sqrt(np.mean(rest[: rest.size // length * length].reshape(-1, length) ** 2, axis=1))
    count = min(power.size // 4, EARLY * blocks)
    if count < 4 * blocks:
        return 0
    after = sliding_window_view(power[blocks:], 2 * blocks)[:count].max(axis=1)
    own = np.abs(found.envelope(0))[np.arange(count) * length // found.spacing]
    least = np.maximum(BURST * np.median(power), HARMFUL * own)
    falls = power[:count] > np.maximum(STILL_ACTS * after, least)
    return int(np.flatnonzero(falls)[-1] + 1) * length if falls.any() else 0


def _beside_it(found: Envelopes, k: int) -> tuple[str, str]:
    """The finding on a component that beats with the mode: another mode, or a line that stays."""
    sizes = np.abs([found.envelope(0), found.envelope(k)])
    third = sizes.shape[1] // 3
    own, other = np.log(sizes[:, :third].mean(axis=1) / sizes[:, -third:].mean(axis=1))
    line_Hz = found.lines_Hz[k]
    if other < STEADY_DECAY_RATIO * own:
        return "steady-line", STEADY.format(line_Hz, sizes[1].mean())
    return "close-mode", CLOSE_MODE.format(found.lines_Hz[0], line_Hz)


def _missed(rest: Float[ndarray, " sample"], spacing: int, few: int) -> Float[ndarray, " interval"]:
    """Rms of what is left over in each interval, beyond what noise leaves.

    That is the median's, and a standard error of the mean square more, over neighbouring intervals.
    Of means over a few samples, a part of the mode's cycle: what is faster harms it less.
    """
    means = np.pad(rest, (0, -rest.size % spacing)).reshape(-1, spacing)
    means = means[:, : spacing // few * few].reshape(len(means), -1, few).mean(axis=2)
    wide = 2 * ALIKE + 1
    power = np.pad(np.mean(means**2, axis=1), ALIKE, mode="edge")
    power = np.convolve(power, np.full(wide, 1.0 / wide), mode="valid")
    noise = np.median(power) * (1.0 + np.sqrt(2.0 / (wide * means.shape[1])))
    return np.sqrt(np.maximum(power - noise, 0.0))


def _grows(found: Envelopes, rest: Float[ndarray, " sample"]) -> int:
    """Samples until the mode is largest, where it clearly grows at first: it is driven still."""
    size = np.abs(found.envelope(0))[: found.samples // found.spacing // 2]
    top = int(np.argmax(size))
    noise = np.std(rest) * np.sqrt(2.0 / found.spacing)
    grows = size[top] > GROWN * size[0] + GROWN_NOISES * noise
    return int((top + 0.5) * found.spacing) if grows else 0


def _sways(found: Envelopes) -> bool:
    """Whether the baseline moves by more than a line that counts."""
    mode = np.sqrt(np.mean(np.abs(found.envelope(0)) ** 2))
    return bool(np.std(found.waves([])) > LEAST_LINE * mode)


def _slowest(base_Hz: float, own_Hz: float) -> float:
    """What is slower (Hz) is known to belong to the baseline."""
    return min(FOLLOWED * base_Hz / ABOVE, LOW * own_Hz)


def _followed(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    lines: Float[ndarray, " line"],
    base_Hz: float,
) -> Envelopes:
    """The envelopes of lines, with knots as dense as telling the first from the others allows."""
    own_Hz = lines[0]
    nearest = np.abs(np.concatenate([[0.0], lines[1:]]) - own_Hz).min()
    spacing = max(KNOTS / nearest, FEWEST_CYCLES / own_Hz)
    spacing = min(spacing, 0.5 / max(base_Hz, 1e-9))
    spacing = int(max(spacing * sampling_Hz, velocity.size / MOST_INTERVALS, FEWEST_SAMPLES))
    spacing = min(spacing, velocity.size // 2)  # a course has two intervals at least
    return demodulated(velocity, sampling_Hz, lines, spacing, base_Hz)


def _course(found: Envelopes, line: int) -> Complex[ndarray, " knot"]:
    """The logarithm of a line's envelope at the knots, its slope averaged over some intervals."""
    z = found.envelope(line)
    inner, around = slice(SLOPE_REACH, SLOPE_REACH + z.size - 1), np.ones(2 * SLOPE_REACH + 1)
    step = np.convolve(z[1:] * z[:-1].conj(), around)[inner]
    power = np.maximum(np.convolve(np.abs(z[:-1]) ** 2, around)[inner], 1e-300)
    rate = np.log(np.maximum(np.abs(step) / power, 0.05)) + 1j * np.angle(step)
    log = np.concatenate([[0.0], np.cumsum(rate)]) + np.log(max(abs(z[0]), 1e-300))
    middle, at = np.arange(log.size), np.arange(log.size + 3) - 1.5
    course = np.interp(at, middle, log.real) + 1j * np.interp(at, middle, log.imag)
    course += rate[0] * np.minimum(at, 0.0) + rate[-1] * np.maximum(at - middle[-1], 0.0)
    return np.maximum(course.real, course.real.max() - DEEPEST) + 1j * course.imag
