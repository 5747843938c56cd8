"""FREEVIB: amplitude-dependent frequency and damping of a free decay (3.1 to 3.13, App. F)."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float
from numpy import ndarray

from bladeroot.decay.curve_errors import acting, factors, widened
from bladeroot.decay.track import LEAST_NOISE_RATIO, Taken, follow
from bladeroot.signal.lines import LOUD_CYCLES, magnitudes, mode_Hz
from bladeroot.signal.phasors import natural
from bladeroot.variables import dataset, names

POINTS = 500  # of the curves at most

# The fall of ln A in all that a decay needs.
STEADY = 0.02  # of less, it is a steady tone
STEADY_ERRORS = 3.0  # standard errors of ln A: of less, nothing says that it falls

# Which points are given.
FREQUENCY_KNOWN = 0.005  # standard error over frequency: beyond, noise or another mode is followed
FEWEST = 4  # points
LOSS_KNOWN = 0.09  # standard error by noise over loss factor, at which a curve begins and ends
FREQUENCY_SURE = 5e-4 / 3.0  # stated error over frequency, at which `surely_known` ends it
KNOWN_PART = 0.5  # neither ends a curve of which no more than this part is better known


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
    count = blocks.time.size
    at = np.linspace(0, count - 1, min(POINTS, count))
    centre = np.interp(at, np.arange(count), blocks.time)
    value, noisy = fit.value(centre), fit.std(centre)
    omega_n, loss = natural(value[1], value[2], damping)
    omega, amplitude = value[1, 1], np.exp(value[0, 0])
    known = _errors(noisy, omega)[1] < LOSS_KNOWN * loss
    std = widened(value, noisy, np.interp(centre, blocks.time, acting(blocks)), at)
    frequency_std, loss_std = _errors(std, omega)
    start, larger = factors(loss_std / np.abs(loss), at)
    errors = (start * amplitude * std[0, 0], larger * frequency_std, larger * loss_std)
    curves = (centre, amplitude, omega_n / (2.0 * np.pi), loss)
    keep = frequency_std < FREQUENCY_KNOWN * omega_n / (2.0 * np.pi)  # not a number fails, too
    if np.count_nonzero(keep) < FEWEST:
        raise ValueError(
            f"the mode's frequency is known to {100.0 * FREQUENCY_KNOWN:g} % in "
            f"{np.count_nonzero(keep)} of {keep.size} cycles or groups of them, at least {FEWEST} "
            "are needed"
        )
    known &= keep
    if np.count_nonzero(known) > max(KNOWN_PART * np.count_nonzero(keep), FEWEST):
        first, stop = mostly(known)
        keep[:first] = keep[stop:] = False
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


def _errors(
    std: Float[ndarray, "order part point"], omega: Float[ndarray, " point"]
) -> tuple[Float[ndarray, " point"], Float[ndarray, " point"]]:
    """Standard errors of frequency (Hz) and loss factor, from those of the derivatives."""
    frequency = np.hypot(std[1, 1], 0.5 * std[2, 0] / omega) / (2.0 * np.pi)
    return frequency, np.hypot(2.0 * std[1, 0] / omega, std[2, 1] / omega**2)


def mostly(true: Bool[ndarray, " point"]) -> tuple[int, int]:
    """First and one past the last of the points among which most more are true than are not."""
    surplus = np.concatenate([[0], np.cumsum(np.where(true, 1, -1))])
    stop = int(np.argmax(surplus[1:] - np.minimum.accumulate(surplus[:-1]))) + 1
    before = surplus[:stop]
    return stop - 1 - int(np.argmin(before[::-1])), stop


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
