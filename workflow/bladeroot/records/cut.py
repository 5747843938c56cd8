"""Find the free decay in a record by itself (thesis 2.1.3, 3.1.1, figs 2.5, 3.1, 3.2).

A record is quiet (the tip preloaded), then driven near the mode, then released, then decays
freely, and later the tip returns; or it starts with a hammer's blow or in the decay itself.
"""

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.records.envelope import Envelope, envelope
from bladeroot.records.integrity import clipped_runs, strongest_line
from bladeroot.records.spectrum import white_noise
from bladeroot.records.turning import largest_fall, release_kink

FEWEST_CYCLES = 20


def cut(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    tolerance: float = 0.3,
    end_ratio: float = 1e-3,
    margin_cycles: float = 4.0,
    bins: int = 1000,
) -> xr.Dataset:
    """The free decay of one mode, from just after the release to its end.

    The end is where the envelope has fallen to `end_ratio` of its start (3.1.1), or where it
    meets the noise, or just before the tip returns, whichever comes first. Attributes: `release_s`
    (estimated release, or start of the record), `start_s` and `end_s` (first and last sample
    kept, in the raw record's time), `end_reason`, `noise_velocity` (m/s, rms), `verdict` and
    `findings`. A record that cannot be used is returned with verdict "rejected" and one line in
    findings; its `time` may be empty.

    Args:
        velocity: the raw record in m/s.
        sampling_Hz: sampling frequency.
        expected_Hz: the mode's expected frequency.
        tolerance: relative distance from expected_Hz within which the mode must lie.
        end_ratio: end of the decay relative to its start.
        margin_cycles: cycles left out after the release.
        bins: bins of the overview kept for figures.
    """
    noise = white_noise(velocity)
    attrs: dict[str, float | str] = {
        "sampling_Hz": float(sampling_Hz), "release_s": float("nan"), "start_s": float("nan"),
        "end_s": float("nan"), "end_reason": "", "noise_velocity": noise,
    }  # fmt: skip
    span, finding = (0, 0), ""
    low, high = expected_Hz * (1.0 - tolerance), expected_Hz * (1.0 + tolerance)
    duration = velocity.size / sampling_Hz
    if expected_Hz >= 0.45 * sampling_Hz:
        finding = (
            f"expected_Hz {expected_Hz:.6g} lies above 0.45 of the sampling frequency "
            f"{sampling_Hz:.6g} Hz"
        )
    elif duration * expected_Hz < 2 * FEWEST_CYCLES:
        finding = (
            f"too short: {duration:.4g} s hold {duration * expected_Hz:.3g} cycles at "
            f"{expected_Hz:.6g} Hz, at least {2 * FEWEST_CYCLES} are needed"
        )
    else:
        seen = envelope(velocity, sampling_Hz, _own_frequency(velocity, sampling_Hz, expected_Hz))
        span, finding = _span(
            velocity, sampling_Hz, expected_Hz, seen, noise, end_ratio, margin_cycles, attrs
        )
        if not finding:
            finding = _faults(velocity, sampling_Hz, expected_Hz, low, high, span)
    attrs["verdict"] = "rejected" if finding else "usable"
    attrs["findings"] = finding
    return _dataset(velocity, sampling_Hz, span, attrs, bins)


def rejected(finding: str) -> xr.Dataset:
    """The record of a file that could not be read: no samples, and one line that says why."""
    attrs: dict[str, float | str] = dict.fromkeys(
        ("sampling_Hz", "release_s", "start_s", "end_s", "noise_velocity"), float("nan")
    )
    attrs |= {"end_reason": "", "verdict": "rejected", "findings": finding}
    return _dataset(np.zeros(0), float("nan"), (0, 0), attrs, 0)


