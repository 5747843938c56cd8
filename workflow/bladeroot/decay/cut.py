"""Find the free decay in a record by itself (thesis 2.1.3, 3.1.1, figs 2.5, 3.1, 3.2).

A record is quiet (the tip preloaded), then driven near the mode, then released, then decays
freely, and later the tip returns; or the decay follows a hammer's blow (or several) or a step
release, or the record begins in it.
"""

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.decay.ending import RISE, find_end, running_power, strikes
from bladeroot.decay.release import Release, find_release
from bladeroot.signal.envelope import Envelope, envelope
from bladeroot.signal.lines import HIGHEST_OF_SAMPLING, quantum, white_noise
from bladeroot.signal.turning import clean_falls
from bladeroot.variables import dataset

# A decay has so many cycles; a record twice as many, in which it is looked for.
FEWEST_CYCLES = 5

# Factors by which the envelope of a free decay falls at least.
LEAST_FALL = 2.0  # 6 dB: beats of a drive may fall by as much, not more
FALL_AFTER_RELEASE = 1.1  # where it is known when the mode was let go
FALL_THROUGHOUT = 1.25  # where it falls all the time, over this part of the record:
THROUGHOUT = 0.95

# The smoothed envelope in which falls are looked for.
SMOOTHING = 8  # frames
ABOVE_NOISE = 5.0  # over the noise's amplitude: a weaker mode rises and falls with it by half
LOUD_CYCLES = 200  # of the record's loudest part, from which the mode's own frequency is taken

# Where noise is less than this part of a digitiser's step, nothing blurs the steps; a mode of fewer
# steps then follows them, not itself.
BLURRED = 0.45
STEPS = 8.0

# Random vibration, of which no mode is let go, falls again and again, and rises as slowly.
FALLS = 3  # at least
AS_SLOWLY = 0.5  # median time of a rise over that of the fall after it, each from a quarter of the
# fall to the other: a blow takes none, a drive a third
STANDS_OUT = 1.0  # largest top over the median one, of ln A: more is a blow's, or a drive's end
ONE_BY_ONE = 0.75  # part of the tops that are lower than the one before: of more, two modes beat
AMBIENT = "ambient"

BINS = 1000  # of the overview of a record


def cut(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    end: float | str = "noise",
    release: Release | None = None,
    least: float | None = None,
    noise: float | None = None,
) -> xr.Dataset:
    """The free decay of one mode, from the release to its end.

    Of several decays in a record, the one with the largest clean fall is taken. It ends where the
    mode is lost in the noise, or where something disturbs it (the tip's return, another blow), or,
    with hardly any noise, where it is but some steps of the digitiser high.
    Attributes: `release_s` and `release_std_s` (the release and its standard error),
    `excitation` ("shaker", "at once" or "begins in the decay"; "ambient" where nothing is let go),
    `fall` (factor by which the smoothed envelope falls), `decays` (those in the record at least
    half as deep as this one),
    `start_s` and `end_s` (first and last sample kept, in the raw record's time), `end_reason`,
    `noise_velocity` (m/s, rms), `verdict` and `findings`. A record that cannot be used is returned
    with verdict "rejected" and one line in findings; its `time` may be empty.

    Args:
        velocity: the raw record in m/s.
        sampling_Hz: sampling frequency.
        expected_Hz: the mode's expected frequency.
        end: "noise", or the part of its first value at which the envelope shall end, if it gets
            there before (the thesis's 1/1000, 3.1.1).
        release: when and how the decay was let go, where that is known.
        least: amplitude (m/s) at which a digitiser's steps show; from these samples, unless given.
        noise: rms of the sensor's noise (m/s); from these samples, unless given.
    """
    noise = sensor_noise(velocity) if noise is None else noise
    least = coarse(velocity) if least is None else least
    attrs: dict[str, float | str | int] = _nothing() | {
        "sampling_Hz": float(sampling_Hz), "noise_velocity": noise,
    }  # fmt: skip
    span, finding = (0, 0), too_fast_or_short(velocity.size, sampling_Hz, expected_Hz)
    if not finding:
        span, finding = _span(velocity, sampling_Hz, expected_Hz, noise, least, end, attrs, release)
    attrs["verdict"] = "rejected" if finding else "usable"
    attrs["findings"] = finding
    return cut_out(velocity, sampling_Hz, span, attrs)


