"""A second mode too close for a line of its own: two exponentials against one mode that bends.

It dies before the two beat, or beats with the mode but a few times in all, as doublets of bells,
strings and discs do. Over a segment of intervals the mode's envelope is fitted as the sum of two
exponentials, and as one whose logarithm is a cubic, which has as many unknowns and is what a mode
with laws of its own looks like.
"""

import numpy as np
from jaxtyping import Complex
from numpy import ndarray

from bladeroot.decay.component_lines import meant
from bladeroot.decay.envelope_model import ENVELOPE_BANDWIDTH, Beside, Envelopes
from bladeroot.decay.steady import REMARK as STEADY
from bladeroot.decay.steady import STEADY_DECAY_RATIO, exponentials

# The segments to which both models are fitted. Where the mode bends by a law of its own, as a joint
# does while it is loud, two exponentials are told from the start of a later one.
SEGMENT_STARTS = (0.0, 0.125, 0.25)  # over the envelope's length, tried in turn
SEGMENT_INTERVALS = (12, 18, 27, 40, 60, 90, 135, 200, 300)  # lengths
MOST_VALUES = 40  # in which exponentials are sought: means of neighbours in a longer segment
LEAST_REMAINDER = 0.02  # ratio of the amplitude at a segment's end to the largest in it
# When there are two modes rather than one that bends.
MISFIT_RATIO = 5.0  # least ratio of the misfit of one that bends to that of two exponentials
LEAST_FACTOR = 0.5  # of either's amplitude from interval to interval; less is a transient
LEAST_TURNS = 0.4  # of one's phase against the other's in the segment; less is the mode's own bend
# Either's size at the start over the envelope there: what a later segment makes larger is a law
# that bends, what is smaller is rounding where there is no noise.
SIZES = (1e-5, 2.0)
# A joint that slips while it is loud makes its mode lower and more damped then. A component is
# taken for that, and for no other mode, if it decays much faster and lies a little lower.
# Ratio of the decay rates: of slip it is 7 to 26, of two modes mostly below 3, of a line more.
SLIP_DECAY_RATIOS = (6.0, 40.0)
SLIP_FREQUENCY_DROP = 0.02  # relative; what lies farther below is another mode
# The mode that is meant has most energy, weighed by a normal density about the sheet's frequency.
EXPECTED_STD = 0.02  # relative standard deviation of that density
TAKEN_OFF_ERROR = 0.5  # relative standard error of what is taken off: its laws are not known
REMARK = (
    "two modes ring near {:.5g} and {:.5g} Hz until one is gone: the first is taken for the one "
    "that is asked for, the other, {:.2g} times as large at first, is taken off as a plain "
    "exponential; name both: modes of a campaign, other_modes_Hz in Python"
)


def twofold(
    found: Envelopes, sampling_Hz: float, expected_Hz: float, modes_Hz: tuple[float, ...]
) -> tuple[float, Beside] | None:
    """Frequency (Hz) of the mode that is meant, and the other one; None if there is one mode."""
    z = found.envelope(0)
    step_s = found.spacing / sampling_Hz
    best, pair = MISFIT_RATIO, None
    for part in SEGMENT_STARTS:
        first = int(part * z.size)
        clear, pole, size = _two(z[first:], 2.0 * np.pi * step_s * found.lines_Hz[0])
        size = size * pole ** -float(first)
        least, most = np.sort(np.abs(size)) / np.abs(z).max()
        if clear > best and SIZES[0] < least and most < SIZES[1]:
            best, pair = clear, (pole, size)
    if pair is None:
        return None
    pole, size = pair
    line = found.lines_Hz[0] + np.angle(pole) / (2.0 * np.pi * step_s)
    energy = np.abs(size) ** 2 / np.maximum(1.0 - np.abs(pole) ** 2, 1e-3)
    order = np.argsort(-energy * np.exp(-0.5 * (np.log(line / expected_Hz) / EXPECTED_STD) ** 2))
    own_Hz = meant(line[order], expected_Hz, modes_Hz)[0]
    k = int(line[0] == own_Hz)  # the other
    now = np.arange(found.samples) - 0.5 * (found.spacing - 1)
    rate = np.log(pole[k]) / found.spacing + 2j * np.pi * found.lines_Hz[0] / sampling_Hz
    turn = np.exp(1j * np.pi * found.lines_Hz[0] * (found.spacing - 1) / sampling_Hz)
    wave = (size[k] * turn * np.exp(rate * now)).real
    middle = np.arange(z.size)
    error = TAKEN_OFF_ERROR * np.abs(size[k]) * np.abs(pole[k]) ** middle
    finding, remark = "close-mode", REMARK.format(own_Hz, line[k], abs(size[k] / size[1 - k]))
    if np.log(np.abs(pole[k])) > STEADY_DECAY_RATIO * np.log(np.abs(pole[1 - k])):
        finding, remark = "steady-line", STEADY.format(line[k], abs(size[k]))
    time = (middle + 0.5) * step_s
    alike = own_Hz / (ENVELOPE_BANDWIDTH * abs(line[1] - line[0]))
    beside = Beside(float(line[k]), wave, time, error, finding, remark, alike)
    return float(own_Hz), beside


