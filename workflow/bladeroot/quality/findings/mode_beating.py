"""A close mode: amplitude and phase are modulated at the difference of two frequencies."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy import fft

from bladeroot.quality.examined import LEFTOVER, Examined, Finding, frame_weights, without_trend
from bladeroot.signal.lines import CLOSE_MODE_DISTANCE, hann
from bladeroot.signal.runs import medians

STATISTIC = "largest one-sided line in ln A + i phase less its trend, over the median line"
THRESHOLD = 10.0
# What a beat's swing (of ln A and of the phase) does to the record.
LEAST_SWING = 0.01  # a smaller one does no harm, and does not reach the threshold
DROP_SWING = 0.25  # a larger one leaves no curve to use: the record is dropped
# With fewer beats than this while ln A falls by one, two modes are not told apart; then a swing of
# CLOSE_DROP_SWING is too much already.
BEATS_TOLD_APART = 3.0
CLOSE_DROP_SWING = 0.03
# With fewer beats than this while ln A falls by one, a line may be a bend of the laws, where slip
# ends. A beat goes on: the line counts only where the later half and another part both show it.
SLOW_BEATS = 2.0

# Which lines count, and which are the same one in two parts of the decay.
ONE_SIDED_RATIO = 2.5  # a line over the one at the opposite frequency, from which it is one-sided
AGREEING_OVER_MEDIAN = 3.0  # statistic of the same line in both parts, at least
SAME_LINE_TURNS = 1.5  # difference of the two lines' turns over the shorter part, at most
FARTHEST_LINE = 0.16  # frequency of a line, over the mode's, at most
# A frame's own taper weakens a line away from the mode; the swing is corrected for that, as if at
# least this part of it were left.
LEAST_FRAME_GAIN = 0.2

# Which frames are looked at (a cycle apart), how many periods of a line must fit into them, and
# the degree of the trend that is taken off.
FRAME_LIMITS = (40, 4096)  # frames at least and at most
FEWEST_PERIODS = 4.0
TREND_DEGREE = 9
# The first frames alone show a mode that dies sooner than this one; fewer periods and a plainer
# trend do there.
EARLY_FRAMES = (40, 80, 160, 320)
EARLY_FEWEST_PERIODS = 3.0
EARLY_TREND_DEGREE = 3
# Divides the statistic of a part of the decay, which has fewer lines: their median, and what leaks
# from other modes, is less sure.
PART_DIVISOR = 1.5


@dataclass(frozen=True)
class _Line:
    """The strongest line over `count` frames: its turns a frame, and whether a bend may make it."""

    turns: float
    count: int
    slow: bool
    finding: Finding

    def agrees(self, other: "_Line") -> bool:
        """Whether another segment shows the same line."""
        shortest = min(self.count, other.count)
        clear = min(self.finding.statistic, other.finding.statistic) > AGREEING_OVER_MEDIAN
        return clear and abs(self.turns - other.turns) * shortest < SAME_LINE_TURNS


def find(seen: Examined) -> Finding | None:
    """The strongest line within `FARTHEST_LINE` of the mode, in all frames or in a part of them.

    Where the mode's frequency changes much with amplitude, only the later half shows a line.

    A second mode of relative amplitude r adds ln(1 + r exp(i d t)) to the log-phasor, which has
    lines on one side of zero only; laws of frequency and damping change it smoothly, with a single
    bend.
    """
    fewest, most = FRAME_LIMITS
    count = min(seen.frames.clear, most)
    if count < fewest:
        return None
    later = _line(seen, slice(count // 2, count), PART_DIVISOR)
    early = [
        _line(seen, slice(2, 2 + length), PART_DIVISOR, EARLY_FEWEST_PERIODS, EARLY_TREND_DEGREE)
        for length in EARLY_FRAMES
        if length < count // 2
    ]
    lines = [line for line in (_line(seen, slice(2, count)), later, *early) if line is not None]
    found = [
        line.finding
        for line in lines
        if not line.slow
        or any(line.agrees(one) for one in lines if (one is later) != (line is later))
    ]
    return max(found, key=lambda finding: finding.statistic, default=None)


def _line(
    seen: Examined,
    used: slice,
    shorter: float = 1.0,
    fewest: float = FEWEST_PERIODS,
    degree: int = TREND_DEGREE,
) -> _Line | None:
    """The strongest line over some frames, its statistic divided by `shorter`."""
    frames = seen.frames
    rest = without_trend(frames, used, degree)
    if rest is None:
        return None
    log, whole = frames.log[used], frames.whole[used]
    weight = frame_weights(frames, used)
    taper = hann(log.size) * whole
    line = fft.fft(rest, 2 * log.size) / taper.sum()
    turns = fft.fftfreq(line.size)  # per hop
    cycle = seen.sampling_Hz / seen.own_Hz / frames.hop
    # the frames' own taper weakens a line at this distance from the mode
    local = np.arange(frames.row.size) - 0.5 * (frames.row.size - 1)
    span = np.abs(turns) * cycle
    inside = (np.abs(turns) * log.size >= fewest) & (span <= FARTHEST_LINE)
    level = np.where(inside, np.abs(line), 0.0)
    k = int(np.argmax(level))
    other = float(np.abs(line[-k]))
    usual = float(medians(np.abs(line[inside])))
    carrier = (
        2.0 * np.pi / seen.sampling_Hz * (frames.frequency_Hz + turns[k] * cycle * seen.own_Hz)
    )
    gain = abs(np.sum(frames.row * np.exp(1j * carrier * local)))
    size = float(level[k] / max(gain, LEAST_FRAME_GAIN))
    one_sided = level[k] > ONE_SIDED_RATIO * other
    statistic = (
        level[k] / max(usual, LEAST_SWING * gain / THRESHOLD) / shorter if one_sided else 0.0
    )
    distance = turns[k] * seen.sampling_Hz / frames.hop
    text = (
        f"a mode {distance:+.4g} Hz beside it beats with this one: amplitude and phase swing by "
        f"{100 * size:.2g} %"
    )
    beats = abs(turns[k]) / max(_decline(log.real, weight), 1e-300)
    alike = size > CLOSE_DROP_SWING and beats < BEATS_TOLD_APART
    if alike:
        text += "; they are too close to be told apart"
    consequence = "drop" if alike or size > DROP_SWING else "warn"
    name = "" if abs(distance) < CLOSE_MODE_DISTANCE * seen.own_Hz else LEFTOVER
    finding = Finding(float(statistic), THRESHOLD, consequence, text, name=name)
    return _Line(float(turns[k]), log.size, bool(beats < SLOW_BEATS), finding)


def _decline(level: Float[ndarray, " frame"], weight: Float[ndarray, " frame"]) -> float:
    """By how much ln A falls from frame to frame."""
    return float(-np.polyfit(np.arange(level.size), level, 1, w=weight)[0])
