"""What the extension is worth on data that the fit has not seen."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Int
from numpy import ndarray

from bladeroot.diagnosis.curve_model import QUANTITIES
from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.naming import Found
from bladeroot.inference.hold_out import HeldOut, hold_out

Sides = dict[str, float]
# What is left out, by what a cause is a function of; holds and groups always.
PARTS = {
    "force": "between_forces",
    "hold": "between_holds",
    "time": "between_times",
    "clamping": "between_times",
    "since": "between_times_in_a_hold",
    "sign": "between_directions",
    "temperature": "between_temperatures",
    "group": "between_groups",
}


def gains(made: Diagnosis) -> dict:
    """Held-out errors before and after: between parts of the records, and within records.

    Parts are left out of each variable that a cause acts on (`PARTS`), `damping_` before those of
    loss factors. An error between is the rms of the mean misses of a part's data of one mode, so
    that records of one hold count once; within records of every point.
    """
    result: dict = {}
    for found in (one for one in made.found if one.causes):
        if found.channel.name == "curve":
            quantity = made.curves.quantity
            for part, key in (("force", "within_records"), ("amplitude", "between_amplitudes")):
                held = _held(found, part)
                result[key] = {
                    name: _rms(side.error[quantity == q] for side in held) | {"unit": "1"}
                    for q, name in enumerate(QUANTITIES)
                }
                if part == "force":
                    result["log_score_curves"] = _log_score(held)
            continue
        acts = {"force", "hold", "group", *(v for one in found.causes for v in one.mechanism.over)}
        stick = found.channel.name == "stick"
        for part in (name for name in PARTS if name in acts & found.channel.part.keys()):
            held = _held(found, part)
            key = PARTS[part] if stick else f"damping_{PARTS[part]}"
            result[key] = _between(made, found, part, held)
            if stick and part == "force":
                result["log_score"] = _log_score(held)
                spared = _held(found, part, made.simulated.biases)
                result[f"{key}_without_bias"] = _between(made, found, part, spared)
    return result


def _between(made: Diagnosis, found: Found, part: str, held: list[HeldOut]) -> dict:
    """Both sides' errors over all modes and by mode."""
    data = made.data if found.channel.name == "stick" else made.damping.stick
    means = _means(held, found.channel.part[part], data.records.mode)
    by_mode = {data.modes[g]: _rms(own) for g, own in means.items()}
    return _rms(zip(*means.values(), strict=True)) | {"unit": "1", "by_mode": by_mode}


def _held(found: Found, part: str, allowance: slice = slice(0)) -> list[HeldOut]:
    """Every part left out once, with the baseline and with the causes."""
    parts = found.channel.part[part]
    return [hold_out(fitted, parts, allowance) for fitted in (found.baseline, found.final)]


def _means(
    held: Iterable[HeldOut], parts: Int[ndarray, " datum"], group: Int[ndarray, " datum"]
) -> dict[int, list[ndarray]]:
    """By group, of both sides the mean miss of each part."""
    pairs, where = np.unique(np.stack([group, parts]), axis=1, return_inverse=True)
    means = [np.bincount(where, side.error) / np.bincount(where) for side in held]
    return {int(g): [one[pairs[0] == g] for one in means] for g in np.unique(group)}


def _rms(sides: Iterable) -> Sides:
    rows = (np.hstack(side) for side in sides)
    return dict(
        zip(("before", "after"), (float(np.sqrt(np.mean(x**2))) for x in rows), strict=True)
    )


def _log_score(held: list[HeldOut]) -> Sides:
    before, after = (float(side.log_score.sum()) for side in held)
    return {"before": before, "after": after}
