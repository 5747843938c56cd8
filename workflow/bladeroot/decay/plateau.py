"""The stick plateau: where a decay's frequency and damping are constant, and how well.

On the plateau the log-phasor of the displacement is a straight line in time: its phase rises by
omega, its log-amplitude by A'/A. Above the onset amplitude A0 its rate leaves the constant as

    rate = rate0 + c e^p,   e = max(0, A / A0 - 1),

with p = 1, 3/2 or 2 and c of either sign: slip in a Coulomb contact softens with p = 3/2 and damps
with p = 1 (expand 3.19 near x0 = x_cr), and a rising frequency is as welcome as a falling one.
Beside the hinge stand two laws without a plateau, a rate that bends like A^2 (its limit at A = 0
is as good as a plateau) and one like A (it goes on bending: the plateau is not reached); all are
weighted by their likelihood, and the spread of their limits is part of the standard error.
The line and the hinge are fitted to the independent blocks of cycles themselves, where least
squares is efficient and its standard errors hold, not to the correlated points of the curves.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

POWERS = (1.0, 1.5, 2.0)
# Fewer than one record in a hundred without an onset shows one at this likelihood ratio when the
# blocks' errors are known; the margin above the 17 that would do is for errors known to 15 %.
DETECTION = 25.0


@dataclass(frozen=True)
class Hinge:
    """The constant rate of the plateau, and the amplitude where the rate leaves it.

    `bending` is the weight of the law that goes on bending to amplitude zero.
    """

    rate: float
    rate_std: float
    onset: float
    onset_std: float
    bending: float
    lowest: float
    highest: float

    @property
    def left(self) -> bool:
        """Whether the record leaves the constant at all."""
        return bool(np.isfinite(self.onset))

    @property
    def reached(self) -> bool:
        """Whether the constant shows: the odds are for a law that is flat towards A = 0."""
        return not self.left or self.bending < 0.5


def plateau(decay: xr.Dataset) -> dict[str, float | str]:
    """Stick frequency, loss factor and onset amplitude of one decay (dims as from `freevib`).

    Returns:
        stick_frequency, loss_factor and their standard errors; onset_amplitude with its standard
        error (NaN when the record never leaves the plateau) and onset_bound, the largest
        amplitude seen, in that case; plateau_reached (1 or 0); verdict; frequency_bound, the
        frequency at the smallest usable amplitude with frequency_bound_std, when the curve still
        bends there (stick_frequency is NaN then: nothing is extrapolated).

    The onset is the first amplitude where either frequency or damping leaves its constant; when
    both do and agree, their weighted mean.
    """
    result: dict[str, float | str] = {
        name: np.nan
        for name in (
            "stick_frequency", "stick_frequency_std", "loss_factor", "loss_factor_std",
            "onset_amplitude", "onset_amplitude_std", "onset_bound", "frequency_bound",
            "frequency_bound_std",
        )
    }  # fmt: skip
    result["plateau_reached"] = 0
    if decay.attrs.get("verdict", "usable") == "rejected" or decay.sizes["point"] < 12:
        reason = decay.attrs.get("findings", "") or "too few points above the noise"
        return result | {"verdict": f"rejected: {reason}"}
    time, amplitude = decay["time"].values, decay["amplitude"].values
    within = (decay["block_time"].values <= time[-1]) & (decay["block_std"].values < 0.15)
    block_time = decay["block_time"].values[within]
    std = decay["block_std"].values[within]
    block_amplitude = _amplitude(decay, within)
    phase = fit_hinge(block_time, decay["block_phase"].values[within], std, block_amplitude)
    decline = fit_hinge(
        block_time, decay["block_log_amplitude"].values[within], std, block_amplitude
    )
    onset, onset_std = _joint_onset(phase, decline)
    result |= {"onset_amplitude": onset, "onset_amplitude_std": onset_std}
    if not phase.left and not decline.left:
        result["onset_bound"] = float(amplitude.max())
    omega, alpha = phase.rate, decline.rate
    omega_n = float(np.sqrt(omega**2 - alpha**2))
    if decline.reached:
        result["loss_factor"] = -2.0 * omega * alpha / omega_n**2
        result["loss_factor_std"] = 2.0 * decline.rate_std / omega
    if not phase.reached:
        smallest = int(np.argmin(amplitude))
        return result | {
            "frequency_bound": float(decay["frequency"].values[smallest]),
            "frequency_bound_std": float(decay["frequency_std"].values[smallest]),
            "verdict": "plateau not reached",
        }
    return result | {
        "stick_frequency": omega_n / (2.0 * np.pi),
        "stick_frequency_std": phase.rate_std / (2.0 * np.pi),
        "plateau_reached": 1,
        "verdict": "plateau",
    }


def _amplitude(decay: xr.Dataset, within: ndarray) -> Float[ndarray, " block"]:
    """Displacement amplitude of the blocks: their own where it is sharp, else the curve's."""
    own = decay["block_log_amplitude"].values[within]
    smooth = np.interp(
        decay["block_time"].values[within], decay["time"].values, np.log(decay["amplitude"].values)
    )
    return np.exp(np.where(decay["block_std"].values[within] < 0.01, own, smooth))


