"""Follow one mode through a record, with the other modes taken off first."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray
from scipy import fft

from bladeroot.decay.carrier import rough_log_phasor
from bladeroot.decay.phasors import Phasors, block_edges, block_phasors
from bladeroot.decay.scatter import noise_ratio
from bladeroot.decay.smooth import smooth


@dataclass(frozen=True)
class Band:
    """A mode's frequency and the band (Hz) in which nothing else lies."""

    centre_Hz: float
    low_Hz: float
    high_Hz: float


def follow(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    band: Band,
    noise: float,
    refinements: int = 2,
    knots: int = 60,
    corrections: int = 0,
    others: Sequence[Complex[ndarray, " sample"]] = (),
) -> tuple[Phasors, Complex[ndarray, " sample"]]:
    """Block log-phasors of the mode in a band, and its smooth log-phasor at every sample.

    The blocks need a carrier that is right within each of them: first the filtered signal's,
    then `refinements` times a spline through the blocks, at last `corrections` by the blocks
    themselves where the spline misses them by more than the noise. Carriers of `others` are
    fitted along in each block.
    """
    carrier = rough_log_phasor(velocity, sampling_Hz, band.low_Hz, band.high_Hz, noise)
    sample_time = np.arange(velocity.size) / sampling_Hz
    for _ in range(refinements):
        edges = block_edges(carrier, sampling_Hz, noise)
        if edges.size < 9:
            raise ValueError(
                f"expected at least 8 whole cycles near {band.centre_Hz:.4g} Hz to follow the "
                f"mode, got {max(edges.size - 1, 0)}"
            )
        blocks = block_phasors(velocity, sampling_Hz, carrier, edges, noise, others)
        usable = _clear(blocks)
        if usable < 8:
            break
        blocks = Phasors(blocks.time[:usable], blocks.log[:usable], blocks.std[:usable])
        at = sites(blocks, knots)
        std = blocks.std * noise_ratio(blocks)
        level = smooth(blocks.time, blocks.log.real, std, at, at, iterations=15)
        phase = smooth(blocks.time, blocks.log.imag, std, at, at, iterations=15)
        carrier = hermite(
            sample_time,
            at,
            level.value[0] + 1j * phase.value[0],
            level.value[1] + 1j * phase.value[1],
        )
        # a short mode's growth must not run away where it is continued
        carrier.real = np.minimum(carrier.real, level.value[0].max() + 0.5)
    for _ in range(corrections):
        edges = block_edges(carrier, sampling_Hz, noise)
        if edges.size < 9:
            break
        corrected = block_phasors(velocity, sampling_Hz, carrier, edges, noise, others)
        usable = _clear(corrected)
        if usable < 8:  # worse than before: keep what there was
            break
        blocks = Phasors(corrected.time[:usable], corrected.log[:usable], corrected.std[:usable])
        carrier = carrier + _correction(blocks, carrier, sampling_Hz, sample_time)
    return blocks, carrier


def _correction(
    blocks: Phasors,
    carrier: Complex[ndarray, " sample"],
    sampling_Hz: float,
    sample_time: Float[ndarray, " sample"],
) -> Complex[ndarray, " sample"]:
    """What the carrier misses by far more than the noise, as where slip ends within a cycle."""
    at = blocks.time * sampling_Hz
    floor = np.floor(at).astype(int)
    own = carrier[floor] + (carrier[floor + 1] - carrier[floor]) * (at - floor)
    miss = blocks.log - own
    size = np.abs(miss) ** 2
    miss = miss * size / (size + (5.0 * blocks.std) ** 2)
    inside = (sample_time >= blocks.time[0]) & (sample_time <= blocks.time[-1])
    correction = hermite(sample_time, blocks.time, miss, np.gradient(miss, blocks.time))
    return np.where(inside, correction, 0.0)


