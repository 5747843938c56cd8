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
from jaxtyping import Float
from numpy import ndarray

from bladeroot.plateau.posterior import CENTRAL_INTERVALS, SHORTEST_PLATEAU, Mixture, Weighed
from bladeroot.plateau.segment import cubic, grouped
from bladeroot.plateau.weigh import STATED_PLATEAU_WEIGHT, weigh
from bladeroot.signal.phasors import natural
from bladeroot.signal.runs import medians
from bladeroot.variables import dataset, names

RECORD_VARIABLES = names("plateau/record")
# Points of the curve, blocks of cycles and groups of blocks from which on laws are weighed.
FEWEST_BLOCKS = 12
# Standard error (ln A and rad) of a block.
BLUNT_STD = 0.15  # one that is worse is not used
SHARP_STD = 1e-3  # one that is better gives ln A for the laws itself, instead of the smoothed curve
# A sudden capture. A block slips where its ln A lies above the plateau's line by both of these.
SLIPPING_LEVEL = 0.1  # in ln A; the last fall, from one block to the next, is larger than this too
SLIPPING_ERRORS = 5.0  # standard errors
# The fall is sudden where at most this share of the height two blocks before is left after it.
LEFT_AFTER_FALL = 0.1
FEWEST_SETTLED = 5  # blocks from the last one that slips on, itself counted, at least
MOMENT_STD = 0.3  # blocks: error of the moment of capture, from sliders of known critical amplitude
NEAR_BLOCKS = 9  # around a block, whose median error is its own at most
OTHER_MODES_NOTE = (
    "other modes ring in the record and add to the slip: a lower bound for this mode alone"
)


def plateau(curves: xr.Dataset) -> dict[str, float | str]:
    """Stick frequency, loss factor and onset amplitude of one decay (dims as from `freevib`).

    The attribute `damping` says what the frequency and the loss factor belong to: "hysteretic"
    (the default) or "viscous".

    Returns:
        Table `record` of variables.csv, and `verdict`; NaN where there is none. The spread over
        the laws is in the standard errors. When the curve may still bend at its smallest
        amplitude, stick_frequency is NaN, and frequency_bound is its frequency there; by a law
        that saturates, or slips in a chain of sliders, the limit may lie outside limit_low to
        limit_high.
    """
    result: dict[str, float | str] = dict.fromkeys(RECORD_VARIABLES, np.nan)
    result["plateau_reached"] = 0
    rejected = curves.attrs.get("verdict", "usable") == "rejected"
    if rejected or curves.sizes["point"] < FEWEST_BLOCKS:
        reason = curves.attrs.get("reason", "") if rejected else ""
        return result | {"verdict": f"rejected: {reason or 'too few points above the noise'}"}
    time, amplitude = curves["time"].values, curves["amplitude"].values
    within = (curves["block_time"].values <= time[-1]) & (curves["block_std"].values < BLUNT_STD)
    if within.sum() < FEWEST_BLOCKS:
        return result | {"verdict": "rejected: too few cycles are sharp enough"}
    blocks = {name: curves[f"block_{name}"].values[within] for name in ("time", "std", "phase")}
    both = np.stack([curves["block_log_amplitude"].values[within], blocks["phase"]])
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
    damping = curves.attrs.get("damping", "hysteretic")
    frequency, loss = _natural(omega, alpha, damping)
    ends = _ends(found, float(amplitude.max()))
    constant = np.log(ends.get("onset_amplitude", np.inf)) - found.lowest
    reached = found.phase.plateau >= STATED_PLATEAU_WEIGHT and constant >= SHORTEST_PLATEAU
    last = int(np.argmin(amplitude))
    bound = frequency if reached else float(curves["frequency"].values[last])
    if not _in_band(bound, curves):
        return result | {"verdict": "rejected: too few cycles are sharp enough"}
    result["plateau_weight"] = found.phase.plateau
    if found.decline.plateau >= STATED_PLATEAU_WEIGHT:
        result |= {"loss_factor": loss, "loss_factor_std": 2.0 * alpha_std / omega}
    if not reached:
        low, high = (_natural(limit, alpha, damping)[0] for limit in found.phase.limits())
        if not all(_in_band(limit, curves) for limit in (low, high)):
            low, high = np.nan, np.nan  # an extrapolation that leaves the band tells no limit
        return result | {
            "frequency_bound": bound,
            "frequency_bound_std": float(curves["frequency_std"].values[last]),
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


def _in_band(frequency: float, curves: xr.Dataset) -> bool:
    """Whether a frequency (Hz) lies in the band in which the mode was looked for."""
    low, high = curves.attrs.get("band_low_Hz", 0.0), curves.attrs.get("band_high_Hz", np.inf)
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


def record_plateau(curves: xr.Dataset) -> xr.Dataset:
    """Stick frequency, loss factor, onset and verdict of one decay, with its attributes.

    Variables are the scalars of `bladeroot.plateau.plateau.plateau`; NaN where there is none.
    """
    found = plateau(curves)
    made = dataset("plateau/record", {name: found[name] for name in RECORD_VARIABLES})
    if curves.attrs.get("damping") == "viscous":
        made["loss_factor"].attrs["long_name"] = "twice the damping ratio of the stick plateau"
    if np.size(curves.attrs.get("other_modes_Hz", ())):
        made["onset_amplitude"].attrs["note"] = OTHER_MODES_NOTE
    verdict = dataset("plateau/verdict", {"verdict": found["verdict"]})
    return made.assign(verdict).assign_attrs(curves.attrs)


def sudden_onset(
    time: Float[ndarray, " block"],
    log: Float[ndarray, " block"],
    std: Float[ndarray, " block"],
    rate: float,
) -> tuple[float, float, float] | None:
    """ln of the amplitude at a sudden capture, its standard error, and ln A where all has settled.

    None where there is none. One Coulomb contact alone may take half of the amplitude in the last
    slipping cycle and stick from the next turning point on, faster than a law over blocks can tell.
    The critical amplitude is then that of the plateau, carried back to the moment of capture: where
    the fall of the last slipping blocks meets the plateau's line.

    log: ln A of the blocks. rate: of ln A on the plateau.
    """
    # the blocks of a capture often have large errors, as they lie off any smooth curve
    around = np.pad(std, NEAR_BLOCKS // 2, mode="edge")
    calm = medians(np.lib.stride_tricks.sliding_window_view(around, NEAR_BLOCKS))
    std = np.minimum(std, calm)
    above = log - rate * time
    sharp = above[std < 2.0 * np.median(std)]
    above = above - np.median(sharp[-sharp.size // 4 :])
    slipping = np.flatnonzero(above > np.maximum(SLIPPING_LEVEL, SLIPPING_ERRORS * std))
    if not slipping.size or not 1 <= slipping[-1] <= time.size - FEWEST_SETTLED:
        return None
    last = int(slipping[-1])
    weight = std[last + 2 :] ** -2.0
    level = float(above[last + 2 :] @ weight / weight.sum())
    before, here, after = above[last - 1 : last + 2] - level
    if (
        abs(after) > max(LEFT_AFTER_FALL * before, 3.0 * std[last + 1])
        or before < here + SLIPPING_LEVEL
    ):
        return None
    step = time[last] - time[last - 1]
    at = time[last] + min(here / (before - here), 2.0) * step
    width = np.hypot(MOMENT_STD * abs(rate) * step, weight.sum() ** -0.5)
    line = log[last] - here  # the plateau's, at the last slipping block
    return float(line + rate * (at - time[last])), float(width), float(log[last + 3])