def too_fast_or_short(samples: int, sampling_Hz: float, expected_Hz: float) -> str:
    """Why so many samples cannot hold a decay of a mode, or ""."""
    if expected_Hz >= HIGHEST_OF_SAMPLING * sampling_Hz:
        return (
            f"the mode's frequency {expected_Hz:.6g} Hz lies above {HIGHEST_OF_SAMPLING} of the "
            f"sampling frequency {sampling_Hz:.6g} Hz"
        )
    duration = samples / sampling_Hz
    if duration * expected_Hz < 2 * FEWEST_CYCLES:
        return (
            f"too short: {duration:.4g} s hold {duration * expected_Hz:.3g} cycles at "
            f"{expected_Hz:.6g} Hz, at least {2 * FEWEST_CYCLES} are needed"
        )
    return ""


def decay_starts(
    velocity: Float[ndarray, " sample"], sampling_Hz: float, expected_Hz: float
) -> list[float]:
    """When the decays in a record begin that `cut` chooses from, to some frames, s."""
    noise = sensor_noise(velocity)
    own_Hz = _own_frequency(velocity, sampling_Hz, expected_Hz)
    seen = envelope(velocity, sampling_Hz, own_Hz)
    fall, level, found = _falls(seen, seen.noise(noise, sampling_Hz), strikes(seen, noise))
    if fall < np.log(_least_fall(seen, *found[0])):
        return []
    return sorted(float(seen.time[p]) for p, _ in _deep(fall, level, found))


def sensor_noise(samples: Float[ndarray, " sample"]) -> float:
    """Rms of the noise; where the last digits stand still, at least that of the rounding."""
    return max(white_noise(samples), quantum(samples) / np.sqrt(12.0))


def coarse(samples: Float[ndarray, " sample"]) -> float:
    """Amplitude below which a digitiser's steps show, zero where noise blurs them."""
    white, step = white_noise(samples), quantum(samples)
    return STEPS * step if white < BLURRED * step else 0.0


def rejected(finding: str) -> xr.Dataset:
    """The record of a file that could not be read: no samples, and one line that says why."""
    attrs = _nothing() | {"verdict": "rejected", "findings": finding}
    return cut_out(np.zeros(0), float("nan"), (0, 0), attrs)


def _nothing() -> dict[str, float | str | int]:
    """The attributes of a record in which no decay has been found yet."""
    numbers = (
        "sampling_Hz", "release_s", "release_std_s", "start_s", "end_s", "noise_velocity", "fall",
    )  # fmt: skip
    return dict.fromkeys(numbers, float("nan")) | {"excitation": "", "decays": 0, "end_reason": ""}