def fit_hinge(
    time: Float[ndarray, " block"],
    y: Float[ndarray, " block"],
    std: Float[ndarray, " block"],
    amplitude: Float[ndarray, " block"],
    detection: float = DETECTION,
) -> Hinge:
    """Constant rate of y(t) at small amplitude, and the amplitude where the rate leaves it.

    Detection: from the smallest amplitude upwards, windows of growing amplitude are tested for a
    hinge anywhere in them; the first with a likelihood ratio (chi-square gain) beyond `detection`
    holds the onset. Estimation: the hinge is then fitted over as much of the record above the
    onset as it describes, averaged over the powers by their likelihood.
    """
    lowest, highest = float(amplitude.min()), float(amplitude.max())
    top = _first_departure(time, y, std, amplitude, detection)
    if top is None:
        line = _regress(np.stack([np.ones_like(time), time - time.mean()], axis=1), y, std)
        rate_std = float(np.sqrt(line[1][1, 1]))
        return Hinge(float(line[0][1]), rate_std, np.nan, np.nan, 0.0, lowest, highest)
    described = []
    for reach in (1.0, 1.2, 1.5, 2.0, 3.0, 5.0):
        fit = _averaged_hinge(time, y, std, amplitude, min(top * reach, highest))
        if fit is None:
            continue
        found, misfit = fit
        if misfit < 1.0 or not described:
            described.append(found)
        if misfit >= 1.0 or top * reach >= highest:
            break
    if not described:
        return Hinge(np.nan, np.nan, lowest, lowest, 1.0, lowest, highest)
    rate, rate_std, onset, onset_std, bending, shape = min(described, key=lambda fit: fit[3])
    # what drifts with the window is not known better than that, nor is an onset better than what
    # the assumed power makes of it: no law of slip is known well enough to choose one
    rate_std = float(np.hypot(rate_std, max(abs(other[0] - rate) for other in described)))
    drift = max(abs(other[2] - onset) for other in described)
    onset_std = float(np.sqrt(onset_std**2 + drift**2 + shape**2))
    return Hinge(rate, rate_std, onset, onset_std, bending, lowest, highest)


def _first_departure(
    time: ndarray, y: ndarray, std: ndarray, amplitude: ndarray, detection: float
) -> float | None:
    """Smallest top of an amplitude window in which a hinge shows, or None."""
    lowest, highest = amplitude.min(), amplitude.max()
    onsets = np.geomspace(lowest, highest, max(8, int(8 * np.log(highest / lowest)) + 1))
    hinges = _hinge_integrals(time, amplitude, onsets, 1.0)
    for top in onsets[3:]:
        keep = amplitude <= top * (1.0 + 1e-9)
        if keep.sum() < 24 or top < 1.5 * lowest:
            continue
        candidates = hinges[keep][:, onsets < top] / std[keep][:, None]
        line = np.stack([np.ones(keep.sum()), time[keep] - time[keep].mean()], axis=1)
        q, _ = np.linalg.qr(line / std[keep][:, None])
        scaled = (y[keep] - y[keep].mean()) / std[keep]
        rest = scaled - q @ (q.T @ scaled)
        candidates = candidates - q @ (q.T @ candidates)
        size = (candidates**2).sum(axis=0)
        size = np.where(size > 1e-12 * size.max(), size, np.inf)
        gain = (candidates.T @ rest) ** 2 / size
        if gain.max() > detection:
            return float(top)
    return None


