"""FREEVIB with the filters of the thesis (3.2.1), for comparison with the default estimator.

Trapezoid integration with the constant component taken off, then differentiation and Hilbert
transforms by Parks-McClellan filters without phase (an odd number of symmetric or antisymmetric
taps, centred), then (3.12), (3.13) and (3.11) sample by sample. The thesis prints no filter's
edges; here they are in Hz and from the record. Added to it, because nothing works without:
- a Parks-McClellan band-pass around the mode, the same for velocity and displacement, which also
  takes off the drift that integration leaves;
- fewer samples a cycle (at least 12), so that the filters are short and well conditioned;
- the trapezoid rule's known gain 1 - (omega dt)^2 / 12 made good: left in, the frequency comes out
  too high by (omega dt)^2 / 24, 160 ppm at 100 samples a cycle and 930 ppm at 42;
- means over whole cycles, and standard errors (Appendix F made right).
The ends, half as long as all filters together, are lost.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool, Complex, Float
from numpy import ndarray

from bladeroot.decay.freevib import decay_dataset, freevib
from bladeroot.quality.peak_fit import BRIDGED_GAP, bridged
from bladeroot.reproduction.error_bounds import two_points
from bladeroot.signal.lines import hann
from bladeroot.signal.phasors import natural

RIPPLE_DB = 80.0
TRAPEZOID = (1 / 12, 11 / 720, 191 / 60480)  # corrections in even differences
SAMPLES = 12  # a cycle, at least, after the samples have been thinned


@dataclass(frozen=True)
class Filters:
    """Band-pass, Hilbert and differentiating taps for samples at `rate_Hz`."""

    rate_Hz: float
    band: Float[ndarray, " band_tap"]
    hilbert: Float[ndarray, " hilbert_tap"]
    derivative: Float[ndarray, " derivative_tap"]

    @property
    def half(self) -> int:
        """Samples that are lost at either end."""
        return (self.band.size + self.hilbert.size + self.derivative.size) // 2

    @property
    def bandwidth_Hz(self) -> float:
        """Width of the ideal band that passes as much white noise."""
        return float(0.5 * self.rate_Hz * (self.band @ self.band))


def estimation(settings: Mapping) -> dict:
    """Section `decay` of the configuration, with an estimator for its name."""
    named = {"blocks": freevib, "thesis": thesis_freevib}
    return {**settings, "estimator": named[settings["estimator"]]}


def thesis_freevib(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    noise: float,
    tolerance: float = 0.3,
    points: int = 500,
    usable: Bool[ndarray, " sample"] | None = None,
    damping: str = "hysteretic",
    pass_Hz: float | None = None,
    stop_Hz: float | None = None,
) -> xr.Dataset:
    """Frequency and loss factor against amplitude; arguments and result as of `freevib`.

    The blocks, from which the plateau is fitted, are the analytic displacement at times one over
    the band's width apart, where its noise is uncorrelated; their standard error is that of the
    sensor's noise in the band, or what neighbouring blocks show if that is more.

    Args:
        pass_Hz, stop_Hz: half-widths of the band-pass around the mode; by default the stop band
            begins half-way to the next strong line, at most at 0.45 of the frequency, and the
            pass band is a third of that wide.

    Raises:
        ValueError: fewer than 4 samples a cycle, an unknown law of damping, or a decay shorter than
            the filters.
    """
    if damping not in ("hysteretic", "viscous"):
        raise ValueError(f"damping must be hysteretic or viscous, got {damping!r}")
    if not 0.0 < 4.0 * expected_Hz < sampling_Hz:
        raise ValueError(
            "expected_Hz must lie between 0 and a quarter of the sampling frequency, "
            f"{sampling_Hz / 4.0:.6g} Hz, for the filters of the thesis, got {expected_Hz:.6g}"
        )
    low_Hz, high_Hz = expected_Hz * (1.0 - tolerance), expected_Hz * (1.0 + tolerance)
    centre_Hz, next_Hz = _lines(velocity, sampling_Hz, low_Hz, high_Hz)
    gap_Hz = centre_Hz if next_Hz is None else abs(next_Hz - centre_Hz)
    stop_Hz = stop_Hz or min(0.45 * centre_Hz, 0.5 * gap_Hz)
    pass_Hz = pass_Hz or stop_Hz / 3.0
    good = np.ones(velocity.size, dtype=bool)
    if usable is not None and not usable.all():
        velocity, good = bridged(velocity, usable, BRIDGED_GAP * sampling_Hz / centre_Hz)
    thin = max(1, int(sampling_Hz / (SAMPLES * centre_Hz)))
    filters = design(sampling_Hz / thin, centre_Hz, pass_Hz, stop_Hz)
    y = _integrated(velocity, sampling_Hz, centre_Hz)
    v, y = (_thinned(x, thin, sampling_Hz, centre_Hz) for x in (velocity, y))
    good = good[: v.size * thin].reshape(-1, thin).all(axis=1)
    if v.size < 2 * filters.half + 8 * SAMPLES:
        raise ValueError(
            "expected a decay longer than the filters of the thesis, "
            f"{2 * filters.half / filters.rate_Hz:.4g} s, got {velocity.size / sampling_Hz:.4g} s"
        )
    rate, change, log = _instantaneous(v, y, filters)
    # four more on either side for what thinning smears
    good = _centred(~good, np.ones(2 * filters.half + 9)) < 0.5
    inside = slice(filters.half, v.size - filters.half)
    time = (np.arange(v.size) * thin / sampling_Hz)[inside]
    rate, change, log, good = rate[inside], change[inside], log[inside], good[inside]
    # a digitiser is never better than this part of its range
    noise = max(float(noise), 5e-6 * float(np.abs(velocity).max()))
    ratio = noise * np.sqrt(2.0 * filters.bandwidth_Hz / sampling_Hz) / np.abs(np.exp(log) * rate)
    drowned = np.flatnonzero(np.convolve(ratio, np.ones(SAMPLES) / SAMPLES, mode="valid") > 0.2)
    alive = slice(0, int(drowned[0]) if drowned.size else time.size)
    time, rate, change, log = time[alive], rate[alive], change[alive], log[alive]
    ratio, good = ratio[alive], good[alive]
    blocks, excess = _blocks(time, log, ratio, good, filters)
    curve = _means(time, rate, change, log, ratio * excess, good, points, centre_Hz, damping)
    result = decay_dataset(curve, blocks)
    result.attrs["band_low_Hz"] = float(centre_Hz - stop_Hz)
    result.attrs["band_high_Hz"] = float(centre_Hz + stop_Hz)
    result.attrs["damping"] = damping
    result.attrs["other_modes_Hz"] = [] if next_Hz is None else [next_Hz]
    return result


def design(rate_Hz: float, centre_Hz: float, pass_Hz: float, stop_Hz: float) -> Filters:
    """Parks-McClellan filters around a frequency; half-widths of pass and stop band in Hz."""
    low, high, top = centre_Hz - stop_Hz, centre_Hz + stop_Hz, 0.5 * rate_Hz
    edges = [0.0, low, centre_Hz - pass_Hz, centre_Hz + pass_Hz, min(high, 0.98 * top), top]
    band = _taps(rate_Hz, stop_Hz - pass_Hz, edges, [0.0, 1.0, 0.0])
    # where the band-pass leaves nothing, these may do as they like
    edge = min(low, top - high)
    hilbert = _taps(rate_Hz, edge, [edge, top - edge], [1.0], "hilbert")
    steep = _taps(rate_Hz, edge, [0.0, top - edge], [1.0], "differentiator")
    return Filters(
        rate_Hz,
        band,
        _scaled(hilbert, rate_Hz, centre_Hz, -1.0),
        _scaled(steep, rate_Hz, centre_Hz, 2.0 * np.pi * centre_Hz),
    )


def _taps(
    rate_Hz: float,
    transition_Hz: float,
    edges_Hz: list[float],
    desired: list[float],
    kind: str = "bandpass",
) -> Float[ndarray, " tap"]:
    """An odd number of Parks-McClellan taps, about as many as the transition asks for."""
    from scipy.signal import remez

    # Kaiser's estimate of the length
    count = 2 * int(0.5 * (RIPPLE_DB - 13.0) / 14.6 * rate_Hz / transition_Hz + 1.0) + 1
    for longer in range(0, 40, 2):  # the exchange fails now and then: not with another length
        try:
            taps = remez(count + longer, edges_Hz, desired, type=kind, fs=rate_Hz)
        except ValueError:
            continue
        if np.isfinite(taps).all():
            return taps
    raise ValueError(f"no {kind} filter of about {count} taps found for edges {edges_Hz} Hz")


def _scaled(taps: ndarray, rate_Hz: float, centre_Hz: float, gain: float) -> ndarray:
    """Antisymmetric taps with gain i `gain` at the centre: conventions of sign and scale differ."""
    place = np.arange(taps.size) - taps.size // 2
    here = -np.sin(2.0 * np.pi * centre_Hz / rate_Hz * place) @ taps
    return taps * (gain / here)


def _lines(
    velocity: ndarray, sampling_Hz: float, low_Hz: float, high_Hz: float
) -> tuple[float, float | None]:
    """Frequency of the strongest line in a band, and of another one apart from it, if any."""
    from scipy import fft

    count = fft.next_fast_len(velocity.size, real=True)
    level = np.abs(fft.rfft(velocity * hann(2 * velocity.size)[velocity.size :], count))
    frequency = np.arange(level.size) * sampling_Hz / count
    inside = (frequency >= low_Hz) & (frequency <= high_Hz)
    centre = float(frequency[np.argmax(np.where(inside, level, 0.0))])
    apart = (np.abs(frequency / centre - 1.0) > 0.2) & (frequency > 0.2 * centre)
    other = float(frequency[np.argmax(np.where(apart, level, 0.0))])
    around = level[np.abs(frequency / other - 1.0) < 0.1]
    # a skirt of the mode itself is no line
    if around.size < 8 or around.max() < max(5.0 * np.median(around), 0.005 * level.max()):
        return centre, None
    return centre, other


def _integrated(
    velocity: ndarray, sampling_Hz: float, centre_Hz: float
) -> Float[ndarray, " sample"]:
    """Trapezoid rule with its known error made good, the constant component taken off."""
    steps = 0.5 * (velocity[1:] + velocity[:-1]) / sampling_Hz
    y = np.concatenate([[0.0], np.cumsum(steps)])
    # the rule's gain is x / tan x, x = omega dt / 2; its inverse in s = 4 sin^2 x, which is minus
    # a second difference: 1 + s / 12 + 11 s^2 / 720 + ..., and what is left at the mode itself
    half = np.pi * centre_Hz / sampling_Hz
    made_good, term, gain = y.copy(), y, 1.0
    for k, weight in enumerate(TRAPEZOID, start=1):
        term = np.pad(2.0 * term[1:-1] - term[2:] - term[:-2], 1)
        made_good += weight * term
        gain += weight * (4.0 * np.sin(half) ** 2) ** k
    made_good *= np.tan(half) / half / gain
    return made_good - made_good.mean()


def _thinned(x: ndarray, thin: int, sampling_Hz: float, centre_Hz: float) -> ndarray:
    """Every `thin`-th sample, after a Parks-McClellan low-pass."""
    if thin == 1:
        return x
    low, high = 1.5 * centre_Hz, sampling_Hz / thin - 1.5 * centre_Hz
    taps = _taps(sampling_Hz, high - low, [0.0, low, high, 0.5 * sampling_Hz], [1.0, 0.0])
    return _centred(x, taps)[: x.size // thin * thin : thin]


def _centred(x: ndarray, taps: Float[ndarray, " tap"]) -> Float[ndarray, " sample"]:
    """Convolution without delay (zero phase): the tap in the middle meets the sample itself."""
    from scipy.signal import oaconvolve

    return oaconvolve(x, taps, mode="full")[taps.size // 2 :][: x.size]


def _instantaneous(
    v: ndarray, y: ndarray, filters: Filters
) -> tuple[Complex[ndarray, " sample"], Complex[ndarray, " sample"], Complex[ndarray, " sample"]]:
    """lambda = A'/A + i omega (3.12), its derivative (from 3.13), and ln A + i phi (3.1)."""
    v, y = _centred(v, filters.band), _centred(y, filters.band)
    a = _centred(v, filters.derivative)
    y, v, a = (x + 1j * _centred(x, filters.hilbert) for x in (y, v, a))
    with np.errstate(all="ignore"):  # the ends, which are cut off
        rate = v / y
        log = np.log(np.abs(y)) + 1j * np.unwrap(np.angle(y))
        return rate, a / y - rate**2, log