def _span(
    velocity: ndarray,
    sampling_Hz: float,
    expected_Hz: float,
    seen: Envelope,
    noise: float,
    end_ratio: float,
    margin_cycles: float,
    attrs: dict[str, float | str],
) -> tuple[tuple[int, int], str]:
    """First sample and one past the last of the decay, or what is amiss."""
    floor = 1.5 * seen.noise(noise, sampling_Hz)
    # noise makes an envelope this weak rise now and then: such a rise is not the tip's
    weak = max(4.0 * floor, 1e-12 * seen.amplitude.max())
    level = np.log(np.maximum(seen.amplitude, weak))
    peak, trough = largest_fall(level, rise=np.log(1.5))
    fall = level[peak] - level[trough]
    if fall < np.log(4.0):
        return (0, 0), (
            f"no free decay found near {expected_Hz:.6g} Hz: the envelope falls at most by a "
            f"factor of {np.exp(fall):.3g}, at least 4 is needed"
        )
    release, margin = _release(seen, level, peak, trough, expected_Hz, margin_cycles)
    start_s = release + margin
    begin = min(int(np.searchsorted(seen.time, start_s)), trough)
    strike = _tip_return(seen, begin, trough, noise)
    if strike is not None and level[begin] - level[max(strike - 3, begin)] < 0.03:
        # nothing had fallen before it: that was the tip leaving, not returning
        release, margin = float(seen.time[strike]), 2.0 * seen.frame_s
        start_s = release + margin
        begin = min(int(np.searchsorted(seen.time, start_s)), trough)
    amplitude, half = seen.amplitude, 0.5 * seen.frame_s
    ends = [(velocity.size / sampling_Hz, "end of the record")]
    last = trough
    if level[trough] <= np.log(weak):
        # weak frames: what a median over them shows, up to the noise or something loud
        lost = np.flatnonzero(_calm(amplitude[begin:]) <= floor)
        last = begin + int(lost[0]) if lost.size else amplitude.size - 1
        loud = np.flatnonzero(amplitude[trough : last + 1] > 2.0 * weak)
        if loud.size:
            ends.append((seen.time[trough + loud[0]] - 2.0 * half, "the tip's return"))
        elif lost.size:
            ends.append((seen.time[last], "the noise"))
    elif trough < level.size - 3:
        ends.append((seen.time[trough] - half, "the tip's return"))
    below = np.flatnonzero(_calm(amplitude[begin : last + 1]) < end_ratio * amplitude[begin])
    if below.size:
        ends.append((seen.time[begin + below[0]], f"{end_ratio:g} of the first envelope"))
    back = _tip_return(seen, begin, last, noise)
    if back is not None:
        ends.append((seen.time[back] - half - 1.0 / expected_Hz, "the tip's return"))
    end_s, reason = min(ends)
    first, stop = int(np.ceil(start_s * sampling_Hz)), int(np.floor(end_s * sampling_Hz))
    attrs |= {
        "release_s": float(release), "start_s": first / sampling_Hz,
        "end_s": (stop - 1) / sampling_Hz, "end_reason": reason,
    }  # fmt: skip
    cycles = (stop - first) / sampling_Hz * expected_Hz
    if cycles < FEWEST_CYCLES:
        return (first, max(stop, first)), (
            f"too short: the free decay holds {max(cycles, 0.0):.3g} cycles from {start_s:.4g} s "
            f"to {end_s:.4g} s ({reason}), at least {FEWEST_CYCLES} are needed"
        )
    return (first, stop), ""


def _own_frequency(velocity: ndarray, sampling_Hz: float, expected_Hz: float) -> float:
    """The mode's frequency as the loudest frames show it: the expected one may be off."""
    seen = envelope(velocity, sampling_Hz, expected_Hz)
    loud = seen.amplitude[:-1] > 0.5 * seen.amplitude.max()
    turn = np.median(np.diff(seen.phase)[loud] / np.diff(seen.time)[loud])
    return float(np.clip(expected_Hz + turn / (2.0 * np.pi), 0.5 * expected_Hz, 1.5 * expected_Hz))


