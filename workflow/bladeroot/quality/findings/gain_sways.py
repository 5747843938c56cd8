"""The sensor's gain sways: the amplitude is modulated and the phase is not, as by no mode or law.

A laser's spot that wanders over the surface, an accelerometer whose cable pulls at it.
"""

import numpy as np
from scipy import fft

from bladeroot.quality.examined import Examined, Finding, without_trend
from bladeroot.signal.lines import hann
from bladeroot.signal.runs import medians

STATISTIC = "largest line of ln A less its trend that the phase lacks, over the median line of both"
# 2000 decays of every kind but this stay below it; a gain that sways by 1 % reaches 7 to 500.
THRESHOLD = 6.0

# Which lines of ln A count.
# The phase has less than this part of the line; a mode beside it, or noise, moves it as much.
PHASE_SHARE = 0.4
LEAST_HARM = 0.1  # part of the mean decay rate by which the line changes it; less does little harm
FEWEST_PERIODS = 5.5  # periods of the line in the frames at least
FARTHEST_LINE = 0.16  # frequency of the line, over the mode's, at most
FEWEST_LINES = 8  # spectral lines between these two limits at least

# A trend of so many degrees more changes the line by this part at most. What a trend leaves of a
# law's own bend is another line with another trend.
MORE_DEGREES, MOST_CHANGE = 4, 0.2

# Which frames are looked at (a cycle apart), and the degree of the trend that is taken off them.
MOST_FRAMES = 4096
TREND_DEGREE = 9
EARLY_FRAMES = (40, 80, 160, 320, 640)  # the first frames alone, where noise is least
EARLY_TREND_DEGREE = 3


def find(seen: Examined) -> Finding | None:
    """The strongest line of ln A that the phase lacks, in all frames or in the first ones.

    A gain 1 + r cos(2 pi g t) adds r cos(2 pi g t) to ln A and nothing to the phase, and so
    changes the decay rate by up to 2 pi g r.
    """
    count = min(seen.frames.clear, MOST_FRAMES)
    parts = [(slice(2, count), TREND_DEGREE), (slice(count // 2, count), TREND_DEGREE)]
    parts += [
        (slice(2, 2 + some), EARLY_TREND_DEGREE) for some in EARLY_FRAMES if some < count // 2
    ]
    found = [_strongest(seen, *part) for part in parts]
    return max(filter(None, found), key=lambda one: one.statistic, default=None)


def _strongest(seen: Examined, used: slice, degree: int) -> Finding | None:
    frames = seen.frames
    rest = without_trend(frames, used, degree)
    if rest is None:
        return None
    lines = [np.abs(fft.rfft(part, 2 * rest.size)) for part in (rest.real, rest.imag)]
    turns = fft.rfftfreq(2 * rest.size)  # per hop
    cycle = seen.sampling_Hz / seen.own_Hz / frames.hop
    inside = (turns * rest.size >= FEWEST_PERIODS) & (turns * cycle <= FARTHEST_LINE)
    if inside.sum() < FEWEST_LINES:
        return None
    swing, turning = (2.0 * line / hann(rest.size).sum() for line in lines)
    usual = float(medians(np.concatenate([swing[inside], turning[inside]])))
    level = frames.log.real[used]
    decline = -float(np.polyfit(np.arange(level.size), level, 1)[0])
    harm = 2.0 * np.pi * turns * swing / max(decline, 1e-300)
    inside &= (turning < PHASE_SHARE * swing) & (harm > LEAST_HARM)
    if not inside.any():
        return None
    k = int(np.argmax(np.where(inside, swing, 0.0)))
    line = np.exp(-2j * np.pi * turns[k] * np.arange(rest.size))
    change = (without_trend(frames, used, degree + MORE_DEGREES) - rest).real @ line
    if abs(change) > MOST_CHANGE * abs(rest.real @ line):
        return None
    off = f"{100 * harm[k]:.2g} %" if harm[k] < 10.0 else "more than they are"
    text = (
        f"the sensor's gain sways by {100 * swing[k]:.2g} % at "
        f"{turns[k] * seen.sampling_Hz / frames.hop:.3g} Hz (the phase does not): loss factors "
        f"may be off by {off}"
    )
    return Finding(float(swing[k] / usual), THRESHOLD, "warn", text)
