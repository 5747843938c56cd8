"""FREEVIB: amplitude-dependent frequency and damping of a free decay (3.1 to 3.13, App. F)."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool, Complex, Float
from numpy import ndarray
from numpy.lib.stride_tricks import sliding_window_view
from scipy.signal import find_peaks

from bladeroot.decay.track import LEAST_NOISE_RATIO, Taken, follow
from bladeroot.signal.lines import LOUD_CYCLES, magnitudes, mode_Hz
from bladeroot.signal.phasors import Phasors, natural
from bladeroot.signal.runs import runs
from bladeroot.variables import dataset, names

POINTS = 500  # of the curves at most

# The first blocks, in which a blow or a drive may still act (`acting`). They are compared with a
# parabola in time through twice as many later blocks.
STARTS = (12, 6, 3)  # numbers of first blocks that are tried, in turn
UNLIKE = 1.5  # mean square of what the first half of them miss, over its variance, that tells
LIKE = 0.8  # the same of as many blocks that follow: of more, the mode's own law is no parabola
BENDS = 0.25  # part of the parabola's difference from a straight line that is in the variance
PLAIN = 2.0  # fall of ln A in all those blocks, beyond which no law is a parabola in time

# A drive that ends (`driven`). As a mode decays its damping rises no faster than A to this power;
# that of Coulomb friction rises with the first.
STEEPEST = 2.0
DRIVEN_FALL = 0.3  # of ln A from the start, in which it is looked for
DRIVEN_ERRORS = 3.0  # standard errors by which the damping is too small

# A free mode gains nothing (`gains`).
GAIN_ERRORS = 3.0  # standard errors by which it does where another one is followed, or acts on it
GAIN_REACH = 2  # times their number, points on either side that are as wrong

# The fall of ln A in all that a decay needs.
STEADY = 0.02  # of less, it is a steady tone
STEADY_ERRORS = 3.0  # standard errors of ln A: of less, nothing says that it falls

# Which points are given.
FREQUENCY_KNOWN = 0.005  # standard error over frequency: beyond, noise or another mode is followed
FEWEST = 4  # points
LOSS_KNOWN = 0.09  # standard error over loss factor, by noise, at which the curves begin and end,
FREQUENCY_SURE = 5e-4 / 3.0  # and stated error over frequency at which they end in a result,
KNOWN_PART = 0.5  # where so large a part of the points is better known

# What waves all along a decay is no law of amplitude, which bends a few times (`waves`).
SEGMENT = 1.0  # fall of ln A in a segment through which a parabola in ln A is laid
FEWEST_SEGMENTS = 4
FEWEST_WAVING = 3  # segments that miss their parabola by more than noise lets them
POINTS_EACH = 8  # fewest, in a segment

# What beats in a part of a decay alone is none either (`beats`).
TURNS = 5  # turning points of a rate
TURNS_WITHIN = 2.0  # fall of ln A between the first and the last of them
TURNS_CLEAR = 3.0  # standard errors by which each stands out of its neighbours

# What else rings, and how laws bend, is largest at the start, where a curve has one side only. The
# standard error of the first point is larger by this part, which falls by e in so many blocks:
# three errors of the first six points then hold as often as those of the others
# (benchmarks/real_like.py, seeds 62200 to 62379).
START = 1.25
START_BLOCKS = 3.0
# The worse the loss factor is known, the less sure is how well: errors of both rates are larger by
# so many times its relative error, up to that, if not at the start by more. Three errors then hold
# as often where it is known to 5 to 20 % as where it is known better (seeds 62200 to 63699).
WEAK, WEAKEST = 4.0, 0.2


def freevib(
    velocity: Float[ndarray, " sample"],
    sampling_Hz: float,
    expected_Hz: float,
    noise: float,
    tolerance: float = 0.3,
    usable: Bool[ndarray, " sample"] | None = None,
    damping: str = "hysteretic",
    taken: Taken | None = None,
    filtered: bool = False,
) -> xr.Dataset:
    """Frequency and loss factor as functions of displacement amplitude from a free decay.

    The analytic displacement Y = A exp(i phi) obeys Y'' + omega_n^2 (1 + i eta) Y = 0 (3.7), or
    Y'' + 2 zeta omega_n Y' + omega_n^2 Y = 0 with viscous damping, which `signal.phasors.natural`
    solves for omega_n and the loss factor (3.11). The velocity's own log-derivative lambda_V is
    measured; the displacement's is lambda = A'/A + i omega = lambda_V - lambda_V' / lambda_V, and
    Y = V / lambda, which replaces the integration and the Hilbert filters of the thesis. What else
    rings is taken off before (`decay.components`).

    Args:
        velocity: free decay in m/s, the release or blow left out.
        sampling_Hz: sampling frequency.
        expected_Hz: where the mode is looked for (`signal.lines.mode_Hz`).
        noise: rms of the sensor's noise in m/s; corrected by what the blocks themselves show.
        tolerance: relative distance from there at which it is another mode.
        usable: False where a sample has no weight (a gap is bridged, with larger errors).
        damping: "hysteretic" or "viscous".
        taken: for what was taken off before: times (s), factors by which a cycle's standard
            error is larger there than noise makes it, and an error to add.
        filtered: whether the noise has passed a filter that `noise` does not know of: neighbouring
            cycles then share it, and their scatter shows less than there is.

    Returns:
        Dataset with dim `point` (the curves, in time order, with standard errors) and dim `block`
        (independent log-phasors of the displacement, from which the plateau is fitted).

    Raises:
        ValueError: the mode's line lies outside the band, fewer than five cycles of it, unknown
            damping.
    """
    if damping not in ("hysteretic", "viscous"):
        raise ValueError(f"damping must be hysteretic or viscous, got {damping!r}")
    band = search_band(sampling_Hz, expected_Hz, tolerance)
    if usable is not None:
        usable = None if usable.all() else usable
        velocity = velocity if usable is None else np.where(usable, velocity, 0.0)
    # no digitiser is better than this, and errors without a floor mean nothing
    noise = max(float(noise), 5e-6 * float(np.abs(velocity).max()))
    first = velocity[: int(LOUD_CYCLES * sampling_Hz / expected_Hz)]
    line_Hz = mode_Hz(*magnitudes(first, sampling_Hz), expected_Hz)
    least_ratio = 1.0 if filtered else LEAST_NOISE_RATIO
    blocks, fit = follow(velocity, sampling_Hz, line_Hz, noise, usable, taken, least_ratio)
    own = np.arange(blocks.time.size)
    count = min(POINTS, own.size)
    centre = np.interp(np.linspace(0, own.size - 1, count), own, blocks.time)
    value, std = fit.value(centre), fit.std(centre)
    omega_n, loss = natural(value[1], value[2], damping)
    omega, amplitude = value[1, 1], np.exp(value[0, 0])
    known = np.hypot(2.0 * std[1, 0] / omega, std[2, 1] / omega**2) < LOSS_KNOWN * loss
    for order in (1, 2):
        rates, error = value[order], std[order]
        sways = [waves(value[0, 0], *one) for one in zip(rates, error, strict=True)]
        std[order] = np.hypot(error, np.maximum(sways, beats(value[0, 0], rates, error)))
    unsure = np.interp(centre, blocks.time, acting(blocks))
    unsure = np.hypot(unsure, gains(value[1, 0], std[1, 0]))
    std[1] = np.hypot(std[1], np.hypot(unsure, driven(value[0, 0], -value[1, 0], std[1, 0])))
    since = np.linspace(0, own.size - 1, count) / START_BLOCKS
    worse = np.log(np.maximum(std[1:], 1e-300)) + since
    std[1:] = np.exp(np.maximum.accumulate(worse, axis=-1) - since)
    amplitude_std = amplitude * std[0, 0]
    frequency_std = np.hypot(std[1, 1], 0.5 * std[2, 0] / omega) / (2.0 * np.pi)
    loss_std = np.hypot(2.0 * std[1, 0] / omega, std[2, 1] / omega**2)
    curves = (centre, amplitude, omega_n / (2.0 * np.pi), loss)
    start = 1.0 + START * np.exp(-since)
    larger = np.maximum(start, 1.0 + WEAK * np.minimum(loss_std / np.abs(loss), WEAKEST))
    errors = (start * amplitude_std, larger * frequency_std, larger * loss_std)
    keep = frequency_std < FREQUENCY_KNOWN * omega_n / (2.0 * np.pi)  # and a number
    if np.count_nonzero(keep) < FEWEST:
        raise ValueError(
            f"the mode's frequency is known to {100.0 * FREQUENCY_KNOWN:g} % in "
            f"{np.count_nonzero(keep)} of {keep.size} cycles or groups of them, at least {FEWEST} "
            "are needed"
        )
    known = np.flatnonzero(keep & known)
    if known.size > max(KNOWN_PART * np.count_nonzero(keep), FEWEST):
        keep[: known[0]] = keep[known[-1] + 1 :] = False
    middle_Hz = float(np.median(omega_n[keep])) / (2.0 * np.pi)
    fall = float(np.ptp(value[0, 0][keep]))
    if fall < STEADY:
        raise ValueError(f"what rings at {middle_Hz:.6g} Hz does not decay: a steady tone")
    unsure = STEADY_ERRORS * float(np.median(std[0, 0][keep]))
    if fall < unsure:
        raise ValueError(
            f"what rings at {middle_Hz:.6g} Hz falls by a factor of {np.exp(fall):.3g} where its "
            f"frequency is known, and its amplitude is known to one of {np.exp(unsure):.3g} only: "
            "no decay is seen"
        )
    if not band[0] <= middle_Hz <= band[1]:
        raise ValueError(
            f"the mode that was followed lies at {middle_Hz:.6g} Hz, outside {band[0]:.6g} to "
            f"{band[1]:.6g} Hz: another one dominates the record"
        )
    result = decay_dataset(
        [values[keep] for values in (*curves, *errors)],
        [blocks.time, blocks.log.real, blocks.log.imag, blocks.std],
    )
    result.attrs["band_low_Hz"], result.attrs["band_high_Hz"] = band
    result.attrs["damping"] = damping
    if damping == "viscous":
        result["loss_factor"].attrs |= {"long_name": "loss factor: twice the damping ratio"}
    return result


def surely_known(curves: xr.Dataset) -> xr.Dataset:
    """Curves up to where three stated errors of the frequency pass 500 ppm.

    All of them where most are known no better. What is known worse is still of use to a plateau,
    which many points tell: it is read before.
    """
    error = (curves["frequency_std"] / curves["frequency"]).values
    known = np.flatnonzero(error < FREQUENCY_SURE)
    if known.size <= max(KNOWN_PART * error.size, FEWEST):
        return curves
    return curves.isel(point=slice(int(known[-1]) + 1))


def waves(
    level: Float[ndarray, " point"], rate: Float[ndarray, " point"], std: Float[ndarray, " point"]
) -> Float[ndarray, " point"]:
    """Standard error of a derivative of ln A or phase for what sways: a gain, another mode's rest.

    A law of amplitude bends a few times over a decay. What waves about a parabola in ln A in many
    of its segments, by more than noise lets it, is no law; a kink does so in one or two of them.
    The error holds in a segment and in its neighbours.

    level: ln A; rate: the derivative; std: its standard error.
    """
    segments = int((level.max() - level.min()) / SEGMENT)
    if segments < FEWEST_SEGMENTS or level.size < POINTS_EACH * segments:
        return np.zeros(level.size)
    left, noise = np.empty((2, segments))
    parts = np.array_split(np.arange(level.size), segments)
    for k, part in enumerate(parts):
        powers = np.vander(np.linspace(-1.0, 1.0, part.size), 3)
        off = rate[part] - powers @ np.linalg.lstsq(powers, rate[part], rcond=None)[0]
        left[k], noise[k] = np.mean(off**2), np.mean(std[part] ** 2)
    if np.count_nonzero(left > 2.0 * noise) < FEWEST_WAVING:
        return np.zeros(level.size)
    near = np.max(sliding_window_view(np.pad(left, 1), 3), axis=1)
    return np.repeat(np.sqrt(near), [part.size for part in parts])


def beats(
    level: Float[ndarray, " point"],
    rates: Float[ndarray, "part point"],
    std: Float[ndarray, "part point"],
) -> Float[ndarray, "part point"]:
    """Standard errors of derivatives of ln A and phase for what beats in a part of a decay alone.

    A law of amplitude turns a few times over a decay. Where a rate turns as often while ln A falls
    by little, and by more than noise lets it, its error is half of what it swings by, a wave before
    and half a wave after included: another mode that dies sooner. It sways ln A as it does phase,
    so that the error of ln A's derivative is as large, if that moves by so much.

    level: ln A; rates: a derivative of ln A and that of the phase; std: their standard errors.
    """
    error = np.zeros(rates.shape)
    for part, (rate, noise) in enumerate(zip(rates, std, strict=True)):
        sides = [find_peaks(side, prominence=TURNS_CLEAR * noise)[0] for side in (rate, -rate)]
        turns = np.sort(np.concatenate(sides))
        fall = level[turns[: 1 - TURNS]] - level[turns[TURNS - 1 :]]
        for first in np.flatnonzero(fall < TURNS_WITHIN):
            some = turns[first : first + TURNS]
            begin, end = 3 * some[0] - 2 * some[1], 2 * some[-1] - some[-2]
            here = np.arange(max(begin, 0), min(end + 1, rate.size))
            swing = 0.5 * np.abs(np.diff(rate[some]))
            swing = np.interp(here, 0.5 * (some[1:] + some[:-1]), swing)
            for other in range(part + 1):
                most = 0.5 * np.ptp(rates[other, here])
                error[other, here] = np.maximum(error[other, here], np.minimum(swing, most))
    return error


def acting(blocks: Phasors) -> Float[ndarray, " block"]:
    """Standard error of either rate (1/s) in blocks in which something may still act: the first.

    What they miss of those that follow grows by so much, if these are alike: what misses its errors
    further on, too, is the mode's own law, or sways all along.
    """
    error = np.zeros(blocks.time.size)
    for count in STARTS:
        miss, unlike = _missed(blocks, 0, count)
        if unlike > UNLIKE and _missed(blocks, count, count)[1] < LIKE:
            error[:count] = np.abs(np.gradient(miss, blocks.time[:count]))
            break
    return error


def _missed(blocks: Phasors, first: int, count: int) -> tuple[Complex[ndarray, " early"], float]:
    """What so many blocks miss of a parabola through twice as many later ones.

    And the mean square, in errors, of the first half of them; NaN where nothing can be said.
    """
    early, later = slice(count), slice(count, 3 * count)
    near = slice(first, first + 3 * count)
    time, log, std = (one[near] for one in (blocks.time, blocks.log, blocks.std))
    if blocks.time.size < first + 4 * count or log[0].real - log[-1].real > PLAIN:
        return np.zeros(count, complex), np.nan
    x = (time - time[count]) / (time[-1] - time[count])
    misses = []
    for terms in (2, 3):
        powers = np.vander(x, terms, increasing=True)
        inverse = np.linalg.pinv(powers[later] / std[later, None])
        misses.append(log - powers @ (inverse @ (log[later] / std[later])))
    straight, bent = misses
    variance = std[early] ** 2 + np.sum((powers[early] @ inverse) ** 2, axis=1)
    variance += (BENDS * np.abs(bent - straight)[early]) ** 2
    missed = 0.5 * np.abs(bent[early]) ** 2 / variance
    return bent[early], float(np.mean(missed[: (count + 1) // 2]))


def gains(
    growth: Float[ndarray, " point"], std: Float[ndarray, " point"]
) -> Float[ndarray, " point"]:
    """Standard error of either rate (1/s) where a mode gains, as no free one does.

    growth: the rate at which ln A rises (1/s); std: its standard error.
    """
    error = np.zeros(growth.size)
    for first, stop in runs(growth > GAIN_ERRORS * std):
        reach = GAIN_REACH * (stop - first)
        near = slice(max(first - reach, 0), stop + reach)
        error[near] = np.maximum(error[near], growth[first:stop].max())
    return error


def driven(
    level: Float[ndarray, " point"], decay: Float[ndarray, " point"], std: Float[ndarray, " point"]
) -> Float[ndarray, " point"]:
    """Standard error of either rate (1/s) at the start, where a drive may still hold the mode up.

    There the mode decays more slowly than any law lets it, by what it does soon after. A drive that
    acts at one time has acted before.

    level: ln A; decay: the rate at which it falls (1/s); std: its standard error.
    """
    count = int(np.argmax(np.append(level < level[0] - DRIVEN_FALL, True)))
    fall, own, error = level[0] - level[:count], decay[:count], std[:count]
    least = own * np.exp(-STEEPEST * (fall - fall[:, None]))
    miss = np.triu(least - own[:, None], 1)
    clear = miss > DRIVEN_ERRORS * np.hypot(error, error[:, None])
    acts = np.where(clear, miss, 0.0).max(axis=1, initial=0.0)
    found = np.zeros(level.size)
    found[:count] = np.maximum.accumulate(acts[::-1])[::-1]
    return found


def no_decay() -> xr.Dataset:
    """The empty result of a rejected record: the variables of `freevib`, no points."""
    return decay_dataset([np.empty(0)] * 7, [np.empty(0)] * 4)


def search_band(
    sampling_Hz: float, expected_Hz: float, tolerance: float = 0.3
) -> tuple[float, float]:
    """The band in Hz in which the mode lies."""
    if not 0.0 < expected_Hz < 0.48 * sampling_Hz:
        raise ValueError(
            f"expected_Hz must lie between 0 and {0.48 * sampling_Hz:.6g} Hz (sampling at "
            f"{sampling_Hz:.6g} Hz), got {expected_Hz:.6g}"
        )
    low, high = expected_Hz * (1.0 - tolerance), expected_Hz * (1.0 + tolerance)
    return low, min(high, 0.49 * sampling_Hz)


def decay_dataset(points: Sequence[ndarray], blocks: Sequence[ndarray]) -> xr.Dataset:
    """Curves and blocks as a Dataset, from columns in the order of their tables."""
    tables = (("decay/point", points), ("decay/block", blocks))
    return xr.merge(
        dataset(table, dict(zip(names(table), columns, strict=True))) for table, columns in tables
    )
