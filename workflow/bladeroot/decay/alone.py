"""The measured mode alone: other modes that are as loud, or outlive it, taken off a decay."""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray
from scipy import fft

from bladeroot.signal.lines import loudest, magnitudes, mode_Hz
from bladeroot.signal.runs import in_frames, medians

# A line counts from this part of the mode's own height in the spectrum of a decay's later half,
# where one that outlives the mode is louder than at the start; one that dies sooner, or a frequency
# that the mode itself had at large amplitudes, is not there any more. Before, it was no weaker
# than this part of itself, or the mode has moved to it.
LOUD, GROWN = 0.3, 0.7
# Distance from the mode (over its frequency) from which a line's wave can be taken off, which is
# that of lines, too; and from which a line is another mode's at all.
APART, NEAREST = 0.17, 0.04
# A mode's frequency may be so far off (relative) while it is loud.
MOVED = 0.04
MOST = 4
# It stands out of what lies beside it (at this distance, over the mode's frequency) by this factor.
BESIDE, CLEAR = 0.06, 12.0
# Lines below this part of the mode's frequency are a baseline, those above this multiple are told
# from it within a cycle; samples in its cycle that show what lies between.
LOWEST, HIGHEST, SAMPLES = 0.005, 4.5, 16.0
# Lines up to this part of it are of what sways, and are taken off in longer frames of their own.
SWAY = 0.05
# In so many first cycles a line counts from this part of the mode's height, where it lies below
# this multiple of its frequency: frames of one cycle tell others from it. The mode has then at
# least this part of the line's height, or the line is the mode's own while it is loud.
FIRST_CYCLES, LOUD_FIRST, BELOW, AUDIBLE = 24.0, 0.2, 1.6, 0.08
# A frame holds so many cycles of the least difference of frequencies: a mode that grows or drifts
# as a parabola of time does in it then leaks into no other one.
BEATS = 4.0
# Steps in a frame. A Hann taper that moves on by them adds up to half their number.
STEPS = 4
# Times that samples without weight are filled with what the frames make of them.
FILLED = 24


def alone(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    usable: Bool[ndarray, " sample"] | None = None,
) -> tuple[Float[ndarray, " sample"], list[float]]:
    """A decay (m/s) without the loud other modes, and the frequencies (Hz) of all that are loud.

    The decay itself where there are none, and with those that are too close to this mode. What
    lies in samples that are not usable does not count.
    """
    seen = np.arange(velocity.size) if usable is None else np.flatnonzero(usable)
    part = slice(int(seen[0]), int(seen[-1]) + 1)
    own_Hz, loud_Hz = loud_lines(velocity[part], sampling_Hz, expected_Hz)
    others_Hz = [line for line in loud_Hz if abs(line - own_Hz) >= APART * own_Hz]
    left = velocity.copy() if others_Hz else velocity
    for sways in (True, False):
        some = [line for line in others_Hz if (line < SWAY * own_Hz) == sways]
        if some:
            known = None if usable is None else usable[part]
            left[part] -= _theirs(left[part], sampling_Hz, own_Hz, some, known)
    return left, loud_Hz


def _theirs(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    own_Hz: float,
    others_Hz: list[float],
    usable: Bool[ndarray, " sample"] | None,
) -> Float[ndarray, " sample"]:
    """The sum of the other modes; samples without weight are as the modes together make them."""
    theirs, every = waves(velocity, sampling_Hz, own_Hz, others_Hz)
    if usable is not None and not usable.all():
        for _ in range(FILLED):
            filled = np.where(usable, velocity, every)
            theirs, every = waves(filled, sampling_Hz, own_Hz, others_Hz)
    return theirs


