"""Stick frequencies of a campaign that begins at a table of them."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from numpy import ndarray

from bladeroot.plateau.plateau import RECORD_VARIABLES
from bladeroot.pooling.scatter_of_table import scatter_about_law
from bladeroot.pooling.stick import LEVEL_VARIABLES, RECORD_TEXTS, stick_dataset
from bladeroot.variables import dataset

TABLE_COLUMNS = (
    "mode", "force_N", "frequency_Hz", "frequency_std_Hz", "loss_factor", "loss_factor_std",
)  # fmt: skip


def stick_from_table(
    table: pd.DataFrame, error: str = "stated", load: Mapping[str, str] | None = None
) -> xr.Dataset:
    """Stick frequencies from a table (mode, force_N, frequency_Hz, frequency_std_Hz, ...).

    A table tells nothing of the scatter between records or clampings at one force, but its rows
    scatter about a smooth law of the force. Both are carried, `stated_std` as printed and
    `scatter_std`, which counts both (`bladeroot.pooling.scatter_of_table`), and with them by mode
    how many times the scatter exceeds the printed errors; `error`, stated or scatter, is the one
    that `frequency_std` and `loss_factor_std` go on with. Onset amplitudes are unknown (NaN). The
    numbers are checked where the sheet is read (`bladeroot.io.stick_rows`).

    load: its name and unit, as of `bladeroot.io.load.load_facts`; without, force_N is an axial
    force in newtons.
    """
    frame = table[list(TABLE_COLUMNS)].astype({name: float for name in TABLE_COLUMNS[1:]})
    frame["mode"] = frame["mode"].astype(str)
    frame = frame.sort_values(["mode", "force_N"]).reset_index(drop=True)
    made, ratios = _scatter(frame)
    chosen = {name: made[f"{name}{error}_std"] for name in ("", "loss_factor_")}
    levels = pd.DataFrame(
        {
            "mode": frame["mode"], "force": frame["force_N"], "frequency": frame["frequency_Hz"],
            "frequency_std": chosen[""], "within_std": frame["frequency_std_Hz"],
            "loss_factor": frame["loss_factor"], "loss_factor_std": chosen["loss_factor_"],
            "records": 1, "holds": 1, "record_freedom": 0, "hold_freedom": 0,
        }
    )  # fmt: skip
    empty = pd.DataFrame(
        columns=["record", "mode", "force", *RECORD_TEXTS, "verdict", *RECORD_VARIABLES]
    )
    levels = levels.assign(group="").reindex(columns=["mode", "force", "group", *LEVEL_VARIABLES])
    result = stick_dataset(empty, levels, load or {})
    result["within_std"].attrs["note"] = "as printed in the table; no records to check it with"
    result["frequency_std"].attrs["note"] = f"the table's {error} error"
    result["loss_factor_std"].attrs["note"] = f"the table's {error} error"
    made |= {"table_mode": list(ratios), "quantile": [0.025, 0.5, 0.975]}
    for k, name in enumerate(("scatter_ratio", "loss_factor_scatter_ratio")):
        made[name] = np.array([pair[k] for pair in ratios.values()]).reshape(-1, 3)
    return result.merge(dataset("pooling/stick", made))


def _scatter(frame: pd.DataFrame) -> tuple[dict[str, ndarray], dict[str, list[ndarray]]]:
    """Stated and scattered errors of every row, and each mode's ratio, by quantity."""
    made, ratios = {}, {mode: [] for mode in dict.fromkeys(frame["mode"])}
    for prefix, column, unit in (("", "frequency", "_Hz"), ("loss_factor_", "loss_factor", "")):
        stated = frame[f"{column}_std{unit}"].to_numpy(float)
        whole = np.full(stated.size, np.nan)
        for mode in ratios:
            rows = np.flatnonzero(frame["mode"] == mode)
            found = scatter_about_law(
                frame["force_N"].to_numpy(float)[rows],
                frame[column + unit].to_numpy(float)[rows],
                stated[rows],
            )
            whole[rows] = np.hypot(stated[rows], np.nan_to_num(found.std))
            ratios[mode].append(found.ratio)
        made |= {f"{prefix}stated_std": stated, f"{prefix}scatter_std": whole}
    return made, ratios
