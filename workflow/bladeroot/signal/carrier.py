"""A first, rough log-phasor of one mode: where its cycles lie and how fast it decays."""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray
from scipy import fft

from bladeroot.signal.phasors import Frames, Phasors, Segment, fit_frames, gather


def strongest_line(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    low_Hz: float,
    high_Hz: float,
    cycles: float = 100.0,
) -> float:
    """Frequency (Hz) of the strongest line within a band in the first cycles, the loudest."""
    count = min(int(cycles * sampling_Hz / low_Hz), velocity.size)
    if count > 1000:
        count = fft.prev_fast_len(count, real=True)
    spectrum = fft.rfft(velocity[:count])
    level = np.abs(spectrum[1:-1] - 0.5 * (spectrum[:-2] + spectrum[2:]))  # Hann's window
    frequency = np.arange(1, level.size + 1) * sampling_Hz / count
    inside = (frequency >= low_Hz) & (frequency <= high_Hz)
    if not inside.any():
        raise ValueError(
            f"expected a line between {low_Hz:.4g} and {high_Hz:.4g} Hz, but {count} samples "
            f"at {sampling_Hz:.6g} Hz do not resolve that band"
        )
    return float(frequency[np.argmax(np.where(inside, level, 0.0))])


def rough_phasors(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    line_Hz: float,
    noise: float,
    usable: Bool[ndarray, " sample"] | None = None,
) -> tuple[Phasors, Float[ndarray, " block"]]:
    """Log-phasors of blocks of the mode near a frequency, good to some per cent of a radian.

    And their phases less a smoothed advance, in which their scatter shows.

    Raises ValueError where fewer than eight cycles can be followed.
    """
    cycle = sampling_Hz / line_Hz
    length = round(np.ceil(12.0 / cycle) * cycle)  # enough samples for the fit's three columns
    count = velocity.size // length
    if count < 8:
        raise ValueError(
            f"expected at least 8 whole cycles near {line_Hz:.4g} Hz to follow the mode, got "
            f"{velocity.size / cycle:.3g}"
        )
    angle = 2.0 * np.pi * line_Hz / sampling_Hz
    frames = fit_frames(velocity, sampling_Hz, noise, [Segment(0, length, count, angle)], usable)
    if frames.time.size < 8:
        raise ValueError(
            f"expected at least 8 usable cycles near {line_Hz:.4g} Hz, got {frames.time.size}"
        )
    turn = _turning(frames)
    still = frames.phasor * np.exp(-1j * turn)
    envelope, last = _envelope(frames, still)
    level = np.log(np.maximum(envelope, 1e-3 * frames.std))
    blocks, miss = gather(
        frames.time[:last], frames.phasor[:last], frames.std[:last], (level + 1j * turn)[:last]
    )
    if blocks.time.size < 8:
        raise ValueError(
            f"expected at least 8 cycles near {line_Hz:.4g} Hz above the noise, got "
            f"{blocks.time.size}"
        )
    return blocks, miss.imag


def _turning(frames: Frames) -> Float[ndarray, " frame"]:
    """The phase as the smoothed advance from frame to frame adds it up."""
    base = frames.phasor * np.exp(-1j * frames.omega * frames.time)
    step = np.diff(frames.time)
    advance = base[1:] * base[:-1].conj()
    apart = step > 1.5 * step.min()  # across a gap the advance is ambiguous
    advance[apart] = 0.0
    reach = int(np.clip(step.size // 100, 1, 10))
    near = _moving_sum(advance, reach)
    noise = _moving_sum(frames.std[1:] ** 2 * 2.0 * np.abs(base[1:] * base[:-1]), reach)
    clear = np.abs(near) > 3.0 * np.sqrt(noise * frames.std.min() ** 2 + 1e-300)
    lost = np.flatnonzero(~clear)
    detune = np.angle(near) / step.min()
    if lost.size and lost[0] > 4:  # beyond, as it was last
        last = int(lost[0])
        segment = slice(max(0, last - max(last // 5, 4)), last)
        detune[last:] = np.angle(advance[segment].sum()) / step.min()
    elif lost.size:
        detune[:] = np.angle(advance.sum()) / step.min()
    turn = np.concatenate([[0.0], np.cumsum(detune * step)])
    return turn + frames.omega * frames.time


def _envelope(frames: Frames, still: ndarray) -> tuple[Float[ndarray, " frame"], int]:
    """Amplitude of the frames, from ever more of them as the mode fades; where it has drowned."""
    found, last = np.abs(still), still.size
    for reach in (2, 8, 32):
        weak = found < 6.0 * frames.std
        if 4 * reach > found.size or not weak.any():
            break
        count = _moving_sum(np.ones(found.size), reach)
        wider = np.abs(_moving_sum(still, reach)) / count
        drowned = np.flatnonzero(weak & (wider < 3.0 * frames.std / np.sqrt(count)))
        last = int(drowned[0]) if drowned.size else still.size
        found = np.where(weak, wider, found)
    return found, max(last, min(8, still.size))


def _moving_sum(values: ndarray, reach: int) -> ndarray:
    """Sum over `reach` neighbours on either side."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    own = np.arange(values.size)
    return total[np.minimum(own + reach + 1, values.size)] - total[np.maximum(own - reach, 0)]
