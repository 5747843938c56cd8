"""Frequency and damping over amplitude and force together: waterfall and maps (figs 3.11-3.20)."""

import numpy as np
import xarray as xr
from matplotlib import patheffects
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bladeroot.figures.style import (
    COLOURS,
    MEASURED,
    drawn_values,
    force_colours,
    note_simulated,
    nothing,
    panels,
)

AMPLITUDE = "displacement amplitude at the sensor / µm"


def waterfall(curves: xr.Dataset) -> Figure:
    """Mean curves stacked at their axial forces: softening above, loss factor below.

    curves: dims level, amplitude, as from `bladeroot.decay.curves.mean_curves`.
    """
    modes = _modes(curves)
    if not modes:
        return nothing("no usable record")
    drawn, axes = panels(2, len(modes), 4.4 * len(modes), 7.4, sharex="col")
    for column, mode in enumerate(modes):
        here = _of_mode(curves, mode)
        force = here["force"].values / 1e3
        colours = force_colours(here["force"].values)
        gap = np.diff(force).min() if force.size > 1 else 1.0
        frequency = drawn_values(here, "frequency", "change_std")
        softening = 1e2 * (1.0 - frequency / _smallest(here, "frequency")[:, None])
        loss = 1e2 * drawn_values(here, "loss_factor", "change_std")
        x = 1e6 * here["amplitude"].values
        for axis, height in ((axes[0, column], softening), (axes[1, column], loss)):
            highest = np.nanpercentile(height, 99.5)
            scale = 2.2 * gap / highest
            # from the back to the front, each curve over its own base line
            for row in np.argsort(force)[::-1]:
                # what is not known stays a gap
                top = force[row] + scale * height[row]
                base = np.where(np.isfinite(top), force[row], np.nan)
                colour = colours.to_rgba(force[row])
                axis.fill_between(x, base, top, color=colour, alpha=0.25, linewidth=0)
                axis.plot(x, base, color=colour, linewidth=0.4)
                axis.plot(x, top, color=colour, linewidth=1.1)
            _scale_bar(axis, scale, highest)
            axis.set_xscale("log")
            axis.grid(visible=False, axis="y")
        axes[0, column].set_title(f"mode {mode}: softening", loc="left")
        axes[1, column].set_title(f"mode {mode}: loss factor", loc="left")
        axes[1, column].set_xlabel(AMPLITUDE)
    for axis in axes[:, 0]:
        axis.set_ylabel("axial force / kN")
    return note_simulated(drawn, bool(curves.attrs["simulated"]))


def maps(curves: xr.Dataset) -> Figure:
    """f_n(A, F) and eta(A, F) of each mode with several forces, linear between them.

    curves: dims level, amplitude, as from `bladeroot.decay.curves.mean_curves`.
    """
    modes = [mode for mode in _modes(curves) if _of_mode(curves, mode).sizes["level"] > 1]
    if not modes:
        return nothing("one axial force only: there is no map over force")
    drawn, axes = panels(2, len(modes), 4.6 * len(modes), 6.6, sharex="col", sharey=True)
    for column, mode in enumerate(modes):
        here = _of_mode(curves, mode)
        force = here["force"].values / 1e3
        x = 1e6 * here["amplitude"].values
        fine = np.linspace(force.min(), force.max(), 161)
        for axis, name, scale, label in (
            (axes[0, column], "frequency", 1.0, "natural frequency / Hz"),
            (axes[1, column], "loss_factor", 1e2, "loss factor / %"),
        ):
            value = scale * between_forces(force, drawn_values(here, name, "change_std"), fine)
            axis.set_xscale("log")
            axis.set_xlim(x[0], x[-1])
            axis.grid(visible=False)
            axis.plot(
                np.full(force.size, 1.0), force, ">", transform=axis.get_yaxis_transform(),
                color=MEASURED, markersize=4, clip_on=False,
            )  # fmt: skip
            if not np.isfinite(value).any():
                continue
            low, high = np.nanpercentile(value, [0.5, 99.5])
            shown = axis.pcolormesh(
                x, fine, value, vmin=low, vmax=high, cmap=COLOURS, shading="nearest",
                rasterized=True,
            )  # fmt: skip
            lines = axis.contour(
                x, fine, value, levels=MaxNLocator(7).tick_values(low, high), colors="white",
                linewidths=0.6,
            )  # fmt: skip
            edge = [patheffects.withStroke(linewidth=2.0, foreground="#222222")]
            for text in axis.clabel(lines, fontsize=7, fmt="%.4g"):
                text.set_path_effects(edge)
            drawn.colorbar(shown, ax=axis, label=label)
        axes[0, column].set_title(f"mode {mode}", loc="left")
        axes[1, column].set_xlabel(AMPLITUDE)
    for axis in axes[:, 0]:
        axis.set_ylabel("axial force / kN")
    return note_simulated(drawn, bool(curves.attrs["simulated"]))


def between_forces(force: np.ndarray, value: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Values (force, amplitude) at finer forces, only between neighbours that are both known."""
    right = np.clip(np.searchsorted(force, fine), 1, force.size - 1)
    left = right - 1
    part = ((fine - force[left]) / (force[right] - force[left]))[:, None]
    return (1.0 - part) * value[left] + part * value[right]


def _modes(curves: xr.Dataset) -> list[str]:
    return sorted(set(curves["mode"].values.astype(str)))


def _of_mode(curves: xr.Dataset, mode: str) -> xr.Dataset:
    """The mode's levels by rising force, at the amplitudes that they reach."""
    here = curves.isel(level=np.flatnonzero(curves["mode"].values == mode)).sortby("force")
    return here.isel(amplitude=np.flatnonzero((here["records"] > 0).any("level").values))


def _smallest(curves: xr.Dataset, name: str) -> np.ndarray:
    """Mean of each curve over its smallest amplitudes, weighted by its standard errors."""
    found = []
    drawn = drawn_values(curves, name, "change_std")
    for value, std in zip(drawn, curves[f"{name}_change_std"].values, strict=True):
        known = np.flatnonzero(np.isfinite(value))
        known = known[: max(known.size // 4, 1)]
        mean = np.average(value[known], weights=1.0 / std[known] ** 2) if known.size else np.nan
        found.append(mean)
    return np.array(found)


def _scale_bar(axis, scale: float, highest: float) -> None:
    """How much of the curve's quantity one length on the force axis is."""
    size = float(f"{0.5 * highest:.1g}")
    low, high = axis.get_ylim()
    axis.set_ylim(low, high)
    beside, foot = axis.get_yaxis_transform(), low + 0.45 * (high - low)
    axis.plot(
        [1.02, 1.02], [foot, foot + scale * size], transform=beside, color="#444444",
        marker="_", markersize=5, linewidth=1.0, clip_on=False,
    )  # fmt: skip
    axis.text(
        1.05, foot + 0.5 * scale * size, f"{size:g} %", rotation=90, transform=beside,
        va="center", fontsize=8, color="#444444",
    )  # fmt: skip
