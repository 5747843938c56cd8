"""Stick frequency and loss factor against the load (figs 3.13, 3.18, 5.10)."""

import numpy as np
import xarray as xr

from bladeroot.figures.chart import Chart, Panel, Trace
from bladeroot.figures.style import MEASURED, PUBLISHED
from bladeroot.loads import shown

_LEAST_SPAN = 0.01  # of a loss factor, relative: smaller ones have numbers too long for their ticks
_OTHERS = ("#d08a1d", "#6a51a3", "#2a7f62", "#b5462f", "#4c4c4c")


def over_load(stick: xr.Dataset, fe_forces: xr.Dataset | None, simulated: bool) -> Chart | None:
    """Levels, the records that they are the mean of, and the interpolation to the FE forces.

    fe_forces: None where there is no structure, and so no force of a simulation. Without a load the
    levels stand side by side, by group. None where no record reached its plateau.
    """
    modes = [str(mode) for mode in dict.fromkeys(stick["mode"].values)]
    if not modes:
        return None
    factor, unit, load = shown(stick.attrs)
    traces, panels = [], []
    for row, (name, scale, label) in enumerate(
        (("frequency", 1.0, "stick frequency / Hz"), ("loss_factor", 1e2, "loss factor / %"))
    ):
        for column, mode in enumerate(modes):
            here = stick.isel(level=np.flatnonzero(stick["mode"].values == mode))
            groups = here["group"].values.astype(str) if "group" in here else np.array([""])
            kinds = list(dict.fromkeys(groups))
            panel = row * len(modes) + column
            panels.append(
                Panel(f"mode {mode}", f"{load} / {unit}" if load else "", label,
                      x_ticks=() if load else kinds,
                      y_range=_calm(scale * here[name], scale * here[f"{name}_std"])
                      if row else None)
            )  # fmt: skip
            if fe_forces is not None:
                traces.append(_interpolated(fe_forces.sel(mode=mode), name, scale, panel))
            for k, group in enumerate(kinds):
                mine = here.isel(level=np.flatnonzero(groups == group)) if group else here
                colour = (MEASURED, *_OTHERS)[k % 6]
                x = factor * mine["force"].values if load else np.full(mine.sizes["level"], k)
                switches = {"group": group} if len(kinds) > 1 else {}
                traces.append(
                    Trace(panel, x, scale * mine[name].values, name=group or f"mode {mode}",
                          colour=colour, marker="o", error=scale * mine[f"{name}_std"].values,
                          kind="" if len(kinds) > 1 else "measured, ±1 std",
                          switches={"kind": "means", **switches})
                )  # fmt: skip
                if row == 0:
                    traces += _records(stick, mode, group, k, panel, switches)
    return Chart(
        f"Stick frequency and loss factor{f' against {load}' if load else ''}, with one standard "
        "deviation; small and pale: the records"
        + (
            ""
            if fe_forces is None
            else "; squares: their linear interpolation to the simulation's forces with the force "
            "error included (5.13, 5.14)"
        )
        + ".",
        panels,
        traces,
        columns=len(modes),
        colours="group",
        simulated=simulated,
    )


def _calm(values: xr.DataArray, stds: xr.DataArray) -> tuple[float, float] | None:
    """Limits of an axis whose values hardly differ; None where they do."""
    both = np.concatenate([(values - stds).values, values.values, (values + stds).values])
    both = both[np.isfinite(both)]
    if not both.size or np.ptp(both) >= _LEAST_SPAN * abs(both.mean()):
        return None
    middle, half = 0.5 * (both.min() + both.max()), 0.5 * _LEAST_SPAN * abs(both.mean())
    return middle - half, middle + half


def _records(
    stick: xr.Dataset, mode: str, group: str, place: int, panel: int, switches: dict
) -> list[Trace]:
    """Stick frequency of each record of a mode and group."""
    if "stick_frequency" not in stick or not stick.sizes["record"]:
        return []
    mine = (stick["record_mode"].values == mode) & np.isfinite(stick["stick_frequency"].values)
    if "record_group" in stick and group:
        mine &= stick["record_group"].values == group
    here = stick.isel(record=np.flatnonzero(mine))
    factor, _, load = shown(stick.attrs)
    count = here.sizes["record"]
    x = factor * here["record_force"].values if load else np.full(count, place)
    return [
        Trace(panel, x, here["stick_frequency"].values, "record", "#8aa0b8", marker="o", size=2.5,
              opacity=0.6, error=here["stick_frequency_std"].values,
              texts=here["record"].values.astype(str).tolist(),
              switches={"kind": "records", **switches})
    ] if count else []  # fmt: skip


def _interpolated(target: xr.Dataset, name: str, scale: float, panel: int) -> Trace:
    spread = target[f"{name}_std"].sel(force_error=target.attrs["primary_force_error"])
    return Trace(
        panel, target["force"].values / 1e3, scale * target[name].values,
        name="interpolated to the simulation's force", colour=PUBLISHED, marker="s", hollow=True,
        size=6.5, error=scale * spread.values, kind="at the simulation's forces, with force error",
        switches={"kind": "at the simulation's forces"},
    )  # fmt: skip
