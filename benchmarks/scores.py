"""Scores of one record: bladeroot's own result and the peers', against the truth.

Errors: RMS over 400 amplitudes spaced evenly in ln A from 0.02 to 0.95 of the start, of f_n
relative (ppm) and of the loss factor relative (%), each against the truth at the curve's own
amplitude; median over the records. `reach` is the share of these amplitudes that a curve covers:
what lies beyond its ends or in a hole of it is not scored but missing. `met` is the share of the
whole range with a frequency within 60 ppm (a peer's best of all settings). A stick frequency that
is not given ("plateau not reached") counts as infinitely wrong.

Coverage: share of truths within 1 and 1.96 standard errors, for curves at the same amplitudes; over
all noise levels against 68 +- 5 % and 95 +- 3 %. The onset's posterior is not normal: its standard
error is half of its central 68 % interval, and its 95 % interval is stated apart (`onset_low`,
`onset_high`).

Over the bound (`bound.py`): `error/bound` is the median absolute error over 0.6745 bounds, 1 for an
efficient estimator; `std/bound` the stated standard error. What happens above the onset can teach a
little more than the bound admits.
"""

import sys
import time
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import peers
from bladeroot.decay.freevib import no_decay
from bladeroot.plateau.plateau import plateau
from bladeroot.signal.lines import white_noise
from bound import plateau_bound
from synthetic import EXPECTED_HZ, HIGHEST, LOWEST, SAMPLING_HZ, Case

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lib"))
from decay_bench import separated_curves

GRID = np.geomspace(LOWEST, HIGHEST, 400)
MET_PPM = 60.0  # a frequency this good counts as met; a missing one does not
WIDTHS = {68: 1.0, 95: 1.96}  # standard errors