def _averaged_hinge(
    time: ndarray, y: ndarray, std: ndarray, amplitude: ndarray, top: float
) -> tuple[tuple[float, ...], float] | None:
    """What a window of amplitude says, and its misfit (above 1: bad).

    First: rate, its std, onset, its std, weight of a rate straight in A, and half the range of
    the onset over the powers.
    """
    keep = amplitude <= top * (1.0 + 1e-9)
    if keep.sum() < 12:
        return None
    time, y, std, amplitude = time[keep], y[keep], std[keep], amplitude[keep]
    fits, left = [], []
    for power in POWERS:
        onset = _best_onset(time, y, std, amplitude, top, power)
        columns = _hinge_columns(time, amplitude, onset, power)
        value, _ = _regress(columns, y, std)
        step = 1e-4 * onset
        ahead = _hinge_columns(time, amplitude, onset + step, power) @ value
        behind = _hinge_columns(time, amplitude, onset - step, power) @ value
        # the onset's own error moves the rate, too
        _, covariance = _regress(np.column_stack([columns, (ahead - behind) / (2 * step)]), y, std)
        onset_std = min(np.sqrt(covariance[3, 3]), onset)
        left.append((y - columns @ value) / std)
        score = (left[-1] ** 2).sum() + 2.0
        fits.append((score, value[1], covariance[1, 1], onset, onset_std))
    for power in (2.0, 1.0):
        bend = _integral(time, (amplitude / top) ** power)
        columns = np.stack([np.ones_like(time), time - time.mean(), bend], axis=1)
        value, covariance = _regress(columns, y, std)
        left.append((y - columns @ value) / std)
        fits.append(((left[-1] ** 2).sum(), value[1], covariance[1, 1], np.nan, np.nan))
    score, rate, variance, onset, onset_std = np.array(fits).T
    weight = np.exp(-0.5 * (score - score.min()))
    weight /= weight.sum()
    mean = weight @ rate
    hinges = np.exp(-0.5 * (score[:3] - score[:3].min()))
    hinges /= hinges.sum()
    mean_onset = hinges @ onset[:3]
    freedom = max(y.size - 4, 1)
    miss = left[int(np.argmin(score))]
    excess = max(1.0, (miss**2).sum() / freedom)
    rate_std = np.sqrt(weight @ (variance * excess + (rate - mean) ** 2))
    spread = np.sqrt(hinges @ (onset_std[:3] ** 2 * excess + (onset[:3] - mean_onset) ** 2))
    above = amplitude > 0.7 * mean_onset
    count = max(int(above.sum()) - 2, 1)
    misfit = ((miss[above] ** 2).sum() / count - 1.0) * np.sqrt(count / 2.0) / 4.0
    shape = 0.5 * np.ptp(onset[:3])
    found = (mean, rate_std, mean_onset, spread, weight[4], shape)
    return tuple(float(value) for value in found), float(misfit)


def _integral(time: ndarray, rate: ndarray) -> ndarray:
    """Trapezoidal integral over time along the first axis, zero at the record's end."""
    steps = 0.5 * ((rate[1:] + rate[:-1]).T * np.diff(time)).T
    total = np.zeros_like(rate)
    total[:-1] = -np.cumsum(steps[::-1], axis=0)[::-1]
    return total


def _hinge_integrals(
    time: ndarray, amplitude: ndarray, onsets: ndarray, power: float
) -> Float[ndarray, "block onset"]:
    """Integral of max(0, A / A0 - 1)^p over time, from the record's end backwards."""
    return _integral(time, np.maximum(0.0, amplitude[:, None] / onsets - 1.0) ** power)


def _best_onset(
    time: ndarray, y: ndarray, std: ndarray, amplitude: ndarray, top: float, power: float
) -> float:
    """Onset of least chi-square: a coarse search over all, then ever finer around the best."""
    onsets = np.geomspace(amplitude.min(), top, 60)[1:-1]
    for _ in range(5):
        chi2 = []
        for onset in onsets:
            columns = _hinge_columns(time, amplitude, onset, power)
            value, _ = _regress(columns, y, std)
            chi2.append((((y - columns @ value) / std) ** 2).sum())
        best = int(np.argmin(chi2))
        low, high = onsets[max(best - 1, 0)], onsets[min(best + 1, onsets.size - 1)]
        found, onsets = onsets[best], np.linspace(low, high, 9)
    return float(found)


def _hinge_columns(
    time: ndarray, amplitude: ndarray, onset: float, power: float
) -> Float[ndarray, "block 3"]:
    """Constant, line, and the integral of the hinge."""
    hinge = _hinge_integrals(time, amplitude, np.array([onset]), power)
    line = np.stack([np.ones_like(time), time - time.mean()], axis=1)
    return np.concatenate([line, hinge], axis=1)


def _regress(columns: ndarray, y: ndarray, std: ndarray) -> tuple[ndarray, ndarray]:
    """Weighted least squares: coefficients and covariance."""
    design = columns / std[:, None]
    scale = np.sqrt((design**2).sum(axis=0)) + 1e-300
    design /= scale
    level = y.mean()
    covariance = np.linalg.pinv(design.T @ design, rcond=1e-13, hermitian=True)
    value = covariance @ (design.T @ ((y - level) / std)) / scale
    value[0] += level
    return value, covariance / scale[:, None] / scale


def _joint_onset(phase: Hinge, decline: Hinge) -> tuple[float, float]:
    found = [hinge for hinge in (phase, decline) if hinge.left]
    if not found:
        return np.nan, np.nan
    if len(found) == 1:
        return found[0].onset, found[0].onset_std
    gap = abs(found[0].onset - found[1].onset)
    spread = float(np.hypot(found[0].onset_std, found[1].onset_std))
    if gap < 3.0 * spread:
        weight = np.array([hinge.onset_std**-2.0 for hinge in found])
        onset = weight @ [hinge.onset for hinge in found] / weight.sum()
        return float(onset), float(weight.sum() ** -0.5)
    first = min(found, key=lambda hinge: hinge.onset)
    return first.onset, float(np.hypot(first.onset_std, 0.5 * gap))