def _two(
    z: Complex[ndarray, " interval"], turn: float
) -> tuple[float, Complex[ndarray, "2"], Complex[ndarray, "2"]]:
    """The exponentials that are most clearly two, from the envelope's start on: how clearly, by the
    ratio of misfits (0: not at all), factors from interval to interval and first values.

    turn: by how much the mode turns in an interval (rad).
    """
    best, pair = 0.0, (np.ones(2, complex), np.zeros(2, complex))
    for count in SEGMENT_INTERVALS:
        part = z[:count]
        if z.size < count or abs(part[-1]) < LEAST_REMAINDER * np.abs(part).max():
            break
        pole, size = _fitted(part)
        fast, slow = sorted(pole, key=abs)
        turns = abs(np.angle(fast / slow)) * count / (2.0 * np.pi)
        if not LEAST_FACTOR < abs(fast) <= abs(slow) < 1.1 or turns < LEAST_TURNS:
            continue
        lower = np.angle(slow / fast) / turn
        least, most = SLIP_DECAY_RATIOS
        slips = most * np.log(abs(slow)) < np.log(abs(fast)) < least * np.log(abs(slow))
        if 0.0 < lower < SLIP_FREQUENCY_DROP and slips:
            continue
        left = np.linalg.norm(part - np.vander(pole, count, increasing=True).T @ size)
        clear = np.linalg.norm(part - _bending(part)) / max(left, 1e-300)
        if clear > best:
            best, pair = clear, (pole, size)
    return best, *pair


def _fitted(
    z: Complex[ndarray, " interval"],
) -> tuple[Complex[ndarray, "2"], Complex[ndarray, "2"]]:
    """Two exponentials in an envelope: factors from interval to interval, and first values."""
    each = -(-z.size // MOST_VALUES)
    means = z[: z.size // each * each].reshape(-1, each).mean(axis=1)
    pole = exponentials(means, means.size // 3)[0] ** (1.0 / each)
    shapes = np.vander(pole, z.size, increasing=True).T
    return pole, np.linalg.lstsq(shapes, z, rcond=None)[0]


def _bending(z: Complex[ndarray, " interval"], passes: int = 3) -> Complex[ndarray, " interval"]:
    """The exponential of a cubic that fits best: Gauss-Newton from a fit of the logarithm."""
    size = np.maximum(np.abs(z), 1e-300)
    log = np.log(size) + 1j * np.unwrap(np.angle(z))
    basis = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, z.size), 3)
    course = np.linalg.lstsq(basis * size[:, None], log * size, rcond=None)[0]
    for _ in range(passes):
        model = np.exp(basis @ course)
        step = np.linalg.lstsq(basis * model[:, None], z - model, rcond=None)[0]
        if not np.abs(step).max() < 3.0:
            break
        course = course + step
    return np.exp(basis @ course)
