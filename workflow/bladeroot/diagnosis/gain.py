"""What the extension is worth on data that the fit has not seen."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Int
from numpy import ndarray

from bladeroot.diagnosis.curve_model import QUANTITIES
from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.naming import Found
from bladeroot.diagnosis.simulation.parametric import Parametric, biases
from bladeroot.inference.hold_out import HeldOut, hold_out

Sides = dict[str, float]


def gains(made: Diagnosis) -> dict:
    """Held-out errors before and after: between forces and holds, within records.

    An error between is the rms of the mean misses of a part's data of one mode, so that records of
    one hold count once; within records of every point.
    """
    result: dict = {}
    free = biases(made.simulated) if isinstance(made.simulated, Parametric) else slice(0)
    for found in (one for one in made.found if one.causes):
        if found.channel.name == "stick":
            for name, part, allowance in (
                ("between_forces", "force", slice(0)),
                ("between_forces_without_bias", "force", free),
                ("between_holds", "hold", slice(0)),
            ):
                held = _held(found, part, allowance)
                means = _means(held, found.channel.part[part], made.data.records.mode)
                result[name] = _rms(zip(*means.values(), strict=True)) | {
                    "unit": "1",
                    "by_mode": {made.data.modes[g]: _rms(own) for g, own in means.items()},
                }
                if name == "between_forces":
                    result["log_score"] = _log_score(held)
        elif found.channel.name == "curve":
            held, quantity = _held(found, "force"), made.curves.quantity
            result["within_records"] = {
                name: _rms(side.error[quantity == q] for side in held) | {"unit": "1"}
                for q, name in enumerate(QUANTITIES)
            }
            result["log_score_curves"] = _log_score(held)
    return result


def _held(found: Found, part: str, allowance: slice = slice(0)) -> list[HeldOut]:
    """Every force, or every hold, left out once, with the baseline and with the causes."""
    parts = found.channel.part[part]
    return [hold_out(fitted, parts, allowance) for fitted in (found.baseline, found.final)]


def _means(
    held: Iterable[HeldOut], parts: Int[ndarray, " datum"], group: Int[ndarray, " datum"]
) -> dict[int, list[ndarray]]:
    """By group, of both sides the mean miss of each part."""
    rows = {
        int(g): [(group == g) & (parts == p) for p in np.unique(parts[group == g])]
        for g in np.unique(group)
    }
    return {
        g: [np.array([side.error[here].mean() for here in own]) for side in held]
        for g, own in rows.items()
    }


def _rms(sides: Iterable) -> Sides:
    rows = (np.hstack(side) for side in sides)
    return dict(
        zip(("before", "after"), (float(np.sqrt(np.mean(x**2))) for x in rows), strict=True)
    )


def _log_score(held: list[HeldOut]) -> Sides:
    before, after = (float(side.log_score.sum()) for side in held)
    return {"before": before, "after": after}
