"""The stick plateau: where a decay's frequency and damping are constant, and how well.

On the plateau the log-phasor of the displacement is a straight line in time: its phase rises by
omega, its log-amplitude by A'/A. What the rates do above is not known, so a catalogue of laws is
weighed by evidence on the independent blocks of cycles (`bladeroot.plateau.laws`, `.weigh`), where
least squares is efficient and its errors hold; the rates of laws with an onset come from below it.
A record has a plateau when at least four fifths of the weight is on laws with a constant segment of
a factor of two or more in amplitude, or without any slope at small amplitude (A^2 and flatter), and
the rest of the laws' spread is in the standard error; and when its onset, if it has one, lies that
factor above the smallest amplitude. Otherwise the plateau is not reached: the
record gives a bound, and nothing is extrapolated.
"""

from dataclasses import replace

import numpy as np
import xarray as xr

from bladeroot.plateau.capture import sudden_onset
from bladeroot.plateau.posterior import CENTRAL_INTERVALS, SHORTEST_PLATEAU, Mixture, Weighed
from bladeroot.plateau.segment import cubic, grouped
from bladeroot.plateau.weigh import STATED_PLATEAU_WEIGHT, weigh
from bladeroot.signal.phasors import natural
from bladeroot.variables import dataset, names

RECORD_VARIABLES = names("plateau/record")
# Points of the curve, blocks of cycles and groups of blocks from which on laws are weighed.
FEWEST_BLOCKS = 12
# Standard error (ln A and rad) of a block.
BLUNT_STD = 0.15  # one that is worse is not used
SHARP_STD = 1e-3  # one that is better gives ln A for the laws itself, instead of the smoothed curve


def plateau(decay: xr.Dataset) -> dict[str, float | str]:
    """Stick frequency, loss factor and onset amplitude of one decay (dims as from `freevib`).

    The attribute `damping` says what the frequency and the loss factor belong to: "hysteretic"
    (the default) or "viscous".

    Returns:
        Table `record` of variables.csv, and `verdict`; NaN where there is none. The spread over
        the laws is in the standard errors. When the curve may still bend at the smallest usable
        amplitude, stick_frequency is NaN, and frequency_bound is the frequency there; by a law
        that saturates the limit may lie outside limit_low to limit_high.
    """
    result: dict[str, float | str] = dict.fromkeys(RECORD_VARIABLES, np.nan)
    result["plateau_reached"] = 0
    rejected = decay.attrs.get("verdict", "usable") == "rejected"
    if rejected or decay.sizes["point"] < FEWEST_BLOCKS:
        reason = decay.attrs.get("reason", "") if rejected else ""
        return result | {"verdict": f"rejected: {reason or 'too few points above the noise'}"}
    time, amplitude = decay["time"].values, decay["amplitude"].values
    within = (decay["block_time"].values <= time[-1]) & (decay["block_std"].values < BLUNT_STD)
    if within.sum() < FEWEST_BLOCKS:
        return result | {"verdict": "rejected: too few cycles are sharp enough"}
    blocks = {name: decay[f"block_{name}"].values[within] for name in ("time", "std", "phase")}
    both = np.stack([decay["block_log_amplitude"].values[within], blocks["phase"]])
    smooth = cubic(blocks["time"], time, np.log(amplitude))
    log = np.where(blocks["std"] < SHARP_STD, both[0], smooth)
    segment = grouped(blocks["time"], both, blocks["std"], log)
    if segment.time.size < FEWEST_BLOCKS:
        return result | {"verdict": "rejected: too few cycles of falling amplitude"}
    found = weigh(segment)
    sudden = sudden_onset(blocks["time"], both[0], blocks["std"], found.decline.mean()[0])
    if sudden and segment.below(sudden[2]).time.size >= FEWEST_BLOCKS:
        # after the capture the joint sticks, whatever law it slipped by before
        after = weigh(segment.below(sudden[2]))
        onset = Mixture(*(np.array([one]) for one in (1.0, sudden[0], sudden[1] ** 2)))
        found = replace(after, onset=onset, departs=1.0)
    omega, omega_std = found.phase.mean()
    alpha, alpha_std = found.decline.mean()
    damping = decay.attrs.get("damping", "hysteretic")
    frequency, loss = _natural(omega, alpha, damping)
    ends = _ends(found, float(amplitude.max()))
    constant = np.log(ends.get("onset_amplitude", np.inf)) - found.lowest
    reached = found.phase.plateau >= STATED_PLATEAU_WEIGHT and constant >= SHORTEST_PLATEAU
    lowest, lowest_std = (omega, omega_std) if reached else found.phase.mean(lowest=True)
    bound = _natural(lowest, alpha, damping)[0]
    if not _in_band(bound, decay):
        return result | {"verdict": "rejected: too few cycles are sharp enough"}
    result["plateau_weight"] = found.phase.plateau
    if found.decline.plateau >= STATED_PLATEAU_WEIGHT:
        result |= {"loss_factor": loss, "loss_factor_std": 2.0 * alpha_std / omega}
    if not reached:
        low, high = (_natural(limit, alpha, damping)[0] for limit in found.phase.limits())
        if not all(_in_band(limit, decay) for limit in (low, high)):
            low, high = np.nan, np.nan  # an extrapolation that leaves the band tells no limit
        return result | {
            "frequency_bound": bound,
            "frequency_bound_std": lowest_std / (2.0 * np.pi),
            "limit_low": low,
            "limit_high": high,
            "verdict": "plateau not reached",
        }
    result |= ends
    fallen = np.minimum.accumulate(np.log(amplitude))
    return result | {
        "stick_frequency": frequency,
        "stick_frequency_std": omega_std / (2.0 * np.pi),
        "onset_time": float(np.interp(-np.log(result["onset_amplitude"]), -fallen, time)),
        "plateau_reached": 1,
        "verdict": "plateau",
    }


