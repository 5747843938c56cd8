"""A steady line beside the mode, such as the mains': seen by itself where the mode does not ring.

Close to the mode no spectrum of the decay shows it, and it takes the mode's envelope for its own.
What comes before a blow, and what follows the decay, tell its frequency and phase so well that it
can be taken off between.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray
from scipy import fft

from bladeroot.decay.envelope_model import ENVELOPE_BANDWIDTH, Beside, Envelopes
from bladeroot.signal.lines import hann, lines_of

# A quiet piece of the record is cut into parts, in which the line's phasors are compared.
QUIET_PARTS = 8
FEWEST_PART_CYCLES = (2.0, 6.0)  # of the mode in a part: before the blow, after a mode has died
# A line is steady and well known if both of these are small, relative to its amplitude.
MOST_SCATTER = 0.1  # rms scatter of the parts' phasors about their mean; about 1 in noise alone
MOST_ERROR = 1.0  # standard error of the line carried through the decay
# It is not the mode itself, which may decay ever more slowly, if its phase turns against that of
# the mode's later half, or if it stays while the mode's ln A falls. After the decay it turns a
# little, too, and the mode's fall counts over what the line's may be: rms scatter times root 12.
LEAST_TURNS = 1.0  # over the decay
LEAST_FALL = 0.7  # before a blow
LITTLE_TURNS, LEAST_FALL_RATIO = 0.2, 50.0  # after the decay
STEADY_DECAY_RATIO = 0.1  # of the mode's decay rate; what decays more slowly is a steady line
REMARK = "a steady line at {:.6g} Hz ({:.2g} m/s) rings on beside the mode; taken off"


@dataclass(frozen=True)
class _Quiet:
    """A quiet piece in parts, with its times (s). died: whether a mode has rung before it."""

    samples: Float[ndarray, "part sample"]
    time: Float[ndarray, "part sample"]
    died: bool


def steady_line(
    x: Float[ndarray, " sample"],
    found: Envelopes,
    last: int,
    sampling_Hz: float,
    within: float,
    before: Float[ndarray, " earlier"],
    gap: int = 0,
) -> Beside | None:
    """The clearest steady line within that part of the mode's frequency, None without one.

    x: a decay (m/s) and what follows it. found: its envelopes, the mode's first. last: the sample
    in which the mode has died away. before: a quiet piece that ends `gap` samples before the decay
    begins.
    """
    own_Hz = float(found.lines_Hz[0])
    late = found.envelope(0)[last // found.spacing // 2 : last // found.spacing]
    step = np.vdot(late[:-1], late[1:]) / max(float(np.sum(np.abs(late[:-1]) ** 2)), 1e-300)
    turn_Hz = float(np.angle(step)) * sampling_Hz / (2.0 * np.pi * found.spacing)
    decline = -float(np.log(max(abs(step), 1e-300))) * sampling_Hz / found.spacing
    pieces = []
    for piece, end, died in ((before, -gap, False), (x[last:], x.size, True)):
        count = piece.size // QUIET_PARTS
        if count >= FEWEST_PART_CYCLES[died] * sampling_Hz / own_Hz:
            time = np.arange(end - QUIET_PARTS * count, end) / sampling_Hz
            parts = piece[piece.size - QUIET_PARTS * count :].reshape(QUIET_PARTS, count)
            pieces.append(_Quiet(parts, time.reshape(QUIET_PARTS, count), died))
    # both pieces together, else the longer one alone
    for quiet in [pieces, sorted(pieces, key=lambda piece: piece.samples.size)[-1:]][: len(pieces)]:
        line, mean, off, middle = _line(quiet, own_Hz, sampling_Hz, within)
        ends = np.array([0.0, last - 1.0]) / sampling_Hz  # the error is largest at one of them
        farthest = _error(ends, middle, off).max()
        if not (off < MOST_SCATTER * abs(mean) and farthest < MOST_ERROR * abs(mean)):
            continue
        apart_Hz = abs(line - own_Hz - turn_Hz)
        turns, fall = apart_Hz * last / sampling_Hz, decline * (middle[-1] - middle[0])
        stays = fall > LEAST_FALL
        if quiet[0].died:
            may_fall = np.sqrt(12.0) * off / abs(mean)
            stays = turns > LITTLE_TURNS and fall > LEAST_FALL_RATIO * may_fall
        if turns < LEAST_TURNS and not stays:
            return None  # the mode itself
        now = np.arange(x.size) / sampling_Hz
        wave = (mean * np.exp(2j * np.pi * line * now)).real
        alike = own_Hz / max(ENVELOPE_BANDWIDTH * apart_Hz, sampling_Hz / x.size)
        remark, error = REMARK.format(line, abs(mean)), _error(now, middle, off)
        return Beside(line, wave, now, error, "steady-line", remark, alike)
    return None


def _error(
    time: Float[ndarray, " time"], middle: Float[ndarray, " part"], off: float
) -> Float[ndarray, " time"]:
    """Standard error of a line at some times, from its mean's and its frequency's."""
    away = (time - middle.mean()) / np.sqrt(np.sum((middle - middle.mean()) ** 2))
    return off * np.hypot(middle.size**-0.5, away)


def _line(
    quiet: list[_Quiet], own_Hz: float, sampling_Hz: float, within: float
) -> tuple[float, complex, float, Float[ndarray, " part"]]:
    """Frequency and phasor of the loudest line, the parts' scatter about it, their middles (s)."""
    longest = max(quiet, key=lambda piece: piece.samples.size)
    quick = fft.prev_fast_len(longest.samples.size, real=True)
    frequency, level = lines_of(longest.samples.ravel()[:quick], sampling_Hz)
    around = np.abs(frequency - own_Hz) < within * own_Hz
    line = float(frequency[np.argmax(np.where(around, level, 0.0))])
    # the phase from part to part tells the frequency best: first within the longest piece, then
    # over both, once no turn can be lost between them
    for used in ([longest],) * 3 + (quiet,) * 3:
        z, middle = _parts(used, line)
        line += float(np.polyfit(middle, np.unwrap(np.angle(z)), 1)[0]) / (2.0 * np.pi)
    z, middle = _parts(quiet, line)
    off = float(np.sqrt(np.sum(np.abs(z - z.mean()) ** 2) / (z.size - 4)))
    return line, complex(z.mean()), off, middle


