"""Frequency and damping over amplitude and force together: waterfall and maps (figs 3.11-3.20)."""

import numpy as np
import xarray as xr
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bladeroot.figures.style import (
    COLOURS,
    MEASURED,
    drawn_values,
    force_colours,
    load_axis,
    note_simulated,
    nothing,
    panels,
)

AMPLITUDE = "displacement amplitude at the sensor / µm"


def waterfall(curves: xr.Dataset) -> Figure:
    """Mean curves, each on the base line of its axial force: softening above, loss factor below.

    curves: dims level, amplitude, as from `bladeroot.decay.curves.mean_curves`.
    """
    modes = _modes(curves)
    if not modes:
        return nothing("no usable record")
    drawn, axes = panels(2, len(modes), 4.6 * len(modes), 7.4, sharex="col")
    for column, mode in enumerate(modes):
        here = _of_mode(curves, mode)
        _stacked(axes[0, column], here, "frequency", _smallest(here)[:, None])
        _stacked(axes[1, column], here, "loss_factor")
        axes[0, column].set_title(f"mode {mode}: softening", loc="left")
        axes[1, column].set_title(f"mode {mode}: loss factor", loc="left")
        axes[1, column].set_xlabel(AMPLITUDE)
    load = load_axis(curves.attrs)[1]
    for axis in axes[:, 0]:
        axis.set_ylabel(load.replace(" /", " of each base line /"))
    return note_simulated(drawn, bool(curves.attrs["simulated"]))


def maps(curves: xr.Dataset) -> Figure:
    """f_n(A, F) and eta(A, F) of each mode with several forces, linear between them.

    curves: dims level, amplitude, as from `bladeroot.decay.curves.mean_curves`.
    """
    factor, load = load_axis(curves.attrs)
    kinds = {mode: _most_loads(_of_mode(curves, mode)) for mode in _modes(curves)}
    modes = [mode for mode, here in kinds.items() if here.sizes["level"] > 1]
    if not modes:
        name = load.partition(" /")[0]
        return nothing(f"one {name or 'condition'} only: there is no map over {name or 'load'}")
    drawn, axes = panels(2, len(modes), 4.6 * len(modes), 6.6, sharex="col", sharey=True)
    for column, mode in enumerate(modes):
        here = kinds[mode]
        force = factor * here["force"].values
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
        axes[0, column].set_title(", ".join([f"mode {mode}", *_kind(here, 0)]), loc="left")
        axes[1, column].set_xlabel(AMPLITUDE)
    for axis in axes[:, 0]:
        axis.set_ylabel(load)
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


def _kind(curves: xr.Dataset, row: int) -> list[str]:
    """Group and sensor of a level, as far as they are named."""
    names = (str(curves[name].values[row]) for name in ("group", "sensor") if name in curves)
    return [name for name in names if name]


def _most_loads(curves: xr.Dataset) -> xr.Dataset:
    """The levels of one group and sensor, that of most loads: others are not in between them."""
    kinds = [tuple(_kind(curves, row)) for row in range(curves.sizes["level"])]
    most = max(sorted(set(kinds)), key=kinds.count, default=())
    return curves.isel(level=[k for k, kind in enumerate(kinds) if kind == most])


def _stacked(
    axis: Axes, curves: xr.Dataset, name: str, softening_from: np.ndarray | None = None
) -> None:
    """A mode's curves in percent over evenly spaced base lines, from the back to the front.

    softening_from: values from which the relative fall is drawn, in place of the value itself.
    """
    error = 1e2 * curves[f"{name}_change_std"].values
    scatter = 1e2 * curves[f"{name}_scatter"].values
    height = 1e2 * drawn_values(curves, name, "change_std")
    if softening_from is not None:
        height = 1e2 - height / softening_from
        error, scatter = error / softening_from, scatter / softening_from
    highest = np.nanpercentile(np.abs(height), 99.5) if np.isfinite(height).any() else 1.0
    scale = 0.9 / highest
    x, force = 1e6 * curves["amplitude"].values, curves["force"].values
    factor, load = load_axis(curves.attrs)
    colours = force_colours(force.tolist(), factor)
    for row in range(force.size)[::-1]:
        # what is not known stays a gap
        top = row + scale * height[row]
        base = np.where(np.isfinite(top), float(row), np.nan)
        several = np.where(curves["records"].values[row] > 1, top, np.nan)
        colour = colours.to_rgba(factor * force[row])
        axis.fill_between(x, base, top, color=colour, alpha=0.2, linewidth=0)
        spread = scale * error[row]
        axis.fill_between(x, top - spread, top + spread, color=colour, alpha=0.4, linewidth=0)
        axis.plot(x, base, color=colour, linewidth=0.4)
        axis.plot(x, top, color=colour, linewidth=0.5)
        axis.plot(x, several, color=colour, linewidth=1.3)
        if np.isfinite(scatter[row]).any():
            between = np.nanmedian(scatter[row])
            axis.text(
                1.01, row, f"±{between:.2g} %" if between > 1e-3 else "<0.001 %", fontsize=7,
                color="#444444", transform=axis.get_yaxis_transform(), va="center",
            )  # fmt: skip
    axis.set_xscale("log")
    names = [
        ", ".join(([f"{factor * value:.4g}"] if load else []) + _kind(curves, row))
        for row, value in enumerate(force)
    ]
    axis.set_yticks(range(force.size), names)
    axis.grid(visible=False, axis="y")
    _scale_bar(axis, force.size - 0.75, scale, highest)


def _smallest(curves: xr.Dataset) -> np.ndarray:
    """Mean frequency of each level over its smallest amplitudes, weighted by standard errors."""
    found = []
    drawn = drawn_values(curves, "frequency", "change_std")
    for value, std in zip(drawn, curves["frequency_change_std"].values, strict=True):
        known = np.flatnonzero(np.isfinite(value))
        known = known[: max(known.size // 4, 1)]
        mean = np.average(value[known], weights=1.0 / std[known] ** 2) if known.size else np.nan
        found.append(mean)
    return np.array(found)


def _scale_bar(axis: Axes, foot: float, scale: float, highest: float) -> None:
    """How many percent one length between the base lines is."""
    size = float(f"{0.5 * highest:.1g}")
    beside = axis.get_yaxis_transform()
    axis.plot(
        [1.03, 1.03], [foot, foot + scale * size], transform=beside, color="#444444",
        marker="_", markersize=5, linewidth=1.0, clip_on=False,
    )  # fmt: skip
    axis.text(
        1.05, foot + 0.5 * scale * size, f"{size:g} %", transform=beside, va="center",
        fontsize=8, color="#444444",
    )  # fmt: skip
