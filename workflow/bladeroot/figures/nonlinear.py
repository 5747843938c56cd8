"""Figures of the nonlinear joint: curves, what they do to kn and kt, loops and slip."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from bladeroot.figures.style import (
    MEASURED,
    PUBLISHED,
    STRUCTURE_COLOURS,
    force_colours,
    note_simulated,
    nothing,
    panels,
    plain_log_scale,
)

_NOTHING = "no curves were used: nothing to simulate"


def curves(found: Sequence[xr.Dataset], simulated: bool) -> Figure:
    """Fall of the frequency and rise of the loss factor, simulated (lines) over measured (dots)."""
    one = next((one for one in found if one.attrs["law"]), None)
    if one is None:
        return nothing(_NOTHING)
    modes = list(dict.fromkeys(one["point_mode"].values.astype(str)))
    drawn, axes = panels(len(modes), 2, 8.4, 2.9 * len(modes))
    colours = force_colours(one["point_force"].values.tolist())
    for row, mode in enumerate(modes):
        for column, (name, scale, label) in enumerate(
            (("fall", 100.0, "change of frequency / %"), ("rise", 1.0, "loss factor by friction"))
        ):
            axis = axes[row, column]
            for force in np.unique(one["point_force"].values):
                _curve(axis, one, mode, force, name, scale, colours)
            _amplitude_axis(axis)
            axis.set_ylabel(label)
            axis.set_title(mode, loc="left")
    drawn.colorbar(colours, ax=axes, label="axial force / kN", shrink=0.7)
    return _noted(drawn, one, simulated)


def _noted(drawn: Figure, one: xr.Dataset, simulated: bool) -> Figure:
    """Say on the figure whether its records are simulated and whether its fit is of any use."""
    if not one.attrs["converged"]:
        text = f"{one.attrs['structure']}: the fit did NOT converge: not to be used"
        drawn.supxlabel(text, fontsize=9, fontweight="bold", color=PUBLISHED)
    return note_simulated(drawn, simulated)


def _curve(
    axis, one: xr.Dataset, mode: str, force: float, name: str, scale: float, colours
) -> None:
    own = (one["point_mode"].values.astype(str) == mode) & (one["point_force"].values == force)
    if not own.any():
        return
    colour = colours.to_rgba(force / 1e3)
    size = 1e6 * one["point_amplitude"].values[own]
    axis.errorbar(
        size, scale * one[name].values[own], scale * one[f"{name}_std"].values[own],
        fmt="o", markersize=3, linewidth=0.7, color=colour,
    )  # fmt: skip
    level = (one["level_mode"].values.astype(str) == mode) & (one["level_force"].values == force)
    line = one[f"map_{name}"].values[np.flatnonzero(level)[0]]
    ladder = 1e6 * one["amplitude"].values
    shown = (ladder > 0.5 * size.min()) & (ladder < 1.5 * size.max())
    axis.plot(ladder[shown], scale * line[shown], color=colour)


def _amplitude_axis(axis) -> None:
    axis.set_xscale("log")
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("amplitude at the laser / µm")


def stiffness(found: Sequence[xr.Dataset], simulated: bool) -> Figure:
    """kn and kt over force with and without curves, and maps of the softening over both."""
    full = [one for one in found if one.attrs["law"]]
    if not full:
        return nothing(_NOTHING)
    one = full[0]
    drawn, axes = panels(2, 2, 8.4, 6.0)
    for column, name in enumerate(("kn", "kt")):
        axis = axes[0, column]
        for offset, key, colour, label in (
            (-0.01, "frequencies_k_quantile", MEASURED, "frequencies alone"),
            (0.01, "k_quantile", STRUCTURE_COLOURS[0], "with curves"),
        ):
            band = 1e-9 * one[key].sel(stiffness=name)
            middle = band.sel(quantile=0.5).values
            reach = [
                middle - band.sel(quantile=0.025).values, band.sel(quantile=0.975).values - middle
            ]  # fmt: skip
            axis.errorbar(
                one["force"].values / 1e3 * (1.0 + offset), middle, reach,
                fmt="o", markersize=3, capsize=2, color=colour, label=label,
            )  # fmt: skip
        axis.set_xlabel("axial force / kN")
        axis.set_ylabel(f"{name} of a flank / GN/m, 95 %")
        plain_log_scale(axis)
    axes[0, 0].legend(loc="best")
    simulable = np.isfinite(one["map_fall"].values).any(axis=1)
    modes = list(dict.fromkeys(one["level_mode"].values.astype(str)[simulable]))[:2]
    for axis in axes[1, len(modes) :]:
        axis.set_axis_off()
    for axis, mode in zip(axes[1], modes, strict=False):
        own = np.flatnonzero(simulable & (one["level_mode"].values.astype(str) == mode))
        own = own[np.argsort(one["level_force"].values[own])]
        drop = -100.0 * one["map_fall"].values[own]
        mesh = axis.pcolormesh(
            1e6 * one["amplitude"].values, one["level_force"].values[own] / 1e3, drop,
            shading="nearest", cmap="magma_r", vmin=0.0, rasterized=False,
        )  # fmt: skip
        measured = one["point_mode"].values.astype(str) == mode
        axis.plot(
            1e6 * one["point_amplitude"].values[measured],
            one["point_force"].values[measured] / 1e3, ".", color="white", markersize=2.5,
        )  # fmt: skip
        _amplitude_axis(axis)
        axis.set_ylabel("axial force / kN")
        axis.set_title(f"{mode}, simulated", loc="left")
        drawn.colorbar(mesh, ax=axis, label="fall of frequency / %")
    return _noted(drawn, one, simulated)


def slip(found: Sequence[xr.Dataset], simulated: bool) -> Figure:
    """Loops at some amplitudes, and slip of each pair over the four flanks at the largest."""
    one = next((one for one in found if one.attrs["law"]), None)
    if one is None:
        return nothing(_NOTHING)
    sizes = 1e6 * one["picture_amplitude"].values
    drawn, axes = panels(1, 1 + len(sizes), 9.2, 3.0, width_ratios=[1.5] + [1.0] * len(sizes))
    for size, motion, force in zip(sizes, one["loop_motion"], one["loop_force"], strict=True):
        axes[0, 0].plot(1e6 * motion, force, label=f"{size:.2g} µm")
    axes[0, 0].set_xlabel("motion at the laser / µm")
    axes[0, 0].set_ylabel("force that slip takes away / N")
    title = f"{one.attrs['picture_mode']}, {one.attrs['picture_force_N'] / 1e3:.2g} kN"
    axes[0, 0].set_title(title, loc="left")
    axes[0, 0].legend(loc="best")
    flank = one["pair_flank"].values == 0
    along = 1e3 * one["pair_along"].values[flank]
    along = along - 0.5 * (along.min(axis=0) + along.max(axis=0))
    for axis, size, share in zip(axes[0, 1:], sizes, one["slip"].values[:, flank], strict=True):
        dots = axis.scatter(
            along[:, 1], along[:, 0], c=share, s=60, marker="s", cmap="magma_r", vmin=0, vmax=1
        )
        axis.set_title(f"{size:.2g} µm", loc="left")
        axis.set_xlabel("along slope / mm")
        axis.margins(x=0.3)
    axes[0, 1].set_ylabel("along Y / mm")
    drawn.colorbar(dots, ax=axes[0, 1:], label="part that slips")
    return _noted(drawn, one, simulated)
