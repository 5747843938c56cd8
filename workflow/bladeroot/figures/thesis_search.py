"""The thesis's own search drawn as it draws it (figs 5.11 to 5.18)."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bladeroot.figures.style import MEASURED, PUBLISHED, STRUCTURE_COLOURS, panels

NODES = 33
_TO_NODAL = 1e-6 / NODES  # N/m of a flank to kN/mm of a node
_CHOSEN = "#e0b000"
_MODES = {"1B": "#1b3a5c", "2B": "#2a7f62"}


def solution_sets(found: xr.Dataset, published: xr.Dataset) -> Figure:
    """Accepted points of the grid at each force, and that of minimum error (figs 5.11 to 5.13)."""
    count = found.sizes["force"]
    drawn, axes = panels(-(-count // 3), 3, 9.2, 2.8 * -(-count // 3), sharex=True, sharey=True)
    for axis in axes.flat[count:]:
        axis.set_visible(False)
    for f, axis in zip(range(count), axes.flat, strict=False):
        here = found.isel(force=f)
        kn, kt = (_TO_NODAL * here[f"grid_axis_{name}"].values for name in ("kn", "kt"))
        for mode, colour in _MODES.items():
            height = here["grid_frequency"].sel(mode=mode).transpose("grid_axis_kt", "grid_axis_kn")
            lines = axis.contour(kn, kt, height, 7, colors=colour, linewidths=0.5, alpha=0.7)
            axis.clabel(lines, fontsize=5, fmt="%.0f")
            axis.plot([], [], color=colour, linewidth=0.8, label=f"{mode}, Hz")
        i, j = np.nonzero(here["grid_accepted"].transpose("grid_axis_kn", "grid_axis_kt").values)
        axis.plot(kn[i], kt[j], "o", color=PUBLISHED, markersize=2.2, markerfacecolor="none",
                  markeredgewidth=0.5, label="accepted (5.10)")  # fmt: skip
        axis.plot(_TO_NODAL * here["grid_kn"], _TO_NODAL * here["grid_kt"], "o", color=_CHOSEN,
                  markeredgecolor="black", markersize=6, label="minimum error (5.23)")  # fmt: skip
        force = float(here["force"])
        if force in published["force"].values:
            printed = published.sel(force=force)
            axis.plot(_TO_NODAL * printed["kn_total"], _TO_NODAL * printed["kt_total"], "D",
                      color="black", markersize=4, label="Table 5.2")  # fmt: skip
        axis.set_title(f"{force / 1e3:g} kN", loc="left")
        axis.grid(visible=False)
    for axis in axes[-1]:
        axis.set_xlabel("kn of a node / kN/mm")
    for axis in axes[:, 0]:
        axis.set_ylabel("kt of a node / kN/mm")
    axes[0, 0].legend(fontsize=6, loc="upper right")
    return drawn


def over_force(found: Sequence[xr.Dataset], published: xr.Dataset) -> Figure:
    """kn, kt, their relative errors, and frequencies at the chosen points (figs 5.14 to 5.18)."""
    drawn, axes = panels(2, 3, 9.2, 5.4)
    printed_at = published["force"].values / 1e3
    for column, name in enumerate(("kn", "kt")):
        axis = axes[0, column]
        values = 1e-6 * published[f"{name}_nodal"].values
        spread = 1e-6 * published[f"{name}_nodal_std"].values
        axis.errorbar(printed_at, values, spread, fmt="D-", color=PUBLISHED, markersize=3.5,
                      capsize=2, label="Table 5.2")  # fmt: skip
        axes[0, 2].plot(printed_at, 100 * spread / values, "D" + ("-" if name == "kn" else "--"),
                        color=PUBLISHED, markersize=3, label=f"{name}, Table 5.2")  # fmt: skip
        axis.set_ylabel(f"{name} of a node / kN/mm")
    for colour, one in zip(STRUCTURE_COLOURS, found, strict=False):
        if not one["grid_accepted"].any():
            continue
        force, structure = one["force"].values / 1e3, one.attrs["structure"]
        for column, name in enumerate(("kn", "kt")):
            k, spread = (_TO_NODAL * one[f"grid_{name}{end}"].values for end in ("", "_std"))
            axes[0, column].errorbar(force + 0.15 * (1 + column), k, spread, fmt="o-", color=colour,
                                     markersize=3.5, capsize=2, label=structure)  # fmt: skip
            axes[0, 2].plot(force, 100 * spread / k, "o" + ("-" if name == "kn" else "--"),
                            color=colour, markersize=3, label=f"{name}, {structure}")  # fmt: skip
        for column, mode in enumerate(("1B", "2B")):
            axes[1, column].plot(force, one["chosen_frequency"].sel(mode=mode), "o-", color=colour,
                                 markersize=3.5, label=structure)  # fmt: skip
            axes[1, 2].plot(force, one["chosen_frequency"].sel(mode=mode)
                            - one["target_frequency"].sel(mode=mode), "o" + ("-", "--")[column],
                            color=colour, markersize=3, label=f"{mode}, {structure}")  # fmt: skip
    for column, mode in enumerate(("1B", "2B")):
        here = found[0].sel(mode=mode)
        axes[1, column].errorbar(here["force"] / 1e3, here["target_frequency"], here["target_std"],
                                 fmt="s", color=MEASURED, markersize=3,
                                 label="measured")  # fmt: skip
        axes[1, column].set_ylabel(f"{mode} / Hz")
    axes[0, 2].set_ylabel("standard deviation / %")
    axes[1, 2].set_ylabel("chosen less measured / Hz")
    for axis in axes.flat:
        axis.set_xlabel("axial force / kN")
        axis.legend(fontsize=6)
    return drawn
