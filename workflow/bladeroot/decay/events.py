"""Records of one event as one: what several sensors saw of one motion is no repeat of it."""

import numpy as np
import pandas as pd
from numpy import ndarray

from bladeroot.decay.record import RECORD

_VALUES = ("stick_frequency", "loss_factor")


def by_event(records: pd.DataFrame) -> pd.DataFrame:
    """The records of one mode with those of one event, load and direction as one row each.

    records: columns of `bladeroot.decay.stick`. Noise is each sensor's own, so that values are
    averaged by their errors; where they lie further apart than these allow, the error grows (its
    root of chi squared over the degrees of freedom). An amplitude belongs to a sensor: the onset of
    what several saw is not known. `seen_by` is the number of records in a row.
    """
    records = records.assign(seen_by=1)
    several = records[records["event"] != ""]
    rows = [records[records["event"] == ""]]
    for _, seen in several.groupby(["event", "force", "direction"], sort=True):
        rows.append(seen if len(seen) == 1 else _one(seen))
    return pd.concat(rows) if len(rows) > 1 else records


def _one(seen: pd.DataFrame) -> pd.DataFrame:
    """The rows of one event as one row, named as the first."""
    row = seen.iloc[:1].copy()
    for name in _VALUES:
        row[name], row[f"{name}_std"] = _mean(
            seen[name].to_numpy(float), seen[f"{name}_std"].to_numpy(float)
        )
    for name in RECORD:
        if name.startswith("onset"):
            row[name] = np.nan
    return row.assign(sensor="", seen_by=len(seen))


def _mean(value: ndarray, std: ndarray) -> tuple[float, float]:
    known = np.isfinite(value) & (std > 0.0)
    if not known.any():
        return np.nan, np.nan
    value, weight = value[known], 1.0 / std[known] ** 2
    mean = float(weight @ value / weight.sum())
    apart = float(weight @ (value - mean) ** 2) / max(value.size - 1, 1)
    return mean, float(np.sqrt(max(apart, 1.0) / weight.sum()))