def covered(case: Case, own_time: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Which times a curve reaches: between its ends, and not in a hole of it.

    A hole is a gap of more than 10 % in amplitude that is also longer than three usual steps.
    """
    if own_time.size < 2:
        return np.zeros(wanted.size, dtype=bool)
    right = np.searchsorted(own_time, wanted).clip(1, own_time.size - 1)
    gap_s = own_time[right] - own_time[right - 1]
    level = case.motion.at(own_time)[0]
    hole = (np.abs(level[right] - level[right - 1]) > 0.1) & (
        gap_s > 3 * np.median(np.diff(own_time))
    )
    return (wanted >= own_time[0]) & (wanted <= own_time[-1]) & ~hole


@dataclass(frozen=True)
class Errors:
    """Relative errors of a curve at GRID: frequency in ppm, loss factor in %; NaN out of reach."""

    frequency: np.ndarray
    loss: np.ndarray


def curve_errors(case: Case, curve: peers.Curve) -> Errors:
    """A curve against the truth at its own amplitudes."""
    own = [np.asarray(values, float) for values in curve]
    good = np.all(np.isfinite(own), axis=0) & (own[1] > 0.0)
    at, amplitude, frequency, loss = (values[good] for values in own)
    wanted = case.motion.time_of(GRID)
    inside = covered(case, at, wanted)
    errors = Errors(np.full(GRID.size, np.nan), np.full(GRID.size, np.nan))
    if inside.any():
        wanted = wanted[inside]
        x = np.exp(np.interp(wanted, at, np.log(amplitude))) / case.start_m
        frequency_true, loss_true = case.law.truth(x)
        errors.frequency[inside] = 1e6 * (np.interp(wanted, at, frequency) / frequency_true - 1.0)
        errors.loss[inside] = 1e2 * (np.interp(wanted, at, loss) / loss_true - 1.0)
    return errors


def in_short(errors: Errors, kept: np.ndarray | slice = slice(None)) -> dict[str, float]:
    """RMS over what is reached (of `kept`); shares of the whole of GRID reached and met."""
    frequency, loss = errors.frequency[kept], errors.loss[kept]
    there = np.isfinite(frequency)
    met = np.abs(errors.frequency) <= MET_PPM  # False where there is nothing
    return {
        "frequency": rms(frequency[there]) if there.any() else np.inf,
        "loss": rms(loss[there]) if there.any() else np.inf,
        "reach": float(np.isfinite(errors.frequency).mean()),
        "met": float(met.mean()),
    }


def bladeroot_scores(case: Case) -> tuple[dict[str, float], Errors]:
    """Everything about the product's own result for one record, and its curve's errors."""
    begin = time.perf_counter()
    try:
        curve = separated_curves(
            case.velocity, SAMPLING_HZ, EXPECTED_HZ, white_noise(case.velocity)
        )
    except ValueError:
        curve = no_decay()  # every score of it is the worst
    found = plateau(curve)
    seconds = time.perf_counter() - begin
    names = ("time", "amplitude", "frequency", "loss_factor")
    at, amplitude, frequency, loss = (curve[name].values for name in names)
    errors = curve_errors(case, (at, amplitude, frequency, loss))
    score = in_short(errors) | {"seconds": seconds}
    x = np.exp(case.motion.at(at)[0])
    frequency_true, loss_true = case.law.truth(x)
    wanted = case.motion.time_of(GRID)
    wanted = wanted[covered(case, at, wanted)]
    nearest = np.searchsorted(0.5 * (at[1:] + at[:-1]), wanted)
    truths = {"amplitude": x * case.start_m, "frequency": frequency_true, "loss_factor": loss_true}
    for name, truth in truths.items():
        z = np.abs(curve[name].values - truth) / curve[f"{name}_std"].values
        for percent, width in WIDTHS.items():
            within = (z[nearest] < width).mean() if wanted.size else np.nan
            score[f"{name} {percent}"] = 100.0 * float(within)
    stick, stick_loss = case.law.stick
    bounds = dict(zip(("stick_frequency", "plateau_loss"), plateau_bound(case), strict=True))
    onset = case.law.onset * case.start_m
    misses = {
        "stick_frequency": (found["stick_frequency"] - stick, found["stick_frequency_std"]),
        "plateau_loss": (found["loss_factor"] - stick_loss, found["loss_factor_std"]),
        "onset": (found["onset_amplitude"] - onset, found["onset_amplitude_std"]),
    }
    score["stick"] = 1e6 * abs(misses["stick_frequency"][0]) / stick
    score["stick loss"] = 1e2 * abs(misses["plateau_loss"][0]) / stick_loss
    score["onset"] = 1e2 * abs(misses["onset"][0]) / onset
    for name, (miss, std) in misses.items():
        for percent, width in WIDTHS.items():
            within = abs(miss) < width * std
            if name == "onset" and percent == 95:  # not normal: an interval of its own
                within = found["onset_low"] < onset < found["onset_high"]
            score[f"{name} {percent}"] = 100.0 * within if np.isfinite(miss) else np.nan
        if name in bounds:
            score[f"{name} error/bound"] = abs(miss) / bounds[name] / 0.6745
            score[f"{name} std/bound"] = std / bounds[name]
    score["stick bound"] = 1e6 * bounds["stick_frequency"] / stick
    return score, errors


def peer_scores(case: Case, own: Errors) -> dict[str, dict[str, dict[str, float]]]:
    """By peer and setting: the errors of curves, stick frequency and plateau loss factor.

    For a curve also those of bladeroot's, `own`, at just the amplitudes that this one keeps.
    """
    found: dict[str, dict[str, dict[str, float]]] = defaultdict(dict)
    stick, stick_loss = case.law.stick
    for name, peer in peers.CURVES.items():
        for setting, curve, spoilt in peer(case):
            found[name][setting] = beside(case, curve, own)
            if spoilt:
                inner = tuple(values[spoilt:-spoilt] for values in curve)
                found[f"{name}, ends cut"][setting] = beside(case, inner, own)
    for part, velocity in peers.ends(case):
        for name, peer in peers.SINGLES.items():
            for setting, (frequency, loss) in peer(velocity):
                found[f"{name}, {part}"][setting] = {
                    "stick": 1e6 * abs(frequency / stick - 1.0),
                    "stick loss": 1e2 * abs(loss / stick_loss - 1.0),
                }
    return found


def beside(case: Case, curve: peers.Curve, own: Errors) -> dict[str, float]:
    """A peer's curve, and bladeroot's own at the amplitudes that it keeps."""
    errors = curve_errors(case, curve)
    same = in_short(own, np.isfinite(errors.frequency))
    score = in_short(errors) | tail_errors(case, curve)
    return score | {"own frequency": same["frequency"], "own loss": same["loss"]}


def tail_errors(case: Case, curve: peers.Curve) -> dict[str, float]:
    """Stick frequency and plateau loss factor as medians of a curve below 10 % of the start."""
    x = curve[1] / case.start_m
    low = (x > LOWEST) & (x < peers.TAIL) & np.isfinite(curve[2])
    if not low.any():
        return {}
    stick, stick_loss = case.law.stick
    return {
        "stick": 1e6 * abs(np.median(curve[2][low]) / stick - 1.0),
        "stick loss": 1e2 * abs(np.median(curve[3][low]) / stick_loss - 1.0),
    }


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
