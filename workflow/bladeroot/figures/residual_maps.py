"""What the simulation leaves of the measurement, before and after its causes, side by side."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bladeroot.figures.style import load_axis, note_simulated, nothing, panels, plain_log_scale

_MODES = ("#1b3a5c", "#d08a1d", "#6a51a3", "#4c4c4c")
_DIRECTIONS = {1.0: ("^", "loading"), -1.0: ("v", "unloading"), 0.0: ("o", "direction not known")}
_STAGES = {"before": "simulated as it was", "after": "simulated with the cause"}
_LIMIT = 6.0  # standard deviations at the ends of the colours


def records(found: Sequence[xr.Dataset], simulated: bool) -> Figure:
    """Stick frequencies: what is left in standard deviations, over force, time and clamping."""
    full = [one for one in found if "stick_residual_scaled" in one]
    if not full:
        return nothing("too few stick frequencies for a law of the force")
    rows = [(one, axis) for one in full for axis in _axes_of(one)]
    if not rows:
        return nothing("nothing was varied that the records could be drawn over")
    drawn, axes = panels(len(rows), 2, 9.2, 2.2 * len(rows) + 0.5, sharey="row")
    for row, (one, (name, values)) in enumerate(rows):
        for column, stage in enumerate(_STAGES):
            _scatter(axes[row, column], one, values, stage)
            axes[row, column].set_xlabel(name)
            title = f"{one.attrs['structure']}, {_STAGES[stage]}"
            axes[row, column].set_title(title, loc="left", fontsize=9)
        axes[row, 0].set_ylabel("measured less simulated,\nstandard deviations", fontsize=7.5)
    handles = [
        Line2D([], [], color=colour, marker="s", linestyle="", markersize=5, label=str(mode))
        for mode, colour in zip(full[0]["mode"].values, _MODES, strict=False)
    ]
    known = np.unique(np.concatenate([one["stick_direction"].values for one in full]))
    handles += [
        Line2D([], [], color="#5c6b7a", marker=marker, linestyle="", markersize=5, label=label)
        for sign, (marker, label) in _DIRECTIONS.items()
        if sign in known
    ]
    drawn.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=7.5)
    return note_simulated(drawn, simulated)


def _axes_of(one: xr.Dataset) -> list[tuple[str, np.ndarray]]:
    """What a campaign lets its residuals be drawn over."""
    force, hold, time = (one[f"stick_{name}"].values for name in ("force", "hold", "time"))
    factor, load = load_axis(one.attrs)
    over = [(load, factor * force)] if load else []
    if np.ptp(time) > 0.0:
        over.append(("time since the first record / h", time / 3600.0))
    held = np.unique(hold).size
    if np.unique(force).size < held < hold.size:
        first = [time[hold == h].min() for h in range(held)]
        over.append(("clamping, in order", np.argsort(np.argsort(first, kind="stable"))[hold] + 1))
    return over


def _scatter(axis, one: xr.Dataset, values: np.ndarray, stage: str) -> None:
    left = one["stick_residual_scaled"].sel(stage=stage).values
    mode, sign = one["stick_mode"].values.astype(str), one["stick_direction"].values
    axis.axhspan(-2.0, 2.0, color="#eef1f4", zorder=0)
    axis.axhline(0.0, color="black", linewidth=0.8)
    for name, colour in zip(one["mode"].values.astype(str), _MODES, strict=False):
        for way, (marker, _) in _DIRECTIONS.items():
            mine = (mode == name) & (sign == way)
            axis.plot(values[mine], left[mine], marker, color=colour, markersize=3.5, alpha=0.85)
    axis.set_yscale("symlog", linthresh=3.0)
    ticks = np.array([-100, -30, -10, -3, 0, 3, 10, 30, 100])
    reach = max(3.5, 1.3 * float(np.abs(one["stick_residual_scaled"].values).max()))
    axis.set_yticks(ticks[np.abs(ticks) <= reach], [str(t) for t in ticks[np.abs(ticks) <= reach]])
    axis.minorticks_off()
    axis.set_ylim(-reach, reach)


def curves(found: Sequence[xr.Dataset], simulated: bool) -> Figure:
    """Curves over amplitude: what is left in standard deviations over amplitude and force."""
    one = next((one for one in found if "curve_mode" in one), None)
    if one is None:
        return nothing("no curves over amplitude: the campaign begins at stick frequencies")
    modes = np.unique(one["curve_mode"].values.astype(str))
    rows = [(mode, name) for mode in modes for name in ("curve_frequency", "curve_loss")]
    drawn, axes = panels(len(rows), 2, 9.2, 1.9 * len(rows), sharex="row", sharey=True)
    norm = TwoSlopeNorm(0.0, -_LIMIT, _LIMIT)
    factor, load = load_axis(one.attrs)
    force = one["curve_force"].values
    place = np.unique(force, return_inverse=True)
    for row, (mode, name) in enumerate(rows):
        mine = one["curve_mode"].values == mode
        for column, stage in enumerate(_STAGES):
            axis = axes[row, column]
            left = (one[name] - one[f"{name}_simulated"].sel(stage=stage)) / one[f"{name}_std"]
            axis.scatter(
                1e6 * one["curve_amplitude"].values[mine], place[1][mine], c=left.values[mine],
                cmap="RdBu_r", norm=norm, marker="s", s=34, linewidths=0.2, edgecolors="#5c6b7a",
            )  # fmt: skip
            plain_log_scale(axis, "x")
            names = [f"{factor * f:.3g}" for f in place[0]] if load else [""]
            axis.set_yticks(range(place[0].size), names)
            quantity = "frequency" if name == "curve_frequency" else "loss factor"
            axis.set_title(f"{mode}, {quantity}, {_STAGES[stage]}", loc="left", fontsize=9)
        axes[row, 0].set_ylabel(load.removeprefix("axial "))
    for axis in axes[-1]:
        axis.set_xlabel("amplitude at the sensor / µm")
    drawn.colorbar(
        ScalarMappable(norm, colormaps["RdBu_r"]), ax=axes, shrink=0.5, extend="both",
        label="measured less simulated, standard deviations",
    )  # fmt: skip
    return note_simulated(drawn, simulated)