def _blocks(
    time: ndarray, log: ndarray, ratio: ndarray, keep: ndarray, filters: Filters
) -> tuple[list[ndarray], float]:
    """Columns of table `block`, and by how much the blocks scatter more than the sensor's noise."""
    every = int(np.ceil(filters.rate_Hz / filters.bandwidth_Hz))
    at = np.arange(every // 2, time.size, every)
    at = at[keep[at]]
    std = np.hypot(ratio[at], 1e-6)
    # third differences of white noise have a variance of 20
    rough = np.abs(np.diff(log[at], 3)) / np.sqrt(20.0) / std[1:-2] if at.size > 12 else [1.0]
    excess = max(1.0, float(np.median(rough)) / np.sqrt(2.0 * np.log(2.0)))
    return [time[at], log[at].real, log[at].imag, excess * std], excess


def _means(
    time: ndarray,
    rate: ndarray,
    change: ndarray,
    log: ndarray,
    ratio: ndarray,
    keep: ndarray,
    points: int,
    centre_Hz: float,
    damping: str,
) -> list[Float[ndarray, " point"]]:
    """Columns of table `point`: means over two cycles at least, and their standard errors."""
    if time.size < 2:
        return [np.empty(0)] * 7
    step = time[1] - time[0]
    cycle = 1.0 / (centre_Hz * step)
    periods = max(2, int(np.ceil(keep.size / cycle / points)))
    edges = np.round(np.arange(0.0, keep.size, periods * cycle)).astype(int)
    if edges.size < 2:
        return [np.empty(0)] * 7
    at, count = edges[:-1], np.diff(edges)
    whole = np.add.reduceat(keep[: edges[-1]].astype(int), at) == count

    def mean(x: ndarray) -> ndarray:
        return (np.add.reduceat(x[: edges[-1]], at) / count)[whole]

    parts = (np.stack([x.real, x.imag]) for x in (rate, change))
    omega_n, loss = (mean(x) for x in natural(*parts, damping))
    amplitude, frequency = np.exp(mean(log.real)), omega_n / (2.0 * np.pi)
    ratio = ratio[at][whole]
    errors = two_points(frequency, loss, ratio, float(periods))
    columns = (
        mean(time), amplitude, frequency, loss,
        amplitude * ratio, errors.frequency, errors.loss_factor,
    )  # fmt: skip
    found = np.isfinite(frequency)
    return [column[found] for column in columns]
