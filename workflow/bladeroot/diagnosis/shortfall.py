"""In words: which quantity of which mode the baseline misses, and how it runs."""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis.curve_model import CurveData
from bladeroot.diagnosis.stick_model import StickData
from bladeroot.inference.gaussian import Fit

# Quantities of a channel's data, one behind another.
NAMES = {
    "stick": ("stick frequency",),
    "damping": ("loss factor of the stuck joint",),
    "curve": ("frequency over amplitude", "loss factor over amplitude"),
}


def of_records(
    channel: str, data: StickData, fitted: Fit, smooth_in: str
) -> list[dict[str, object]]:
    """One entry a mode: the part of the miss that runs with `smooth_in`, and its size."""
    records = data.records
    miss = fitted.problem.data - fitted.state.mean
    variable = smooth_in.partition(",")[0]
    along = {
        "time": records.time,
        "time in a clamping": records.since,
        "direction": records.sign,
        "temperature": records.temperature,
    }.get(variable, np.log(records.force))
    entries = []
    for number, mode in enumerate(data.modes):
        mine = records.mode == number
        if mine.sum() < 3 or np.ptp(along[mine]) == 0.0:
            continue
        size, text = _trend(along[mine], miss[mine], variable)
        entries.append(
            {"quantity": NAMES[channel][0], "mode": mode, "trend": text, "size": size, "unit": "1"}
        )
    return entries


def _trend(
    x: Float[ndarray, " record"], y: Float[ndarray, " record"], name: str
) -> tuple[float, str]:
    """Change of y over the range of x by a straight line, or the bend where that is larger.

    With a predicate that says it, in which `bladeroot.terms` puts a campaign's own words.
    """
    unit = 2.0 * (x - x.min()) / np.ptp(x) - 1.0
    degree = 2 if np.unique(x).size > 3 else 1
    poly = np.polynomial.legendre.legfit(unit, y, degree)
    rise = 2.0 * poly[1]
    name = name.replace("force", "{force}")
    if degree == 2 and abs(1.5 * poly[2]) > abs(rise):
        way, size = "higher" if poly[2] > 0 else "lower", _percent(1.5 * poly[2])
        return float(1.5 * abs(poly[2])), (
            f"lies {way} {{than_simulated}} at both ends of the {name} by {size}"
        )
    way = "rises" if rise > 0 else "falls"
    return float(rise), f"{way} with the {name} by {_percent(rise)} more {{than_simulated}}"


def _percent(ln_ratio: float) -> str:
    """A change of a logarithm as the size of the change in per cent: a fall is below 100."""
    size = 100 * abs(np.expm1(ln_ratio))
    return f"{size:.2g} %" if size < 99.5 else f"{size:.0f} %"


def of_curves(data: CurveData, fitted: Fit) -> list[dict[str, object]]:
    """One entry a mode and quantity that leaves its plateau: its excess at the top amplitude."""
    entries = []
    miss = fitted.problem.data - fitted.state.mean
    n = data.points.mode.size
    for quantity, name in enumerate(NAMES["curve"]):
        value = miss[quantity * n : (quantity + 1) * n]
        for number, mode in enumerate(data.modes):
            tops = _tops(data, number)
            if not tops.size:
                continue
            size = float(value[tops[np.argmax(np.abs(value[tops]))]])
            way = "rises" if size > 0 else "falls"
            shown = _percent(size) if quantity == 0 else f"{100.0 * abs(size):.2g} % (absolute)"
            entries.append(
                {"quantity": name, "mode": mode, "size": size, "unit": "1",
                 "trend": f"{way} with the amplitude by up to {shown} more {{than_simulated}}"}
            )  # fmt: skip
    return entries


def _tops(data: CurveData, mode: int) -> Int[ndarray, " level"]:
    """The point of largest amplitude of each level of a mode."""
    levels = np.unique(data.level[data.points.mode == mode])
    return np.array(
        [np.flatnonzero(data.level == k)[np.argmax(data.points.amplitude[data.level == k])]
         for k in levels], dtype=int
    )  # fmt: skip
