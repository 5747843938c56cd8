"""The thesis's own search drawn as it draws it (figs 5.11 to 5.13)."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bladeroot.figures.style import PUBLISHED, panels

NODES = 33  # of a flank in the thesis's model (6.16)
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