def _in_band(frequency: float, decay: xr.Dataset) -> bool:
    """Whether a frequency (Hz) lies in the band in which the mode was looked for."""
    low, high = decay.attrs.get("band_low_Hz", 0.0), decay.attrs.get("band_high_Hz", np.inf)
    return bool(low < frequency < high)


def _natural(omega: float, alpha: float, damping: str) -> tuple[float, float]:
    """Undamped natural frequency (Hz) and loss factor where both rates are constant."""
    omega_n, loss = natural(np.array([[alpha], [omega]]), np.zeros((2, 1)), damping)
    return float(omega_n[0]) / (2.0 * np.pi), float(loss[0])


def _ends(found: Weighed, largest: float) -> dict[str, float]:
    """Onset amplitude, and where the constant segment begins and ends."""
    lowest = float(np.exp(found.lowest))
    if found.onset is None or found.departs < 0.5:
        ends = {"plateau_low_amplitude": lowest, "plateau_high_amplitude": largest}
        never = min(found.phase.constant, found.decline.constant) >= 0.5
        return ends | {"onset_bound": largest} if never else {}
    median, *ends = found.onset.quantiles((0.5, *CENTRAL_INTERVALS[68], *CENTRAL_INTERVALS[95]))
    onset, low, high, lower, upper = np.exp([median, *ends])
    return {
        "onset_amplitude": float(onset),
        "onset_amplitude_std": float(0.5 * (high - low)),
        "onset_low": float(lower),
        "onset_high": float(upper),
        "plateau_low_amplitude": lowest,
        "plateau_high_amplitude": float(low),
    }


OTHER_MODES_NOTE = (
    "other modes ring in the record and add to the slip: a lower bound for this mode alone"
)


def record_plateau(decay: xr.Dataset) -> xr.Dataset:
    """Stick frequency, loss factor, onset and verdict of one decay, with its attributes.

    Variables are the scalars of `bladeroot.plateau.plateau.plateau`; NaN where there is none.
    """
    found = plateau(decay)
    made = dataset("plateau/record", {name: found[name] for name in RECORD_VARIABLES})
    if decay.attrs.get("damping") == "viscous":
        made["loss_factor"].attrs["long_name"] = "twice the damping ratio of the stick plateau"
    if np.size(decay.attrs.get("other_modes_Hz", ())):
        made["onset_amplitude"].attrs["note"] = OTHER_MODES_NOTE
    verdict = dataset("plateau/verdict", {"verdict": found["verdict"]})
    return made.assign(verdict).assign_attrs(decay.attrs)