def sites(blocks: Phasors, most: int) -> Float[ndarray, " site"]:
    """Places for a spline's knots: even in log-amplitude as much as in number of blocks."""
    lowest = np.minimum.accumulate(blocks.log.real)
    fall = (lowest[0] - lowest) / max(lowest[0] - lowest[-1], 1e-9)
    clock = 0.5 * fall + 0.5 * np.linspace(0.0, 1.0, blocks.time.size)
    count = max(min(most, blocks.time.size // 2), 4)
    # a stretch that grows has no fall, and its clock would end early
    return np.interp(np.linspace(0.0, clock[-1], count), clock, blocks.time)


def _clear(blocks: Phasors, worst: float = 0.3) -> int:
    """Number of blocks before the mode is lost in the noise."""
    lost = np.flatnonzero(blocks.std > worst)
    return int(lost[0]) if lost.size else blocks.std.size


def hermite(
    time: Float[ndarray, " sample"],
    knot: Float[ndarray, " knot"],
    value: Complex[ndarray, " knot"],
    slope: Complex[ndarray, " knot"],
) -> Complex[ndarray, " sample"]:
    """Piecewise cubic through values and slopes, continued as a straight line."""
    left = np.clip(np.searchsorted(knot, time, side="right") - 1, 0, knot.size - 2)
    step = np.diff(knot)[left]
    s = np.clip((time - knot[left]) / step, 0.0, 1.0)
    inside = (
        (1 + 2 * s) * (1 - s) ** 2 * value[left]
        + s * (1 - s) ** 2 * step * slope[left]
        + s * s * (3 - 2 * s) * value[left + 1]
        - s * s * (1 - s) * step * slope[left + 1]
    )
    before, after = np.minimum(time - knot[0], 0.0), np.maximum(time - knot[-1], 0.0)
    return inside + before * slope[0] + after * slope[-1]


def strongest_other(
    residual: Float[ndarray, " sample"],
    sampling_Hz: float,
    taken: list[Band],
    strength: float,
    cycles: float = 12.0,
    ratio: float = 8.0,
) -> Band | None:
    """The clearest spectral line outside the bands already taken, or None.

    Looks at several spans from the record's start, since a mode that decays fast is only seen
    in a short one; a line must stand `ratio` above the median level, around it and overall, and
    above a fifty-thousandth of `strength`, the main mode's amplitude.
    """
    best, found = ratio, None
    low_Hz = taken[0].centre_Hz / 8.0
    for fraction in (1.0, 0.25, 1.0 / 16.0, 1.0 / 64.0):
        count = int(residual.size * fraction)
        if count < cycles * sampling_Hz / taken[0].centre_Hz:
            break
        window = np.hanning(count)
        padded = fft.next_fast_len(2 * count, real=True)
        level = np.abs(fft.rfft(residual[:count] * window, padded))
        frequency = fft.rfftfreq(padded, 1.0 / sampling_Hz)
        width = 4.0 * sampling_Hz / count
        open_ = (frequency > max(low_Hz, width, 16.0 * sampling_Hz / residual.size)) & (
            frequency < 0.48 * sampling_Hz
        )
        for band in taken:
            half = max(width, 0.02 * band.centre_Hz)
            open_ &= np.abs(frequency - band.centre_Hz) > half
        if open_.sum() < 16:
            continue
        peak = int(np.argmax(np.where(open_, level, 0.0)))
        reach = int(width / frequency[1])
        around = level[max(peak - 4 * reach, 0) : peak + 4 * reach + 1]
        floor = max(np.median(level[open_]), np.median(around), 2e-5 * strength * window.sum() / 2)
        is_line = level[peak] == level[max(peak - 2 * reach, 0) : peak + 2 * reach + 1].max()
        if is_line and level[peak] / floor > best:
            best, found = level[peak] / floor, float(frequency[peak])
    if found is None:
        return None
    gap = min(abs(found - band.centre_Hz) for band in taken)
    half = min(0.4 * found, 0.5 * gap, 0.45 * sampling_Hz - found)
    return Band(found, found - half, found + half)


def separate(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    band: Band,
    noise: float,
    most: int = 4,
    rounds: int = 2,
) -> tuple[Float[ndarray, " sample"], list[Band], list[Complex[ndarray, " sample"]]]:
    """The record without the other modes, where they lie, and their carriers.

    Each is followed in what the rest leave over and taken off, `rounds` times round, so that no
    filter has to hold them back and the first cycles stay usable.
    """
    wave, carrier = _part(velocity, sampling_Hz, band, noise)
    bands, waves, carriers = [band], [wave], [carrier]
    residual = velocity - wave
    strength = float(np.abs(wave).max())
    while len(bands) <= most:
        other = strongest_other(residual, sampling_Hz, bands, strength)
        if other is None or other.high_Hz - other.low_Hz < 8.0 * sampling_Hz / velocity.size:
            break
        tried, rest = [*waves, np.zeros_like(velocity)], residual
        found = [*carriers, carrier]
        try:
            for _ in range(rounds):
                for k in reversed(range(len(tried))):
                    rest = rest + tried[k]
                    tried[k], found[k] = _part(rest, sampling_Hz, [*bands, other][k], noise)
                    rest = rest - tried[k]
        except ValueError:  # a line that cannot be followed is no mode
            break
        if rest @ rest >= residual @ residual:
            break
        bands, waves, carriers, residual = [*bands, other], tried, found, rest
    return residual + waves[0], bands[1:], carriers[1:]


def _part(
    rest: Float[ndarray, " sample"], sampling_Hz: float, band: Band, noise: float
) -> tuple[Float[ndarray, " sample"], Complex[ndarray, " sample"]]:
    """The mode as followed, up to where it is lost in the noise, and its carrier."""
    blocks, carrier = follow(rest, sampling_Hz, band, noise, refinements=1)
    wave = np.exp(carrier).real
    last, gone = blocks.time[-1], rest.size / sampling_Hz - blocks.time[-1]
    if gone > 2.0 * (last - blocks.time[-2]):
        wave[int(np.ceil(last * sampling_Hz)) + 1 :] = 0.0
    return wave, carrier
