"""A steady line beside the mode, such as the mains': seen by itself once the mode has died away.

Close to the mode no spectrum of the decay shows it, and it takes the mode's envelope for its own.
What follows the decay tells its frequency and phase so well that it can be taken off before.
"""

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray

from bladeroot.decay.beside import Beside
from bladeroot.decay.envelope_model import Envelopes
from bladeroot.signal.lines import hann, lines_of

# Parts of what follows the decay, in which the line's amplitude and phase are compared; fewest
# cycles of the mode in each.
PARTS, FEWEST_CYCLES = 8, 6.0
# A line is over the median one around it by this factor, its parts differ by no more than that part
# of it (rms), and carried back to the decay's start it is known to this part of itself.
CLEAR, UNEVEN, KNOWN = 12.0, 0.1, 0.3
# Turns that it makes at least against the mode's later half: what makes fewer is the mode itself.
TURNS = 1.0
# What falls less than this part as fast as the mode is no mode beside it, but a line that stays.
STAYS = 0.1
REMARK = "a steady line at {:.6g} Hz ({:.2g} m/s) rings on beside the mode; taken off"


def steady_line(
    x: Float[ndarray, " sample"], found: Envelopes, last: int, sampling_Hz: float, within: float
) -> Beside | None:
    """The clearest steady line within that part of the mode's frequency, None without one.

    x: a decay (m/s) and what follows it. found: its envelopes, the mode's first. last: the sample
    in which the mode has died away.
    """
    own_Hz, count = float(found.lines_Hz[0]), (x.size - last) // PARTS
    if count < FEWEST_CYCLES * sampling_Hz / own_Hz:
        return None
    begin = x.size - PARTS * count
    after = x[begin:]
    frequency, level = lines_of(after, sampling_Hz)
    around = np.abs(frequency - own_Hz) < within * own_Hz
    at = int(np.argmax(np.where(around, level, 0.0)))
    if level[at] < CLEAR * np.median(level[around]):
        return None
    time = (np.arange(after.size) + begin) / sampling_Hz
    line = float(frequency[at])
    for _ in range(3):  # the phase from part to part tells the frequency best
        z, middle = _parts(after, time, line)
        turned = np.unwrap(np.angle(z - _second(z)))
        line += float(np.polyfit(middle, turned, 1)[0]) / (2.0 * np.pi)
    z, middle = _parts(after, time, line)
    z = z - _second(z)
    mean = complex(z.mean())
    off = float(np.sqrt(np.sum(np.abs(z - mean) ** 2) / (PARTS - 4)))
    now = np.arange(x.size) / sampling_Hz
    # errors of the mean, and of the frequency from where it is known best
    away = (now - middle.mean()) / np.sqrt(np.sum((middle - middle.mean()) ** 2))
    error = off * np.hypot(PARTS**-0.5, away)
    if off > UNEVEN * abs(mean) or error[0] > KNOWN * abs(mean):
        return None
    late = found.envelope(0)[last // found.spacing // 2 : last // found.spacing]
    turn = float(np.angle(np.vdot(late[:-1], late[1:]))) / (2.0 * np.pi * found.spacing)
    if abs(line - own_Hz - turn * sampling_Hz) * last < TURNS * sampling_Hz:
        return None  # the mode itself
    wave = (mean * np.exp(2j * np.pi * line * now)).real
    return Beside(line, wave, now, error, "steady-line", REMARK.format(line, abs(mean)))


def _parts(
    after: Float[ndarray, " sample"], time: Float[ndarray, " sample"], line_Hz: float
) -> tuple[Complex[ndarray, " part"], Float[ndarray, " part"]]:
    """A line's phasor in each part (Hann), and the parts' middles (s)."""
    turned = (after * np.exp(-2j * np.pi * line_Hz * time)).reshape(PARTS, -1)
    taper = hann(turned.shape[1])
    return 2.0 * (turned @ taper) / taper.sum(), time.reshape(PARTS, -1).mean(axis=1)


def _second(z: Complex[ndarray, " part"]) -> Complex[ndarray, " part"]:
    """What there is in the parts beside what is largest in the end: the mode's last."""
    factor, size = exponentials(z, PARTS // 2 + 1)
    both = np.vander(factor, PARTS, increasing=True).T * size
    return both[:, int(np.argmin(np.abs(both[-1])))]


def exponentials(
    z: Complex[ndarray, " value"], width: int
) -> tuple[Complex[ndarray, "2"], Complex[ndarray, "2"]]:
    """Factors from value to value, and sizes in the first, of two exponentials.

    By the rotation of the signal subspace (ESPRIT: Roy & Kailath 1989) of windows of a width.
    """
    rows = np.lib.stride_tricks.sliding_window_view(z, width)
    signal = np.linalg.svd(rows, full_matrices=False)[2][:2].T
    factor = np.linalg.eigvals(np.linalg.lstsq(signal[:-1], signal[1:], rcond=None)[0])
    shapes = np.vander(factor, z.size, increasing=True).T
    return factor, np.linalg.lstsq(shapes, z, rcond=None)[0]
