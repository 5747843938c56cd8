"""The stick plateau: where a decay's frequency and damping are constant, and how well.

On the plateau the log-phasor of the displacement is a straight line in time: its phase rises by
omega, its log-amplitude by A'/A. Above the onset amplitude A0 its rate leaves the constant as

    rate = rate0 + c1 e^p + c2 e^(p+1),   e = max(0, A / A0 - 1),

with p = 1, 3/2 or 2 and c of either sign: slip in a Coulomb contact softens with p = 3/2 and damps
with p = 1 (expand 3.19 near x0 = x_cr), and a rising frequency is as welcome as a falling one.
The line and the hinge are fitted to the independent blocks of cycles themselves, where least
squares is efficient and its standard errors hold, not to the correlated points of the curves.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

POWERS = (1.0, 1.5, 2.0)
# One record in a hundred without an onset shows one at this likelihood ratio (found by
# simulation, tests/unit/test_decay_plateau.py).
DETECTION = 19.0


@dataclass(frozen=True)
class Hinge:
    """The constant rate of the plateau, and the amplitude where the rate leaves it."""

    rate: float
    rate_std: float
    onset: float
    onset_std: float
    lowest: float
    highest: float

    @property
    def left(self) -> bool:
        """Whether the record leaves the constant at all."""
        return bool(np.isfinite(self.onset))

    @property
    def reached(self) -> bool:
        """Whether the constant shows: a stretch by a factor of 1.5 below the onset's error."""
        if not self.left:
            return True
        return bool(self.onset * np.exp(-2.0 * self.onset_std / self.onset) > 1.5 * self.lowest)


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
    if decay.attrs.get("verdict", "usable") == "rejected" or decay.sizes["point"] < 8:
        reason = decay.attrs.get("findings", "") or "too few points above the noise"
        return result | {"verdict": f"rejected: {reason}"}
    time, amplitude = decay["time"].values, decay["amplitude"].values
    within = decay["block_time"].values <= time[-1]
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
        return Hinge(line[0][1], float(np.sqrt(line[1][1, 1])), np.nan, np.nan, lowest, highest)
    best = None
    for reach in (1.2, 1.5, 2.0, 3.0, 5.0):
        fit = _averaged_hinge(time, y, std, amplitude, min(top * reach, highest))
        if fit is None:
            continue
        found, misfit = fit
        if best is None or (misfit < 1.0 and found[3] < best[3]):
            best = found
        if misfit >= 1.0 or top * reach >= highest:
            break
    if best is None:
        return Hinge(np.nan, np.nan, lowest, np.nan, lowest, highest)
    return Hinge(*best, lowest, highest)


def _first_departure(
    time: ndarray, y: ndarray, std: ndarray, amplitude: ndarray, detection: float
) -> float | None:
    """Smallest top of an amplitude window in which a hinge shows, or None."""
    lowest, highest = amplitude.min(), amplitude.max()
    onsets = np.geomspace(lowest, highest, max(8, int(8 * np.log(highest / lowest)) + 1))
    hinges = _hinge_integrals(time, amplitude, onsets, 1.0)
    for top in onsets[3:]:
        keep = amplitude <= top * (1.0 + 1e-9)
        if keep.sum() < 8:
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
) -> tuple[tuple[float, float, float, float], float] | None:
    """(rate, std, onset, std) over the powers, and the misfit (above 1: not described)."""
    keep = amplitude <= top * (1.0 + 1e-9)
    if keep.sum() < 12:
        return None
    time, y, std, amplitude = time[keep], y[keep], std[keep], amplitude[keep]
    onsets = np.geomspace(amplitude.min(), top, 160)[1:-2]
    fits, left = [], []
    for power in POWERS:
        first = _hinge_integrals(time, amplitude, onsets, power)
        second = _hinge_integrals(time, amplitude, onsets, power + 1.0)
        chi2 = np.array(
            [_chi2(_columns(time, first[:, k], second[:, k]), y, std) for k in range(onsets.size)]
        )
        best = int(np.argmin(chi2))
        onset = onsets[best]
        if 0 < best < onsets.size - 1:
            curve = chi2[best - 1] - 2 * chi2[best] + chi2[best + 1]
            onset *= (onsets[1] / onsets[0]) ** (
                0.5 * (chi2[best - 1] - chi2[best + 1]) / max(curve, 1e-12)
            )
        inside = onsets[chi2 < chi2[best] + 1.0]
        onset_std = max(0.5 * (inside[-1] - inside[0]), onset * (onsets[1] / onsets[0] - 1) / 3)
        step = onset * 1e-3
        around = _hinge_integrals(time, amplitude, np.array([onset - step, onset + step]), power)
        columns = _columns(
            time,
            around.mean(axis=1),
            _hinge_integrals(time, amplitude, np.array([onset]), power + 1.0)[:, 0],
        )
        value, covariance = _regress(columns, y, std)
        # the onset's own error moves the rate, too
        shift = value[2] * (around[:, 1] - around[:, 0]) / (2 * step)
        _, wider = _regress(np.column_stack([columns, shift]), y, std)
        variance = max(covariance[1, 1], min(wider[1, 1], 9 * covariance[1, 1]))
        fits.append((chi2[best], value[1], variance, onset, onset_std))
        left.append((y - columns @ value) / std)
    chi2, rate, variance, onset, onset_std = np.array(fits).T
    weight = np.exp(-0.5 * (chi2 - chi2.min()))
    weight /= weight.sum()
    mean, mean_onset = weight @ rate, weight @ onset
    freedom = max(y.size - 5, 1)
    excess = max(1.0, chi2.min() / freedom)
    rate_std = np.sqrt(weight @ (variance * excess + (rate - mean) ** 2))
    spread = np.sqrt(weight @ (onset_std**2 * excess + (onset - mean_onset) ** 2))
    above = amplitude > 0.7 * mean_onset
    count = max(int(above.sum()) - 3, 1)
    misfit = ((left[int(np.argmin(chi2))][above] ** 2).sum() / count - 1.0) / 4.0 * np.sqrt(count / 2)
    return (float(mean), float(rate_std), float(mean_onset), float(spread)), float(misfit)


def _hinge_integrals(
    time: ndarray, amplitude: ndarray, onsets: ndarray, power: float
) -> Float[ndarray, "block onset"]:
    """Integral of max(0, A / A0 - 1)^p over time, from the record's end backwards."""
    rate = np.maximum(0.0, amplitude[:, None] / onsets - 1.0) ** power
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(time)[:, None]
    total = np.zeros_like(rate)
    total[:-1] = -np.cumsum(steps[::-1], axis=0)[::-1]
    return total


def _columns(time: ndarray, first: ndarray, second: ndarray) -> Float[ndarray, "block 4"]:
    centred = time - time.mean()
    return np.stack([np.ones_like(time), centred, first, second], axis=1)


def _regress(columns: ndarray, y: ndarray, std: ndarray) -> tuple[ndarray, ndarray]:
    """Weighted least squares: coefficients and covariance."""
    scale = np.abs(columns / std[:, None]).max(axis=0) + 1e-300
    design = columns / std[:, None] / scale
    inverse = np.linalg.pinv(design, rcond=1e-12)
    level = y.mean()
    value = inverse @ ((y - level) / std) / scale
    value[0] += level
    return value, inverse @ inverse.T / scale[:, None] / scale


def _chi2(columns: ndarray, y: ndarray, std: ndarray) -> float:
    value, _ = _regress(columns, y, std)
    return float((((y - columns @ value) / std) ** 2).sum())


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
    return first.onset, first.onset_std
