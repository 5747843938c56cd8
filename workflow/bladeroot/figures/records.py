"""What was recorded, and which part of it is the free decay (figs 3.1, 3.2)."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bladeroot.figures.style import MEASURED, PUBLISHED, note_simulated, nothing, panels


def cuts(records: Sequence[xr.Dataset]) -> Figure:
    """Raw records with their cut: velocity over time, the free decay and what is masked."""
    if not records:
        return nothing("no usable record")
    drawn, axes = panels(len(records), 1, 7.2, 1.7 * len(records) + 0.4)
    for axis, record in zip(axes[:, 0], records, strict=True):
        time = record["overview_time"].values
        low, high = 1e3 * record["overview_min"].values, 1e3 * record["overview_max"].values
        decay = (time >= record.attrs["release_s"]) & (time <= record.attrs["end_s"])
        axis.fill_between(time, low, high, color="#b9c3cf", step="mid", label="raw record")
        axis.fill_between(
            time, low, high, where=decay, color=MEASURED, step="mid", label="free decay"
        )
        at = record.attrs["start_s"] + np.arange(record.sizes["time"]) / record.attrs["sampling_Hz"]
        masked = decay & (np.interp(time, at, record["usable"]) < 0.5)
        if masked.any():
            axis.fill_between(
                time, low, high, where=masked, color=PUBLISHED, step="mid", label="masked"
            )
        if masked.any() or axis is axes[0, 0]:
            axis.legend(loc="upper right", ncols=3)
        for edge in ("release_s", "end_s"):
            axis.axvline(record.attrs[edge], color=PUBLISHED, linewidth=0.8, linestyle="--")
        axis.set_ylabel("velocity / mm/s")
        axis.set_title(
            f"{record.attrs['record']}: mode {record.attrs['mode']}, "
            f"{record.attrs['force_N'] / 1e3:.2f} kN",
            loc="left",
        )
        axis.set_xlim(time[0], time[-1])
    axes[-1, 0].set_xlabel("time / s")
    return note_simulated(drawn, any(bool(r.attrs.get("simulated")) for r in records))


def representative(records: Sequence[xr.Dataset]) -> list[xr.Dataset]:
    """For each mode, the usable records of lowest and highest force."""
    chosen = []
    usable = [record for record in records if record.attrs["verdict"] == "usable"]
    for mode in sorted({record.attrs["mode"] for record in usable}):
        of_mode = [record for record in usable if record.attrs["mode"] == mode]
        order = np.argsort([record.attrs["force_N"] for record in of_mode], kind="stable")
        chosen += [of_mode[index] for index in dict.fromkeys((order[0], order[-1]))]
    return chosen