def loud_lines(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, expected_Hz: float
) -> tuple[float, list[float]]:
    """Frequencies (Hz) of the mode and of other lines that are loud beside it, loudest first."""
    few = max(1, int(sampling_Hz / expected_Hz / SAMPLES))
    means = velocity[: velocity.size // few * few].reshape(-1, few) @ np.full(few, 1.0 / few)
    count = fft.prev_fast_len(means.size // 2, real=True)
    spectra = fft.rfft(np.stack([means[:count], means[-count:]]))
    spectra = spectra[:, 1:-1] - 0.5 * (spectra[:, :-2] + spectra[:, 2:])  # Hann's window
    early, late = np.abs(spectra)
    width = sampling_Hz / (few * count)
    frequency = np.arange(1, late.size + 1) * width
    own_Hz = mode_Hz(*loudest(means, sampling_Hz / few, expected_Hz), expected_Hz)
    # so far from where it is expected the mode may have moved, and other lines may be its own
    if abs(own_Hz / expected_Hz - 1.0) > APART or own_Hz > frequency[-1]:
        return own_Hz, []
    near = np.abs(frequency - own_Hz) < max(NEAREST * own_Hz, 6.0 * width)
    own = int(np.argmax(np.where(near, late, 0.0)))
    far = (frequency < max(LOWEST * own_Hz, 4.0 * width)) | (frequency > HIGHEST * own_Hz)
    rest = np.where(near | far, 0.0, late)
    found: list[float] = []
    reach = max(BESIDE * own_Hz, 6.0 * width)
    for _ in range(2 * MOST):
        at = int(np.argmax(rest))
        if rest[at] <= LOUD * late[own] or len(found) == MOST:
            break
        around = np.abs(np.abs(frequency - frequency[at]) / reach - 1.0) < 0.3
        # a mode of another amplitude may have rung elsewhere; not one so close that it may be ours
        moved = MOVED * frequency[at] if abs(frequency[at] - own_Hz) >= APART * own_Hz else 0.0
        then = np.abs(frequency - frequency[at]) < max(moved, 2.5 * width)
        before = np.sqrt((early[then] ** 2).sum())
        if late[at] > CLEAR * medians(late[around]) and before > GROWN * late[at]:
            found.append(float(frequency[at]))
        clear_of = APART * own_Hz if frequency[at] > SWAY * own_Hz else APART * frequency[at]
        rest[np.abs(frequency - frequency[at]) < max(clear_of, 3.0 * width)] = 0.0
    first = _loud_first(means, sampling_Hz / few, own_Hz)
    apart = [line for line in first if all(abs(line - one) >= APART * own_Hz for one in found)]
    return own_Hz, (found + apart)[:MOST]


def _loud_first(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, own_Hz: float
) -> list[float]:
    """Lines (Hz) beside the mode that are as loud in a decay's first cycles, loudest first."""
    count = int(FIRST_CYCLES * sampling_Hz / own_Hz)
    frequency, level = magnitudes(velocity[:count], sampling_Hz)
    off = np.abs(frequency - own_Hz) / own_Hz
    peak = np.zeros(level.size, bool)
    peak[1:-1] = (level[1:-1] > level[:-2]) & (level[1:-1] >= level[2:])
    own = level.max(where=peak & (off < 0.5 * APART), initial=0.0)
    peak &= (off >= APART) & (frequency < BELOW * own_Hz) & (level > LOUD_FIRST * own)
    if own < AUDIBLE * level.max(where=peak, initial=0.0):
        return []
    found: list[float] = []
    for k in sorted(np.flatnonzero(peak), key=lambda k: -level[k]):
        if all(abs(frequency[k] - one) >= APART * own_Hz for one in found):
            found.append(float(frequency[k]))
    return found


def waves(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    own_Hz: float,
    others_Hz: list[float],
) -> tuple[Float[ndarray, " sample"], Float[ndarray, " sample"]]:
    """The sum of the other modes in a decay (m/s), and that of all modes, mean and trend.

    Frames that overlap are fitted with all of them; in each a mode may grow and drift as a
    parabola of time. The first and the last frame also tell what lies at the ends. None is told
    from another, and both sums are zero, where the decay is shorter than a frame.
    """
    lines = [0.0, own_Hz, *others_Hz]
    least = min(abs(a - b) for k, a in enumerate(lines) for b in lines[:k])
    step = max(8, round(BEATS / least * sampling_Hz / STEPS))
    width = STEPS * step
    total, weight = np.zeros((2, velocity.size)), np.zeros(velocity.size)
    if velocity.size < width:
        return total[0], total[1]
    place = (np.arange(width) - 0.5 * (width - 1)) / (0.5 * width)
    powers = place[:, None] ** np.arange(3)
    turn = np.pi * width / sampling_Hz * np.outer(place, [*others_Hz, own_Hz])
    turning = np.stack([np.cos(turn), np.sin(turn)], axis=2)
    columns = turning[..., None] * powers[:, None, None]  # mode by mode
    columns = columns.reshape(width, -1)
    columns = np.hstack([columns, powers[:, :2]])
    shown = (slice(0, 6 * len(others_Hz)), slice(None))
    hann = 0.5 + 0.5 * np.cos(np.pi * place)
    found = in_frames(velocity, _solver(columns, hann).T, step)
    for k in range(STEPS):
        here = slice(k * step, (k + len(found)) * step)
        part = slice(k * step, (k + 1) * step)
        tapered = columns[part] * hann[part, None]
        for one, mine in zip(total, shown, strict=True):
            one[here] += (found[:, mine] @ tapered[:, mine].T).ravel()
        weight[here] += np.tile(hann[part], len(found))
    falling = 0.5 + 0.5 * np.cos(0.5 * np.pi * (1.0 + place))
    ends = (slice(0, width), falling), (slice(-width, None), falling[::-1])
    for here, taper in ends:
        at_end = _solver(columns, taper) @ velocity[here]
        lacking = np.maximum(0.5 * STEPS - weight[here], 0.0)
        for one, mine in zip(total, shown, strict=True):
            one[here] += lacking * (columns[:, mine] @ at_end[mine])
        weight[here] += lacking
    return total[0] / weight, total[1] / weight


def _solver(
    design: Float[ndarray, "sample column"], taper: Float[ndarray, " sample"]
) -> Float[ndarray, "column sample"]:
    """Least squares with weights as a matrix."""
    root = np.sqrt(taper)[:, None]
    return np.linalg.pinv(design * root) * root.T