def _release(
    seen: Envelope,
    level: ndarray,
    peak: int,
    trough: int,
    expected_Hz: float,
    margin_cycles: float,
) -> tuple[float, float]:
    """Time of the release and what to leave out after it.

    The kink where a steady level turns into a decline, if there is one near the top of the fall;
    else the peak itself (a blow), or the record's start when it begins in the decay.
    """
    high = np.flatnonzero(level[: trough + 1] > level[peak] - np.log(1.5))
    first = int(high[0])
    last = min(int(high[-1]) + 1, trough)
    # as many frames as the decline needs to fall by a quarter, at least 8 cycles
    fallen = np.flatnonzero(level[last : trough + 1] < level[last] - 0.25)
    reach = int(np.clip(fallen[0] if fallen.size else 400, 16, 400))
    kink = None
    for window in (reach, max(reach // 3, 12), 24, 12):
        found = release_kink(level, seen.phase, first, last + 2, min(window, reach))
        if found is not None:
            # a shorter window is sharper: look again close by
            kink, first, last = found, found - window // 2, found + window // 2
    if kink is not None:
        return float(seen.time[kink]), margin_cycles / expected_Hz
    if peak <= 6:
        return 0.0, 0.0
    return float(seen.time[peak]), 0.5 * seen.frame_s + margin_cycles / expected_Hz


def _calm(amplitude: ndarray, reach: int = 7) -> ndarray:
    """Running median over some cycles."""
    padded = np.pad(amplitude, reach, mode="edge")
    return np.median(np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1), axis=1)


def _tip_return(seen: Envelope, begin: int, last: int, noise: float) -> int | None:
    """First frame in which something strikes: the rest jumps far above what it was before."""
    reach = 20
    rest = seen.rest[begin : last + 1]
    if rest.size < 3 * reach:
        return None
    before = np.lib.stride_tricks.sliding_window_view(rest, reach)
    usual = np.maximum(np.max(before, axis=1), noise)
    ahead = rest[reach + 4 :]
    struck = np.flatnonzero(ahead > 5.0 * usual[: ahead.size])
    return begin + reach + 4 + int(struck[0]) if struck.size else None


def _faults(
    velocity: ndarray,
    sampling_Hz: float,
    expected_Hz: float,
    low: float,
    high: float,
    span: tuple[int, int],
) -> str:
    """One line on what makes a found decay unusable, or an empty text."""
    piece = velocity[span[0] : span[1]]
    early = piece[: max(piece.size // 4, min(piece.size, int(40 * sampling_Hz / expected_Hz)))]
    strongest, own, ratio = strongest_line(early, sampling_Hz, low, high)
    if ratio < 0.2:
        return (
            f"another mode dominates: the strongest line is at {strongest:.6g} Hz, what lies "
            f"within {low:.6g} to {high:.6g} Hz has {100 * ratio:.2g} % of it"
        )
    count = clipped_runs(velocity, *span, own, sampling_Hz)
    if count >= 2:
        return (
            f"clipped: {count} flat tops at {np.abs(velocity).max():.4g} m/s within the free decay"
        )
    return ""


def _dataset(
    velocity: ndarray,
    sampling_Hz: float,
    span: tuple[int, int],
    attrs: dict[str, float | str],
    bins: int,
) -> xr.Dataset:
    piece = velocity[span[0] : span[1]]
    edges = np.unique(np.linspace(0, velocity.size, min(bins, velocity.size) + 1).astype(int))
    at = edges[:-1]
    low, high = (
        (extreme.reduceat(velocity, at) if at.size else np.zeros(0))
        for extreme in (np.minimum, np.maximum)
    )
    return xr.Dataset(
        {
            "velocity": (
                "time", piece, {"units": "m/s", "long_name": "velocity of the free decay"}
            ),
            "overview_time": (
                "bin", 0.5 * (at + edges[1:]) / sampling_Hz,
                {"units": "s", "long_name": "time in the raw record"},
            ),
            "overview_min": (
                "bin", low,
                {"units": "m/s", "long_name": "smallest velocity in the bin"},
            ),
            "overview_max": (
                "bin", high,
                {"units": "m/s", "long_name": "largest velocity in the bin"},
            ),
        },
        coords={
            "time": (
                "time", np.arange(piece.size) / sampling_Hz,
                {"units": "s", "long_name": "time since the start of the cut"},
            )
        },
        attrs=attrs,
    )  # fmt: skip
