"""Stick frequency, loss factor and onset of slip against axial force (figs 3.13, 3.18, 5.10)."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bladeroot.figures.style import MEASURED, PUBLISHED, load_axis, note_simulated, nothing, panels


def over_force(stick: xr.Dataset, fe_forces: xr.Dataset | None, simulated: bool) -> Figure:
    """Stick frequency and loss factor of each mode, with the interpolation to the FE forces.

    fe_forces: None where there is no structure, and so no force of a simulation.
    """
    modes = list(dict.fromkeys(stick["mode"].values))
    factor, load = load_axis(stick.attrs)
    if not modes:
        return note_simulated(nothing("no record reached its stick plateau"), simulated)
    drawn, axes = panels(2, len(modes), 4.2 * len(modes), 5.6, sharex=True if load else "col")
    for column, mode in enumerate(modes):
        levels = stick.isel(level=np.flatnonzero(stick["mode"].values == mode))
        for axis, name, scale in (
            (axes[0, column], "frequency", 1.0),
            (axes[1, column], "loss_factor", 1e2),
        ):
            axis.errorbar(
                factor * levels["force"] if load else np.arange(levels.sizes["level"]),
                scale * levels[name],
                scale * levels[f"{name}_std"],
                fmt="o",
                markersize=3.5,
                color=MEASURED,
                elinewidth=0.8,
                zorder=4,  # on top of the squares, which lie there where the forces coincide
                label="measured, ±1 std",
            )
            if fe_forces is not None:
                _interpolated(axis, fe_forces.sel(mode=mode), name, scale)
        axes[0, column].set_title(f"mode {mode}", loc="left")
        axes[1, column].set_xlabel(load)
        groups = levels["group"].values.astype(str) if "group" in levels else np.array([""])
        if not load:
            axes[1, column].set_xticks(np.arange(groups.size), groups)
        elif np.unique(groups).size > 1:
            for at, value, name in zip(levels["force"], levels["frequency"], groups, strict=True):
                axes[0, column].annotate(name, (factor * float(at), float(value)), fontsize=6)
        axes[1, column].set_ylim(0, 1.12 * axes[1, column].get_ylim()[1])
    axes[0, 0].set_ylabel("stick frequency / Hz")
    axes[1, 0].set_ylabel("loss factor / %")
    axes[0, 0].legend(loc="lower right")
    return note_simulated(drawn, simulated)


def _interpolated(axis: Axes, target: xr.Dataset, name: str, scale: float) -> None:
    spread = target[f"{name}_std"].sel(force_error=target.attrs["primary_force_error"])
    axis.errorbar(
        target["force"] / 1e3,
        scale * target[name],
        scale * spread,
        fmt="s",
        markersize=6.5,
        markerfacecolor="white",
        color=PUBLISHED,
        elinewidth=0.8,
        capsize=2,
        label="at the simulation's forces, with force error",
    )