def _own_frequency(velocity: ndarray, sampling_Hz: float, expected_Hz: float) -> float:
    """The mode's frequency as the loudest frames show it: the expected one may be off."""
    loudest = int(np.argmax(np.abs(velocity)))
    count = int(LOUD_CYCLES * sampling_Hz / expected_Hz)
    first = max(0, min(loudest - count // 2, velocity.size - count))
    seen = envelope(velocity[first : first + count], sampling_Hz, expected_Hz)
    loud = seen.level[:-1] > seen.level.max() - np.log(2.0)
    if not loud.any():
        return expected_Hz
    turn = np.median(np.diff(seen.log.imag)[loud]) / seen.step_s
    return float(np.clip(expected_Hz + turn / (2.0 * np.pi), 0.5 * expected_Hz, 1.5 * expected_Hz))


def _span(
    velocity: ndarray,
    sampling_Hz: float,
    expected_Hz: float,
    noise: float,
    least: float,
    end: float | str,
    attrs: dict[str, float | str | int],
    known: Release | None,
) -> tuple[tuple[int, int], str]:
    """First sample and one past the last of the deepest decay, or what is amiss."""
    begin_s = 0.0 if known is None else known.time_s
    least_samples = int(2 * FEWEST_CYCLES * sampling_Hz / expected_Hz)  # which every record has
    looked = min(int(begin_s * sampling_Hz), velocity.size - least_samples)
    own_Hz = _own_frequency(velocity[looked:], sampling_Hz, expected_Hz)
    seen = envelope(velocity, sampling_Hz, own_Hz)
    floor, broken = seen.noise(noise, sampling_Hz), strikes(seen, noise)
    first = min(int(np.searchsorted(seen.time, begin_s)), seen.time.size - 2)
    fall, level, found = _falls(seen, floor, broken, first)
    peak, trough = found[0]
    least_fall = _least_fall(seen, peak, trough, begin_s)
    attrs["fall"] = float(np.exp(fall))
    if fall < np.log(least_fall):
        return (0, 0), (
            f"no free decay found near {expected_Hz:.6g} Hz: the envelope falls at most by a "
            f"factor of {np.exp(fall):.3g}, at least {least_fall:g} is needed"
        )
    deep = _deep(fall, level, found)
    if known is None and _ambient(level, deep):
        attrs["excitation"] = AMBIENT
        return (0, 0), (
            f"no free decay near {expected_Hz:.6g} Hz: random vibration, such as wind's or "
            f"traffic's, whose envelope rises as slowly as it falls, {len(deep)} times; if the "
            "mode is let go somewhere in it, give start_s"
        )
    release = known or find_release(velocity, sampling_Hz, seen, floor, level, peak, trough)
    start_s = release.time_s + 2.0 * release.std_s
    begin = min(int(np.searchsorted(seen.time, start_s + 0.5 * seen.frame_s)), trough)
    ratio = 0.0 if end == "noise" else float(end)
    end_s, reason = find_end(seen, floor, least, level, broken, begin, trough, ratio)
    end_s = min(end_s, velocity.size / sampling_Hz)
    first, stop = int(np.ceil(start_s * sampling_Hz)), int(np.floor(end_s * sampling_Hz))
    attrs |= {
        "release_s": release.time_s, "release_std_s": release.std_s,
        "excitation": release.excitation,
        "decays": len(deep),
        "start_s": first / sampling_Hz, "end_s": (stop - 1) / sampling_Hz, "end_reason": reason,
    }  # fmt: skip
    if not velocity[first:stop].any():
        return (first, first), f"nothing but zeros from {start_s:.4g} s to {end_s:.4g} s"
    cycles = (stop - first) / sampling_Hz * expected_Hz
    if cycles < FEWEST_CYCLES:
        return (first, max(stop, first)), (
            f"too short: the free decay holds {max(cycles, 0.0):.3g} cycles from {start_s:.4g} s "
            f"to {end_s:.4g} s ({reason}), at least {FEWEST_CYCLES} are needed"
        )
    return (first, stop), ""


def _least_fall(seen: Envelope, peak: int, trough: int, begin_s: float = 0.0) -> float:
    """By how much a decay from one frame to another falls at least, let go at a known time."""
    if begin_s > 0.0:
        return FALL_AFTER_RELEASE
    return FALL_THROUGHOUT if trough - peak > THROUGHOUT * seen.time.size else LEAST_FALL


def _falls(
    seen: Envelope, noise: float, broken: ndarray, first: int = 0
) -> tuple[float, Float[ndarray, " frame"], list[tuple[int, int]]]:
    """Largest fall of ln A from frame `first` on, the smoothed level that shows it, all falls."""
    least = max(ABOVE_NOISE * noise, 1e-12 * np.exp(seen.level.max()), 1e-150)
    level = 0.5 * np.log(np.maximum(running_power(seen, SMOOTHING), least**2))
    found = clean_falls(level[first:], RISE, broken[first:])
    found = [(first + p, first + t) for p, t in found]
    return level[found[0][0]] - level[found[0][1]], level, found


def _deep(fall: float, level: ndarray, found: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The falls of ln A that are at least half of the largest."""
    return [(p, t) for p, t in found if level[p] - level[t] > 0.5 * fall]


def _ambient(level: Float[ndarray, " frame"], deep: list[tuple[int, int]]) -> bool:
    """Whether falls of ln A are those of random vibration: alike forwards and backwards."""
    falls = sorted(deep)
    tops = level[[p for p, _ in falls]]
    # a blow's first top is the highest, of a drive that ends the last fall is the largest
    if len(falls) < FALLS or tops.argmax() == 0 or deep[0] == falls[-1]:
        return False
    if tops.max() - np.median(tops) > STANDS_OUT or np.mean(np.diff(tops) < 0.0) > ONE_BY_ONE:
        return False
    ratio = []
    for p, t in falls:
        quarters = level[p] - np.array([0.25, 0.75]) * (level[p] - level[t])
        sides = level[p::-1], level[p:]
        low = [[np.flatnonzero(side < one) for one in quarters] for side in sides]
        if all(one.size for side in low for one in side):
            rise, fall = (far[0] - near[0] for near, far in low)
            ratio.append(rise / max(fall, 1))
    return bool(ratio) and float(np.median(ratio)) > AS_SLOWLY


def cut_out(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    span: tuple[int, int],
    attrs: dict[str, float | str | int],
) -> xr.Dataset:
    """The samples from one to another as a Dataset, with an overview of the record for figures."""
    piece = velocity[span[0] : span[1]]
    count = max(min(BINS, velocity.size), 1)
    edges = np.arange(count + 1 if velocity.size else 1) * velocity.size // count
    at = edges[:-1]
    low, high = (
        (extreme.reduceat(velocity, at) if at.size else np.zeros(0))
        for extreme in (np.minimum, np.maximum)
    )
    made = {
        "velocity": piece, "time": np.arange(float(piece.size)) / sampling_Hz,
        "overview_time": 0.5 * (at + edges[1:]) / sampling_Hz,
        "overview_min": low, "overview_max": high,
    }  # fmt: skip
    return dataset("decay/cut", made).assign_attrs(attrs)
