"""Stick frequencies of a campaign: per record, and pooled per mode and axial force (3.20, 3.21)."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
import xarray as xr
from numpy import ndarray

from bladeroot.decay.record import RECORD

LEVEL = {
    "frequency": ("Hz", "stick frequency of a mode at a force", "eq. 3.21"),
    "frequency_std": ("Hz", "standard error of frequency: within, records and holds", ""),
    "within_std": ("Hz", "within-record standard error, propagated", "eq. 3.21"),
    "between_std": ("Hz", "standard deviation of the records at this force", ""),
    "hold_std": ("Hz", "standard deviation between holds, pooled over the mode's forces", ""),
    "loss_factor": ("1", "loss factor of a mode at a force", "eq. 3.21"),
    "loss_factor_std": ("1", "standard error of loss_factor: within, records and holds", ""),
    "onset_amplitude": ("m", "displacement amplitude where sticking ends", "sec. 3.5"),
    "onset_amplitude_std": ("m", "standard error of onset_amplitude", ""),
    "records": ("1", "number of records used", ""),
    "holds": ("1", "number of holds (clampings) among them", ""),
}
TABLE_COLUMNS = (
    "mode", "force_N", "frequency_Hz", "frequency_std_Hz", "loss_factor", "loss_factor_std",
)  # fmt: skip


def stick_from_records(plateaus: Sequence[xr.Dataset]) -> xr.Dataset:
    """Stick frequency and damping of every record, and of every mode at every force.

    Each plateau (`bladeroot.decay.record`) carries `mode`, `force_N` and optionally `record`,
    `hold` and `direction` in its attributes. Records at exactly one force are pooled. The unit of
    replication is the hold (one clamping); records without one count as holds of their own. A
    mode's scatter between holds is pooled over its forces and, where any force has two holds, is
    part of every `frequency_std` of that mode; without replicates `frequency_std` is the
    propagated within-record error (3.21). Records whose plateau is not reached, and rejected
    ones, are listed and not pooled.
    """
    rows = []
    for found in plateaus:
        attrs = found.attrs
        rows.append(
            {
                "record": str(attrs.get("record", len(rows) + 1)),
                "mode": str(attrs["mode"]),
                "force": float(attrs["force_N"]),
                "hold": _text(attrs.get("hold", "")),
                "direction": _text(attrs.get("direction", "")),
                "verdict": str(found["verdict"].item()),
                **{name: float(found[name]) for name in RECORD},
            }
        )
    frame = pd.DataFrame(
        rows, columns=["record", "mode", "force", "hold", "direction", "verdict", *RECORD]
    )
    used = frame[frame["plateau_reached"] == 1]
    levels = []
    for mode, of_mode in used.groupby("mode", sort=True):
        frequency = _pooled(of_mode, "stick_frequency")
        loss = _pooled(of_mode[of_mode["loss_factor"].notna()], "loss_factor")
        for force, records in of_mode.groupby("force", sort=True):
            value, std, within, between, hold_std = frequency[force]
            loss_value, loss_std = loss.get(force, (np.nan, np.nan))[:2]
            onset, onset_std = _mean_onset(records)
            levels.append(
                {
                    "mode": mode, "force": force, "frequency": value, "frequency_std": std,
                    "within_std": within, "between_std": between, "hold_std": hold_std,
                    "loss_factor": loss_value, "loss_factor_std": loss_std,
                    "onset_amplitude": onset, "onset_amplitude_std": onset_std,
                    "records": len(records), "holds": _units(records).nunique(),
                }
            )  # fmt: skip
    return _dataset(frame, pd.DataFrame(levels, columns=["mode", "force", *LEVEL]))


def stick_from_table(table: pd.DataFrame) -> xr.Dataset:
    """Stick frequencies from a table (mode, force_N, frequency_Hz, frequency_std_Hz, ...).

    The printed errors are kept as `frequency_std` and `within_std`: a table tells nothing about
    the scatter between records or holds. Onset amplitudes are unknown (NaN).

    Raises:
        ValueError: a column is missing, a number is not positive, or a mode has a force twice.
    """
    missing = [name for name in TABLE_COLUMNS if name not in table.columns]
    if missing:
        raise ValueError(
            f"expected columns {', '.join(TABLE_COLUMNS)}, {', '.join(missing)} missing, got "
            f"{', '.join(map(str, table.columns))}"
        )
    frame = pd.DataFrame({"mode": table["mode"].astype(str)})
    for name in TABLE_COLUMNS[1:]:
        frame[name] = pd.to_numeric(table[name], errors="coerce")
        bad = np.flatnonzero(~(frame[name] > 0.0))
        if bad.size:
            raise ValueError(
                f"{name} must be a positive number, got {table[name].iloc[bad[0]]} "
                f"(row {bad[0] + 2})"
            )
    twice = frame[frame.duplicated(["mode", "force_N"])]
    if len(twice):
        raise ValueError(
            f"each force must appear once a mode, got {twice['mode'].iloc[0]} at "
            f"{twice['force_N'].iloc[0]:g} N again (row {twice.index[0] + 2})"
        )
    levels = pd.DataFrame(
        {
            "mode": frame["mode"], "force": frame["force_N"], "frequency": frame["frequency_Hz"],
            "frequency_std": frame["frequency_std_Hz"], "within_std": frame["frequency_std_Hz"],
            "loss_factor": frame["loss_factor"], "loss_factor_std": frame["loss_factor_std"],
            "records": 1, "holds": 1,
        }
    )  # fmt: skip
    levels = levels.reindex(columns=["mode", "force", *LEVEL]).sort_values(["mode", "force"])
    empty = pd.DataFrame(
        columns=["record", "mode", "force", "hold", "direction", "verdict", *RECORD]
    )
    result = _dataset(empty, levels)
    result["within_std"].attrs["note"] = "as printed in the table; no records to check it with"
    result["frequency_std"].attrs["note"] = "the table's own error"
    return result


def _pooled(
    records: pd.DataFrame, name: str
) -> dict[float, tuple[float, float, float, float, float]]:
    """By force: mean of hold means, its error, within-record and between-record std, hold std.

    The variance between holds is that of the hold means about their force's mean, pooled over
    the forces, less what the records themselves explain of it.
    """
    squares, freedom, explained = 0.0, 0, []
    found = {}
    for force, group in records.groupby("force"):
        value, std = group[name].to_numpy(float), group[f"{name}_std"].to_numpy(float)
        means, variances = [], []
        for _, hold in group.groupby(_units(group)):
            inside, own = hold[name].to_numpy(float), hold[f"{name}_std"].to_numpy(float)
            means.append(inside.mean())
            scatter = inside.var(ddof=1) if inside.size > 1 else 0.0
            variances.append(max((own**2).mean(), scatter) / inside.size)
        means, variances = np.array(means), np.array(variances)
        if means.size > 1:
            squares += ((means - means.mean()) ** 2).sum()
            freedom += means.size - 1
            explained.append(variances.mean() * (means.size - 1))
        within = float(np.sqrt((std**2).sum()) / std.size)
        between = float(value.std(ddof=1)) if value.size > 1 else np.nan
        found[float(force)] = (means, variances, within, between)
    hold_variance = max(0.0, (squares - sum(explained)) / freedom) if freedom else 0.0
    hold_std = float(np.sqrt(hold_variance)) if freedom else np.nan
    return {
        force: (
            float(means.mean()),
            float(np.sqrt((hold_variance + variances.mean()) / means.size)),
            within,
            between,
            hold_std,
        )
        for force, (means, variances, within, between) in found.items()
    }


def _mean_onset(records: pd.DataFrame) -> tuple[float, float]:
    """Mean onset of the records, and its error, where at least half of them have one."""
    seen = records[records["onset_amplitude"].notna()]
    if 2 * len(seen) < len(records) or not len(seen):
        return np.nan, np.nan
    onset = seen["onset_amplitude"].to_numpy(float)
    own = float((seen["onset_amplitude_std"].to_numpy(float) ** 2).mean())
    scatter = float(onset.var(ddof=1)) if onset.size > 1 else 0.0
    return float(onset.mean()), float(np.sqrt(max(own, scatter) / onset.size))


def _units(records: pd.DataFrame) -> pd.Series:
    """The hold of each record; one of its own where none is named."""
    return records["hold"].where(records["hold"] != "", "record " + records["record"])


def _text(value: object) -> str:
    text = "" if value is None else str(value).strip()
    return "" if text.lower() == "nan" else text


def _dataset(records: pd.DataFrame, levels: pd.DataFrame) -> xr.Dataset:
    """Levels under plain names; a record's variables of the same name under record_<name>."""
    result = xr.Dataset(coords={"record": _strings(records["record"])})
    for name in ("hold", "direction", "verdict"):
        result[name] = ("record", _strings(records[name]), {"units": "", "long_name": name})
    for dim, frame, table in (("record", records, RECORD), ("level", levels, LEVEL)):
        names = {name: f"record_{name}" if dim == "record" else name for name in ("mode", "force")}
        result[names["mode"]] = (
            dim, _strings(frame["mode"]), {"units": "", "long_name": "name of the mode"}
        )  # fmt: skip
        result[names["force"]] = (
            dim, frame["force"].to_numpy(float), {"units": "N", "long_name": "axial force"}
        )  # fmt: skip
        for name, (units, long_name, source) in table.items():
            key = f"record_{name}" if dim == "record" and name in LEVEL else name
            kind = int if name in ("plateau_reached", "records", "holds") else float
            attrs = {"units": units, "long_name": long_name}
            values = frame[name].to_numpy(kind)
            result[key] = (dim, values, attrs | {"source": source} if source else attrs)
    return result


def _strings(column: pd.Series) -> ndarray:
    return column.astype(str).to_numpy(dtype=str)
