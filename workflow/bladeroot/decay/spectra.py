"""The spectrum of a free decay, of the mode that was followed in it, and of what is left over."""

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float
from numpy import ndarray
from scipy import fft
from scipy.interpolate import CubicSpline

from bladeroot.signal.runs import runs

PARTS = {
    "whole": "the free decay as it was cut",
    "mode": "the mode that was followed",
    "rest": "what the mode leaves over",
}

FADE_CYCLES = 10  # of the mode over which each end of the segment is faded
SPECTRUM_LINES = 1500  # of a long transform are kept at least, and fewer than twice as many


def before_and_after(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    decay: xr.Dataset,
    usable: Bool[ndarray, " sample"] | None = None,
) -> xr.Dataset:
    """Amplitude spectra before and after the mode was separated.

    The mode's velocity is Re[Y'] of the displacement's log-phasors Y in `decay` (dim block, from
    `bladeroot.decay.freevib.freevib`), interpolated between the blocks.

    Returns:
        dim line: frequency (Hz) and the spectra `whole`, `mode` and `rest` in m/s, each the largest
        of the transform's lines (2/N sum v e^-iwt) within a step of `frequency`. All three are of
        the longest segment that is usable and where the mode is known (attributes `from_s` and
        `to_s` since the start of the cut), or of the whole decay where no mode was followed:
        `mode` and `rest` are NaN then. The first and last cycles are faded: a decay that starts at
        once would hide everything under its own skirts.
    """
    mode = followed_mode(velocity.size, sampling_Hz, decay)
    known = np.isfinite(mode) if usable is None else np.isfinite(mode) & usable
    known = runs(known) if known.any() else np.array([[0, velocity.size]])
    segment = slice(*known[np.argmax(np.diff(known))])
    velocity, mode = velocity[segment], mode[segment]
    raw = fft.rfftfreq(velocity.size, 1.0 / sampling_Hz)
    step = max(1, raw.size // SPECTRUM_LINES)
    starts = np.arange(0, raw.size - step + 1, step)
    fade = np.ones(velocity.size)
    rise = min(int(FADE_CYCLES * sampling_Hz / decay.attrs["expected_Hz"]), velocity.size // 4)
    fade[:rise] = np.sin(0.5 * np.pi * np.arange(rise) / rise) ** 2
    fade[velocity.size - rise :] = fade[:rise][::-1]
    spectra = {}
    for name, signal in (("whole", velocity), ("mode", mode), ("rest", velocity - mode)):
        level = 2.0 / velocity.size * np.abs(fft.rfft(fade * (signal - signal.mean())))
        attrs = {"units": "m/s", "long_name": f"amplitude spectrum of {PARTS[name]}"}
        spectra[name] = ("line", np.maximum.reduceat(level, starts), attrs)
    centre = raw[starts] + 0.5 * (step - 1) * raw[1]
    spectra["frequency"] = ("line", centre, {"units": "Hz", "long_name": "frequency"})
    span = {"from_s": segment.start / sampling_Hz, "to_s": segment.stop / sampling_Hz}
    return xr.Dataset(spectra, attrs=decay.attrs | span)


def followed_mode(samples: int, sampling_Hz: float, decay: xr.Dataset) -> Float[ndarray, " sample"]:
    """Velocity (m/s) of the followed mode at the record's samples, NaN beyond its blocks."""
    wave = np.full(samples, np.nan)
    time = decay["block_time"].values
    if time.size < 4:
        return wave
    log = CubicSpline(time, decay["block_log_amplitude"].values + 1j * decay["block_phase"].values)
    # a block's time is its middle: the mode is known half a block further at either end
    begin, end = 1.5 * time[0] - 0.5 * time[1], 1.5 * time[-1] - 0.5 * time[-2]
    first = max(int(np.ceil(begin * sampling_Hz)), 0)
    at = np.arange(first, min(int(end * sampling_Hz) + 1, samples)) / sampling_Hz
    wave[first : first + at.size] = (log(at, 1) * np.exp(log(at))).real
    return wave
