"""A close mode: amplitude and phase are modulated at the difference of two frequencies."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray
from scipy import fft

from bladeroot.quality.blocks import frame_weights, without_trend
from bladeroot.quality.examined import LEFTOVER, Examined, Finding
from bladeroot.signal.lines import CLOSE, hann
from bladeroot.signal.runs import medians

STATISTIC = "largest one-sided line in ln A + i phase less its trend, over the median line"
THRESHOLD = 10.0
# A modulation below this does no harm, one above SEVERE leaves no curve to use.
LEAST, SEVERE = 0.01, 0.25
# With fewer beats than this while ln A falls by one, two modes are not told apart; then this swing
# is too much already.
TOLD_APART, ALIKE = 3.0, 0.03
# With fewer beats than SLOW while ln A falls by one, a line may be a bend of the laws, where slip
# ends; a beat goes on: the later half must show it too, this many times over its median line.
SLOW, AGAIN = 2.0, 3.0
# The later half has fewer lines: their median, and what leaks from other modes, is less sure.
SHORTER = 1.5
# Periods that must fit into the decay, and the degree of the trend taken off.
FEWEST, DEGREE = 4.0, 9
# The first frames alone show a mode that dies sooner than this one; fewer periods and a plainer
# trend do there.
EARLY, EARLY_FEWEST, EARLY_DEGREE = (40, 80, 160, 320), 3.0, 3
# Frames that are looked at, at least and at most; the farthest line over the mode's frequency.
FRAMES, FARTHEST = (40, 4096), 0.16
# A line is on one side where it is this many times that on the other; two parts show the same one
# where it turns within so many turns alike over the shorter. A frame's taper weakens a line to this
# part at most.
ONE_SIDED, SAME, LEAST_GAIN = 2.5, 1.5, 0.2


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
        clear = min(self.finding.statistic, other.finding.statistic) > AGAIN
        return clear and abs(self.turns - other.turns) * shortest < SAME


def find(seen: Examined) -> Finding | None:
    """The strongest line within a sixth of the mode's frequency, in all or in a part.

    Where the mode's frequency changes much with amplitude, only the later half shows a line.

    A second mode of relative amplitude r adds ln(1 + r exp(i d t)) to the log-phasor, which has
    lines on one side of zero only; laws of frequency and damping change it smoothly, and bend it
    but once.
    """
    fewest, most = FRAMES
    count = min(seen.frames.clear, most)
    if count < fewest:
        return None
    later = _line(seen, slice(count // 2, count), SHORTER)
    early = [
        _line(seen, slice(2, 2 + length), SHORTER, EARLY_FEWEST, EARLY_DEGREE)
        for length in EARLY
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
    fewest: float = FEWEST,
    degree: int = DEGREE,
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
    inside = (np.abs(turns) * log.size >= fewest) & (span <= FARTHEST)
    level = np.where(inside, np.abs(line), 0.0)
    k = int(np.argmax(level))
    other = float(np.abs(line[-k]))
    usual = float(medians(np.abs(line[inside])))
    carrier = (
        2.0 * np.pi / seen.sampling_Hz * (frames.frequency_Hz + turns[k] * cycle * seen.own_Hz)
    )
    gain = abs(np.sum(frames.row * np.exp(1j * carrier * local)))
    size = float(level[k] / max(gain, LEAST_GAIN))
    one_sided = level[k] > ONE_SIDED * other
    statistic = level[k] / max(usual, LEAST * gain / THRESHOLD) / shorter if one_sided else 0.0
    distance = turns[k] * seen.sampling_Hz / frames.hop
    text = (
        f"a mode {distance:+.4g} Hz beside it beats with this one: amplitude and phase swing by "
        f"{100 * size:.2g} %"
    )
    beats = abs(turns[k]) / max(_decline(log.real, weight), 1e-300)
    alike = size > ALIKE and beats < TOLD_APART
    if alike:
        text += "; they are too close to be told apart"
    consequence = "drop" if alike or size > SEVERE else "warn"
    name = "" if abs(distance) < CLOSE * seen.own_Hz else LEFTOVER
    finding = Finding(float(statistic), THRESHOLD, consequence, text, name=name)
    return _Line(float(turns[k]), log.size, bool(beats < SLOW), finding)


def _decline(level: Float[ndarray, " frame"], weight: Float[ndarray, " frame"]) -> float:
    """What ln A falls by in a frame."""
    return float(-np.polyfit(np.arange(level.size), level, 1, w=weight)[0])
