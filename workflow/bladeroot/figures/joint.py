"""The joint posterior: kn and kt over force, and the two against each other at 12 kN."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from bladeroot.figures.style import (
    MODE_COLOURS,
    PUBLISHED,
    STRUCTURE_COLOURS,
    note_simulated,
    nothing,
    panels,
    plain_log_scale,
)

_NAMES = {"kn": "kn of a flank / GN/m", "kt": "kt of a flank / GN/m"}


def joint(
    found: Sequence[xr.Dataset],
    searches: Sequence[xr.Dataset],
    stiffness: xr.Dataset,
    simulated: bool,
) -> Figure:
    """Bands of kn(F) and kt(F), and draws of (kn, kt) at 12 kN with what fixes them.

    found: joint inferences, a row each. searches: force by force, whose maps give the lines of the
    measured frequencies. stiffness: these side by side, with Table 5.2.
    """
    full = [one for one in found if one.attrs["law"]]
    if not full:
        return nothing("no stick frequency: no joint posterior")
    drawn, axes = panels(len(full), 3, 9.2, 2.9 * len(full))
    for row, one in enumerate(full):
        colour = STRUCTURE_COLOURS[row % len(STRUCTURE_COLOURS)]
        for column, name in enumerate(_NAMES):
            _over_force(axes[row, column], one, stiffness, name, colour)
        _plane(axes[row, 2], one, searches, stiffness, colour)
        axes[row, 0].set_title(f"{one.attrs['structure']}: {one.attrs['law']}", loc="left")
    axes[0, 0].legend(fontsize=6.5, loc="best")
    axes[0, 2].legend(fontsize=6.5, loc="best")
    return note_simulated(drawn, simulated)


def _over_force(axis, one: xr.Dataset, stiffness: xr.Dataset, name: str, colour: str) -> None:
    band = 1e-9 * one["curve_quantile"].sel(stiffness=name)
    force = one["curve_force"].values / 1e3
    for low, high, alpha in ((0.025, 0.975, 0.15), (0.16, 0.84, 0.3)):
        axis.fill_between(
            force, band.sel(quantile=low), band.sel(quantile=high), color=colour, alpha=alpha,
            linewidth=0, label=f"{100 * (high - low):.0f} % of the joint posterior",
        )  # fmt: skip
    axis.plot(force, band.sel(quantile=0.5), color=colour, label="its median")
    here = stiffness.sel(structure=one.attrs["structure"])
    each = here["force"].values / 1e3
    rooted = np.isin(here["status"].values, ("root", "fit"))
    axis.plot(each[rooted], 1e-9 * here[name].values[rooted], "o", color="black", markersize=3.5,
              label="root of each force by itself")  # fmt: skip
    if f"published_{name}_total" in here and here[f"published_{name}_total"].notnull().any():
        axis.errorbar(
            each, 1e-9 * here[f"published_{name}_total"],
            1e-9 * here[f"published_{name}_total_std"],
            fmt="D", markersize=3, color=PUBLISHED, label="thesis, Table 5.2 × 33",
        )  # fmt: skip
    axis.set_xlabel("axial force / kN")
    axis.set_ylabel(_NAMES[name])
    plain_log_scale(axis)


def _plane(axis, one: xr.Dataset, searches: Sequence[xr.Dataset], stiffness, colour: str) -> None:
    axis.plot(
        *(1e-9 * one["reference_draw"].values.T), ".", color=colour, markersize=1.2, alpha=0.35
    )
    kn, kt = (1e-9 * one[f"region_{name}"].values for name in _NAMES)
    share = one["region_share"].transpose("region_kt", "region_kn").values
    axis.set(xlim=(kn[0], kn[-1]), ylim=(kt[0], kt[-1]), xscale="log")
    for level, style in ((0.68, "-"), (0.95, "--")):
        axis.contour(kn, kt, share, [level], colors="black", linewidths=0.9, linestyles=style)
        axis.plot([], [], style, color="black", linewidth=0.9, label=f"{100 * level:.0f} % region")
    _lines(axis, one, searches)
    at = stiffness["force"].values
    near = int(np.argmin(np.abs(at - one.attrs["reference_force_N"])))
    if "published_kn_total" in stiffness and abs(at[near] - one.attrs["reference_force_N"]) < 1:
        here = stiffness.isel(force=near)
        axis.errorbar(
            1e-9 * float(here["published_kn_total"]), 1e-9 * float(here["published_kt_total"]),
            1e-9 * float(here["published_kt_total_std"]),
            1e-9 * float(here["published_kn_total_std"]),
            fmt="D", markersize=3, color=PUBLISHED, label="Table 5.2 × 33, 12 kN",
        )  # fmt: skip
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    plain_log_scale(axis)
    axis.set_xlabel(_NAMES["kn"])
    axis.set_ylabel(_NAMES["kt"])
    axis.set_title("at 12 kN", loc="left")


def _lines(axis, one: xr.Dataset, searches: Sequence[xr.Dataset]) -> None:
    """Where each mode by itself has its measured frequency, were the model without a bias."""
    reference = one.attrs["reference_force_N"]
    for search in searches:
        here = search.attrs["structure"], search.attrs["axial_force"]
        if here != (one.attrs["structure"], reference):
            continue
        kn, kt = 1e-9 * search["map_kn"].values, 1e-9 * search["map_kt"].values
        for mode, colour in MODE_COLOURS.items():
            of_mode = search.sel(mode=mode)
            target = float(of_mode["target_frequency"] * (1.0 + of_mode["fe_offset"]))
            label = f"{mode} as measured"
            if np.isfinite(target):
                frequency = of_mode["map_frequency"].transpose("map_kt", "map_kn").values
                met = frequency.min() < target < frequency.max()
                label += "" if met else ": nowhere"
                if met:
                    axis.contour(kn, kt, frequency, [target], colors=colour, linewidths=1.3)
                axis.plot([], [], color=colour, linewidth=1.3, label=label)