def _parts(
    quiet: list[_Quiet], line_Hz: float
) -> tuple[Complex[ndarray, " part"], Float[ndarray, " part"]]:
    """A line's phasor in each part (Hann), without what is left of a mode; the parts' middles."""
    found, middles = [], []
    for piece in quiet:
        taper, turn = hann(piece.time.shape[1]), -2j * np.pi * line_Hz
        wave = taper * np.exp(turn * (piece.time[0] - piece.time[0, 0]))
        z = 2.0 / taper.sum() * np.exp(turn * piece.time[:, 0]) * (piece.samples @ wave)
        found.append(z - _second(z) if piece.died else z)
        middles.append(piece.time.mean(axis=1))
    return np.concatenate(found), np.concatenate(middles)


def _second(z: Complex[ndarray, " part"]) -> Complex[ndarray, " part"]:
    """What is left of the mode: of two exponentials the one that is smaller in the last part."""
    factor, size = exponentials(z, QUIET_PARTS // 2 + 1)
    both = np.vander(factor, QUIET_PARTS, increasing=True).T * size
    return both[:, int(np.argmin(np.abs(both[-1])))]


def exponentials(
    z: Complex[ndarray, " value"], width: int
) -> tuple[Complex[ndarray, "2"], Complex[ndarray, "2"]]:
    """Two exponentials in a sequence: their factors from value to value, and first values.

    By the rotation of the signal subspace (ESPRIT: Roy & Kailath 1989) of windows `width` values
    long.
    """
    rows = np.lib.stride_tricks.sliding_window_view(z, width)
    signal = np.linalg.svd(rows, full_matrices=False)[2][:2].T
    factor = np.linalg.eigvals(np.linalg.lstsq(signal[:-1], signal[1:], rcond=None)[0])
    shapes = np.vander(factor, z.size, increasing=True).T
    return factor, np.linalg.lstsq(shapes, z, rcond=None)[0]
