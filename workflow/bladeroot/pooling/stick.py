"""Stick frequencies of a campaign: per record, and pooled per mode and axial force (3.20, 3.21)."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr
from numpy import ndarray

from bladeroot.loads import load_attrs, load_facts_of, value_of
from bladeroot.plateau.plateau import RECORD_VARIABLES
from bladeroot.pooling.components import Pooled, pool
from bladeroot.pooling.scatter_of_table import FEWEST_ROWS, scatter_about_law
from bladeroot.variables import dataset, registered

# Variables of a level beside its mode, force and group.
LEVEL_VARIABLES = (
    "frequency", "frequency_std", "within_std", "between_std", "between_record_std",
    "between_hold_std", "record_freedom", "hold_freedom", "direction_difference",
    "mode_direction_difference", "mode_direction_difference_std", "loss_factor", "loss_factor_std",
    "onset_amplitude", "onset_amplitude_std", "records", "holds",
)  # fmt: skip
# Variables of a record that are averaged over the sensors of one event.
_OF_EVENT = ("stick_frequency", "loss_factor")
RECORD_TEXTS = ("hold", "direction", "event", "group", "sensor")  # of a record, beside its numbers
# Variables that are whole numbers.
COUNTS = ("plateau_reached", "records", "holds", "record_freedom", "hold_freedom")

# Mean and standard error by group and force.
_Levels = dict[tuple[str, float], tuple[float, float]]
_NOT_KNOWN = (np.nan, np.nan)


def stick_from_records(plateaus: Sequence[xr.Dataset]) -> xr.Dataset:
    """Stick frequency and damping of every record, and of every mode at every force.

    Each plateau (`bladeroot.plateau.plateau`) carries `mode`, its load and optionally `record`,
    `hold`, `direction`, `event`, `group` and `sensor` in its attributes. Each group has its own
    mean; records of one event are one motion (`by_event`). Records at one force are pooled
    (`bladeroot.pooling.components`): the unit of replication is the clamping, records without one
    are clampings of their own, and what a mode's records and clampings scatter is told from all its
    forces and groups. Where loading up and down both occur, the frequency is that between them and
    their difference is reported; it does not count as scatter. `frequency_std` makes a normal 95 %
    interval right whatever the degrees of freedom. Where no force is clamped twice, what the forces
    scatter about a smooth law stands for the clampings; of fewer than `FEWEST_ROWS` forces, or of a
    clamping that is kept over forces, that is not known either, and the errors are lower
    bounds: attribute `lower_bound` names these modes.
    Records whose plateau is not reached, and rejected ones, are listed and not pooled.
    """
    rows = []
    for found in plateaus:
        attrs = found.attrs
        rows.append(
            {
                "record": str(attrs.get("record", len(rows) + 1)),
                "mode": str(attrs["mode"]),
                "force": value_of(attrs),
                **{name: _text(attrs.get(name, "")) for name in RECORD_TEXTS},
                "verdict": str(found["verdict"].item()),
                **{name: float(found[name]) for name in RECORD_VARIABLES},
            }
        )
    frame = pd.DataFrame(
        rows, columns=["record", "mode", "force", *RECORD_TEXTS, "verdict", *RECORD_VARIABLES]
    )
    used = frame[frame["plateau_reached"] == 1]
    rows = [row for _, of_mode in used.groupby("mode", sort=True) for row in _levels(of_mode)]
    levels = pd.DataFrame(rows, columns=["mode", "force", "group", *LEVEL_VARIABLES])
    result = stick_dataset(frame, levels, load_facts_of(plateaus))
    unknown = ", ".join(_unknown(used, levels[levels["hold_freedom"] == 0]))
    if unknown:
        text = f"; clamping scatter of {unknown} unknown: a lower bound"
        for name in ("frequency_std", "loss_factor_std", "onset_amplitude_std"):
            result[name].attrs["long_name"] += text
            result[name].attrs["lower_bound"] = unknown
    return result


def _unknown(used: pd.DataFrame, once: pd.DataFrame) -> list[str]:
    """Modes of which nothing tells what clampings scatter. once: levels that are clamped once."""
    few = once.groupby(["mode", "group"]).size().groupby("mode").min() < FEWEST_ROWS
    named = used[used["hold"] != ""].groupby(["mode", "hold"])["force"].nunique()
    kept = named.groupby("mode").max().reindex(few.index, fill_value=0) > 1
    return list(few.index[few | kept])


def _levels(records: pd.DataFrame) -> list[dict[str, float | str]]:
    """The levels of one mode: each group and force with what all of its records say of it."""
    records = by_event(records)
    levels, frequency = _pooled(records, "stick_frequency")
    losses = _pooled(records[records["loss_factor"].notna()], "loss_factor")[0]
    onsets = _onsets(records)
    rows = []
    for at, here in records.groupby(["group", "force"], sort=True):
        loss, onset = losses.get(at, _NOT_KNOWN), onsets.get(at, _NOT_KNOWN)
        value, std = (here[f"stick_frequency{end}"].to_numpy(float) for end in ("", "_std"))
        rows.append(
            {
                "mode": here["mode"].iloc[0], "force": at[1], "group": at[0],
                "frequency": levels[at][0], "frequency_std": levels[at][1],
                "within_std": float(np.sqrt((std**2).sum()) / std.size),
                "between_std": float(value.std(ddof=1)) if value.size > 1 else np.nan,
                "between_record_std": frequency.record_std,
                "between_hold_std": frequency.clamping_std,
                "record_freedom": frequency.record_freedom,
                "hold_freedom": frequency.clamping_freedom,
                "direction_difference": _difference(here),
                "mode_direction_difference": frequency.difference,
                "mode_direction_difference_std": frequency.difference_std,
                "loss_factor": loss[0], "loss_factor_std": loss[1],
                "onset_amplitude": onset[0], "onset_amplitude_std": onset[1],
                "records": int(here["seen_by"].sum()), "holds": _units(here).nunique(),
            }
        )  # fmt: skip
    return rows


def by_event(records: pd.DataFrame) -> pd.DataFrame:
    """The records of one mode with those of one event, load and direction as one row each.

    records: rows as of `stick_from_records`. Noise is each sensor's own, so that values are
    averaged by their errors; where they lie further apart than these allow, the error grows (its
    root of chi squared over the degrees of freedom). An amplitude belongs to a sensor: the onset of
    what several saw is not known. `seen_by` is the number of records in a row.
    """
    records = records.assign(seen_by=1)
    several = records[records["event"] != ""]
    rows = [records[records["event"] == ""]]
    for _, seen in several.groupby(["event", "force", "direction"], sort=True):
        rows.append(seen if len(seen) == 1 else _one_motion(seen))
    return pd.concat(rows) if len(rows) > 1 else records


def _one_motion(seen: pd.DataFrame) -> pd.DataFrame:
    """The rows of one event as one row, named as the first."""
    row = seen.iloc[:1].copy()
    for name in _OF_EVENT:
        row[name], row[f"{name}_std"] = _weighted(
            seen[name].to_numpy(float), seen[f"{name}_std"].to_numpy(float)
        )
    for name in RECORD_VARIABLES:
        if name.startswith("onset"):
            row[name] = np.nan
    return row.assign(sensor="", seen_by=len(seen))


def _weighted(value: ndarray, std: ndarray) -> tuple[float, float]:
    """Mean by the errors, and its error; NaN where no value is known."""
    known = np.isfinite(value) & (std > 0.0)
    if not known.any():
        return np.nan, np.nan
    value, weight = value[known], 1.0 / std[known] ** 2
    mean = float(weight @ value / weight.sum())
    apart = float(weight @ (value - mean) ** 2) / max(value.size - 1, 1)
    return mean, float(np.sqrt(max(apart, 1.0) / weight.sum()))


def _pooled(records: pd.DataFrame, name: str) -> tuple[_Levels, Pooled | None]:
    """Mean and error of each group and force, and what was pooled; nothing of no records.

    Where no clamping is repeated, errors hold what the levels scatter about a smooth law, too.
    """
    if not len(records):
        return {}, None
    cells = records.groupby(["group", "force"], sort=True)
    number = cells.ngroup().to_numpy(int)
    found = pool(
        records[name].to_numpy(float),
        records[f"{name}_std"].to_numpy(float),
        number,
        np.unique(_units(records), return_inverse=True)[1],
        records["direction"].map({"up": 1.0, "down": -1.0}).fillna(0.0).to_numpy(float),
    )
    at = [key for key, _ in cells]
    std = found.std.copy()
    if not found.clamping_freedom:
        groups, forces = (np.array(part) for part in zip(*at, strict=True))
        for group in np.unique(groups):
            own = groups == group
            law = scatter_about_law(forces[own], found.mean[own], found.std[own])
            std[own] = np.hypot(std[own], np.nan_to_num(law.rms))
    return dict(zip(at, zip(found.mean, std, strict=True), strict=True)), found


def _difference(records: pd.DataFrame) -> float:
    """Mean of the clampings loaded up less that of those loaded down; NaN without both."""
    means = records.groupby(["direction", _units(records)])["stick_frequency"].mean()
    sides = [means[side].mean() for side in ("up", "down") if side in means.index]
    return float(sides[0] - sides[1]) if len(sides) == 2 else np.nan


def _onsets(records: pd.DataFrame) -> _Levels:
    """Onset and its error at the levels where at least half of the records have one, pooled as ln.

    Where slip begins is known to a part of itself, alike at all forces.
    """
    known = records["onset_amplitude"].notna()
    share = known.groupby([records["group"], records["force"]]).transform("mean")
    seen = records[known & (share >= 0.5)]
    relative = seen["onset_amplitude_std"] / seen["onset_amplitude"]
    log = seen.assign(onset=np.log(seen["onset_amplitude"]), onset_std=relative)
    return {
        at: (np.exp(mean), np.exp(mean) * std)
        for at, (mean, std) in _pooled(log, "onset")[0].items()
    }


def _units(records: pd.DataFrame) -> pd.Series:
    """The clamping of each record; one of its own where none is named."""
    return records["hold"].where(records["hold"] != "", "record " + records["record"])


def _text(value: object) -> str:
    text = "" if value is None else str(value).strip()
    return "" if text.lower() == "nan" else text


def stick_dataset(
    records: pd.DataFrame, levels: pd.DataFrame, load: Mapping[str, str]
) -> xr.Dataset:
    """Levels under plain names; a record's variables of the same name under record_<name>."""
    made = {
        name: _strings(records[name])
        for name in ("record", "hold", "direction", "event", "sensor", "verdict")
    }
    for prefix, frame in (("record_", records), ("", levels)):
        made |= {f"{prefix}{name}": _strings(frame[name]) for name in ("group", "mode")}
        made[f"{prefix}force"] = frame["force"].to_numpy(float)
    made |= {name: _numbers(levels[name]) for name in LEVEL_VARIABLES}
    result = dataset("pooling/stick", made).assign_attrs(load)
    for name in ("record_force", "force"):
        result[name].attrs = load_attrs(load)
    known = registered("plateau/record")
    for name in RECORD_VARIABLES:
        key = f"record_{name}" if name in LEVEL_VARIABLES else name
        result[key] = ("record", _numbers(records[name]), known[name][1])
    return result


def _numbers(column: pd.Series) -> ndarray:
    return column.to_numpy(int if column.name in COUNTS else float)


def _strings(column: pd.Series) -> ndarray:
    return column.astype(str).to_numpy(dtype=str)
