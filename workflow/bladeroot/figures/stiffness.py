"""The search for kn, kt: where each mode's measured frequency lies on its map (figs 5.11, 5.12)."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bladeroot.figures.style import MODE_COLOURS, PUBLISHED, note_simulated, panels


def maps(searches: Sequence[xr.Dataset], published: xr.Dataset | None, simulated: bool) -> Figure:
    """Lines of constant frequency through the measured ones, and the root where they cross.

    A row a structure, its lowest and its highest force. Bands: plus and minus one standard
    deviation of measurement and model bias. `published`: Table 5.2 with totals of a flank, if any.
    """
    shown = _ends(searches)
    drawn, axes = panels(len(shown), 2, 7.6, 3.6 * len(shown), sharex=True, sharey=True)
    for axis, found in zip(axes.flat, [found for pair in shown for found in pair], strict=True):
        _map(axis, found, published)
        axis.set_title(
            f"{found.attrs['structure']}, {found.attrs['axial_force'] / 1e3:g} kN: "
            f"{found['status'].item()}",
            loc="left",
            fontsize=8.5,
        )
    for axis in axes[-1]:
        axis.set_xlabel("kn of a flank / GN/m")
    for axis in axes[:, 0]:
        axis.set_ylabel("kt of a flank / GN/m")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=7)
    return note_simulated(drawn, simulated)


def _ends(searches: Sequence[xr.Dataset]) -> list[tuple[xr.Dataset, xr.Dataset]]:
    """The searches at the lowest and the highest force of each structure."""
    of_structure: dict[str, list[xr.Dataset]] = {}
    for found in searches:
        of_structure.setdefault(found.attrs["structure"], []).append(found)
    ordered = [sorted(line, key=lambda s: s.attrs["axial_force"]) for line in of_structure.values()]
    return [(line[0], line[-1]) for line in ordered]


def _map(axis, found: xr.Dataset, published: xr.Dataset | None) -> None:
    kn, kt = 1e-9 * found["map_kn"].values, 1e-9 * found["map_kt"].values
    axis.set_xscale("log")
    axis.set_yscale("log")
    for mode, colour in MODE_COLOURS.items():
        here = found.sel(mode=mode)
        frequency = here["map_frequency"].transpose("map_kt", "map_kn").values
        lines = axis.contour(kn, kt, frequency, 9, colors=colour, linewidths=0.35, alpha=0.6)
        axis.clabel(lines, fontsize=5.5, fmt="%.0f")
        target = float(here["target_frequency"])
        spread = float(np.hypot(here["target_std"], here["fe_bias_std"] * target))
        if not np.isfinite(target):
            continue
        axis.contourf(
            kn, kt, frequency, [target - spread, target + spread], colors=colour, alpha=0.18
        )
        axis.contour(kn, kt, frequency, [target], colors=colour, linewidths=1.6)
        axis.plot([], [], color=colour, label=f"{mode} measured, ±1 std with model bias")
    axis.plot(1e-9 * found["root_kn"], 1e-9 * found["root_kt"], "o", color="black", markersize=4)
    axis.set_xlim(kn[0], kn[-1])
    axis.set_ylim(kt[0], kt[-1])
    force = found.attrs["axial_force"]
    if published is not None and force in published["force"].values:
        printed = published.sel(force=force)
        axis.errorbar(
            1e-9 * printed["kn_total"],
            1e-9 * printed["kt_total"],
            1e-9 * printed["kt_total_std"],
            1e-9 * printed["kn_total_std"],
            fmt="D",
            markersize=3.5,
            color=PUBLISHED,
            label="thesis, Table 5.2 × 33",
        )
    axis.grid(visible=False)
