"""What was recorded, and which part of it is the free decay (figs 3.1, 3.2)."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bladeroot.figures.style import (
    MEASURED,
    PUBLISHED,
    note_simulated,
    panels,
    title_of_record,
)
from bladeroot.loads import value_of

MOST_BAD = 2  # kinds of rejected records, and records with much masked, that are shown


def cuts(records: Sequence[xr.Dataset]) -> Figure | None:
    """Raw records with their cut: velocity over time, the free decay and what is masked.

    records: as from `worth_showing`.
    """
    if not records:
        return None
    drawn, axes = panels(len(records), 1, 7.2, 2.0 * len(records) + 0.4)
    for axis, record in zip(axes[:, 0], records, strict=True):
        time = record["overview_time"].values
        low, high = 1e3 * record["overview_min"].values, 1e3 * record["overview_max"].values
        decay = (time >= record.attrs["release_s"]) & (time <= record.attrs["end_s"])
        axis.fill_between(time, low, high, color="#b9c3cf", step="mid", label="raw record")
        axis.fill_between(
            time, low, high, where=decay, color=MEASURED, step="mid", label="free decay"
        )
        if _masked(record) > 0.0:
            at = record.attrs["start_s"] + record["time"].values
            masked = decay & (np.interp(time, at, record["usable"]) < 0.5)
            axis.fill_between(
                time, low, high, where=masked, color=PUBLISHED, step="mid", label="masked"
            )
        if _masked(record) > 0.0 or axis is axes[0, 0]:
            axis.legend(loc="upper right", ncols=3)
        for edge in ("release_s", "end_s"):
            axis.axvline(record.attrs[edge], color=PUBLISHED, linewidth=0.8, linestyle="--")
        axis.set_ylabel("velocity / mm/s")
        title_of_record(axis, record.attrs)
        axis.set_xlim(time[0], time[-1])
    axes[-1, 0].set_xlabel("time / s")
    return note_simulated(drawn, any(bool(r.attrs.get("simulated")) for r in records))


def worth_showing(
    records: Sequence[xr.Dataset], decays: Mapping[str, xr.Dataset]
) -> list[xr.Dataset]:
    """Records that stand for the others, then rejected and most masked ones, with their reasons.

    decays: as from `bladeroot.decay.record.estimate`, by record; it may reject what the checks
    of the raw record let pass. Of each mode the usable records of lowest and highest force stand
    for the others; of the rejected ones those that could be read, one for each kind of fault.

    Returns:
        The records, why each is bad in the attribute `reason`.
    """
    told = [one.assign_attrs(_told(one, decays[one.attrs["record"]])) for one in records]
    rejected = [record for record in told if record.attrs["fault"]]
    usable = [record for record in told if not record.attrs["fault"]]
    shown = _representative(usable)
    names = {record.attrs["record"] for record in shown}
    masked = [r for r in usable if _masked(r) > 0.0 and r.attrs["record"] not in names]
    masked.sort(key=_masked, reverse=True)
    one_each = {r.attrs["fault"]: r for r in rejected if r.sizes["bin"]}
    faulty = list(one_each.values())[:MOST_BAD]
    return [*shown, *faulty, *masked[:MOST_BAD]]


def _representative(usable: Sequence[xr.Dataset]) -> list[xr.Dataset]:
    """For each mode, the records of lowest and highest force."""
    chosen = []
    for mode in sorted({record.attrs["mode"] for record in usable}):
        of_mode = [record for record in usable if record.attrs["mode"] == mode]
        order = np.argsort([value_of(record.attrs) for record in of_mode], kind="stable")
        chosen += [of_mode[index] for index in dict.fromkeys((order[0], order[-1]))]
    return chosen


def _masked(record: xr.Dataset) -> float:
    """Share of the free decay that is masked."""
    return 1.0 - float(record["usable"].mean()) if record.sizes["time"] else 0.0


def _told(record: xr.Dataset, decay: xr.Dataset) -> dict[str, str]:
    """Which kind of fault rejects a record (none: empty), and why it is rejected or masked."""
    consequence, text = (record[f"finding_{name}"].values for name in ("consequence", "text"))
    drops = np.flatnonzero(consequence == "drop")
    share = f"{100.0 * _masked(record):.2g} % masked" if _masked(record) > 0.0 else ""
    if drops.size:
        fault, why = str(record["finding_id"].values[drops[0]]), f"rejected: {text[drops[0]]}"
    elif decay.attrs["verdict"] != "usable":
        fault, why = "not followed", f"rejected: {decay.attrs['findings']}"
    else:
        fault, why = "", "; ".join(text[consequence == "mask"]) if share else ""
    return {"fault": fault, "reason": ", ".join(filter(None, (share, why)))}
