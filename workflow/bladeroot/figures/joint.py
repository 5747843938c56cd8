"""The joint posterior: kn and kt over force, and the two against each other at 12 kN."""

from collections.abc import Sequence

import contourpy
import numpy as np
import xarray as xr
from numpy import ndarray

from bladeroot.figures.chart import Chart, Panel, Trace
from bladeroot.figures.style import PUBLISHED, STRUCTURE_COLOURS

_NAMES = {"kn": "kn of a flank / GN/m", "kt": "kt of a flank / GN/m"}
_MOST_DRAWS = 700  # dots: more only blacken the cloud


def joint(
    found: Sequence[xr.Dataset],
    stiffness: xr.Dataset,
    simulated: bool,
) -> Chart | None:
    """Bands of kn(F) and kt(F), and draws of (kn, kt) at 12 kN with what fixes them.

    found: joint inferences, a row each. stiffness: the search force by force, with Table 5.2. None
    without a posterior.
    """
    full = [one for one in found if one.attrs["law"]]
    if not full:
        return None
    panels, traces = [], []
    for row, one in enumerate(full):
        colour = STRUCTURE_COLOURS[row % len(STRUCTURE_COLOURS)]
        name = one.attrs["structure"]
        for key, label in _NAMES.items():
            panels.append(Panel(f"{name}: {one.attrs['law']}", "axial force / kN", label,
                                y_log=True))  # fmt: skip
            traces += _over_force(len(panels) - 1, one, stiffness, key, colour)
        kn, kt = (1e-9 * one[f"region_{key}"].values for key in _NAMES)
        panels.append(Panel(f"{name}: at {one.attrs['reference_force_N'] / 1e3:g} kN",
                            *_NAMES.values(), x_log=True, y_log=True, x_range=(kn[0], kn[-1]),
                            y_range=(kt[0], kt[-1])))  # fmt: skip
        traces += _plane(len(panels) - 1, one, stiffness, colour)
    return Chart(
        "Left and middle: kn and kt over force; bands contain 68 and 95 % of the joint posterior. "
        "Dots: the root of each force by itself, where there is one. Right: draws of the posterior "
        "at 12 kN with the regions that contain 68 and 95 % of it.",
        panels, traces, columns=3, simulated=simulated,
    )  # fmt: skip


def _over_force(
    panel: int, one: xr.Dataset, stiffness: xr.Dataset, name: str, colour: str
) -> list[Trace]:
    band = 1e-9 * one["curve_quantile"].sel(stiffness=name)
    force = one["curve_force"].values / 1e3
    traces = [
        Trace(panel, force, low=band.sel(quantile=low).values, high=band.sel(quantile=high).values,
              colour=colour, switches={"shown": "joint posterior"})
        for low, high in ((0.025, 0.975), (0.16, 0.84))
    ]  # fmt: skip
    traces.append(
        Trace(panel, force, band.sel(quantile=0.5).values, "median of the joint posterior", colour,
              "-", kind="joint posterior, 68 and 95 %", switches={"shown": "joint posterior"})
    )  # fmt: skip
    here = stiffness.sel(structure=one.attrs["structure"])
    each = here["force"].values / 1e3
    rooted = np.isin(here["status"].values, ("root", "fit"))
    alone = "root of each force by itself"
    traces.append(
        Trace(panel, each[rooted], 1e-9 * here[name].values[rooted], alone, "#000000", marker="o",
              size=3.5, kind=alone, switches={"shown": alone})
    )  # fmt: skip
    if f"published_{name}_total" in here and here[f"published_{name}_total"].notnull().any():
        table = "thesis, Table 5.2 × 33"
        traces.append(
            Trace(panel, each, 1e-9 * here[f"published_{name}_total"].values, table, PUBLISHED,
                  marker="D", error=1e-9 * here[f"published_{name}_total_std"].values, size=3.0,
                  kind=table, switches={"shown": table})
        )  # fmt: skip
    return traces


def _plane(panel: int, one: xr.Dataset, stiffness: xr.Dataset, colour: str) -> list[Trace]:
    draws = 1e-9 * one["reference_draw"].values
    draws = draws[:: -(-len(draws) // _MOST_DRAWS)]
    posterior = {"shown": "joint posterior"}
    traces = [Trace(panel, draws[:, 0], draws[:, 1], "draw", colour, marker="o", size=1.5,
                    opacity=0.35, switches=posterior)]  # fmt: skip
    axes = [1e-9 * one[f"region_{name}"].values for name in _NAMES]
    share = one["region_share"].transpose("region_kt", "region_kn").values
    traces += [
        Trace(panel, *_contour(*axes, share, level), f"{100 * level:.0f} % region", "#000000", line,
              kind=f"{100 * level:.0f} % region", width=0.9, switches=posterior)
        for level, line in ((0.68, "-"), (0.95, "--"))
    ]  # fmt: skip
    at = stiffness["force"].values
    near = int(np.argmin(np.abs(at - one.attrs["reference_force_N"])))
    if "published_kn_total" in stiffness and abs(at[near] - one.attrs["reference_force_N"]) < 1:
        here = {f"{k}{end}": 1e-9 * stiffness[f"published_{k}_total{end}"].values[[near]]
                for k in _NAMES for end in ("", "_std")}  # fmt: skip
        table = "thesis, Table 5.2 × 33"
        traces.append(
            Trace(panel, here["kn"], here["kt"], table, PUBLISHED, marker="D", size=3.0,
                  error=here["kt_std"], x_error=here["kn_std"], switches={"shown": table})
        )  # fmt: skip
    return traces


def _contour(x: ndarray, y: ndarray, z: ndarray, level: float) -> tuple[ndarray, ndarray]:
    """The line on which z has a value, its pieces one after the other with NaN between them."""
    pieces = contourpy.contour_generator(x, y, z).lines(level)
    joined = [np.vstack([piece, [[np.nan, np.nan]]]) for piece in pieces]
    both = np.vstack(joined) if joined else np.zeros((0, 2))
    return both[:, 0], both[:, 1]
