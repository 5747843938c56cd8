"""Figures of the nonlinear joint: curves, loops and slip."""

import numpy as np
import xarray as xr
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from bladeroot.figures import style
from bladeroot.figures.chart import AMPLITUDE, Chart, Panel, Trace
from bladeroot.figures.style import PUBLISHED, force_colours


def curves(one: xr.Dataset, simulated: bool) -> Chart:
    """Fall of the frequency and rise of the loss factor, simulated (lines) over measured (dots)."""
    modes = list(dict.fromkeys(one["point_mode"].values.astype(str)))
    forces = np.unique(one["point_force"].values)
    colours = force_colours(forces.tolist())
    panels, traces = [], []
    for mode in modes:
        for name, scale, label in (
            ("fall", 100.0, "change of frequency / %"),
            ("rise", 1.0, "loss factor by friction"),
        ):
            panels.append(Panel(f"mode {mode}", AMPLITUDE, label, x_log=True))
            for force in forces:
                colour = to_hex(colours.to_rgba(force / 1e3))
                traces += _curve(one, mode, force, name, scale, len(panels) - 1, colour)
    return Chart(
        "Fall of frequency and friction's loss factor over amplitude: measured (dots, bars with "
        "the error allowed for the model) and simulated (lines) at every axial force.",
        panels, traces, colours="axial force", simulated=simulated, warning=_warning(one),
    )  # fmt: skip


def _warning(one: xr.Dataset) -> str:
    """What must stand on a picture of a fit that is of no use."""
    text = f"{one.attrs['structure']}: the fit did NOT converge: not to be used"
    return "" if one.attrs["converged"] else text


def _curve(
    one: xr.Dataset, mode: str, force: float, name: str, scale: float, panel: int, colour: str
) -> list[Trace]:
    own = (one["point_mode"].values.astype(str) == mode) & (one["point_force"].values == force)
    if not own.any():
        return []
    size, at = 1e6 * one["point_amplitude"].values[own], f"{force / 1e3:.4g} kN"
    level = (one["level_mode"].values.astype(str) == mode) & (one["level_force"].values == force)
    line = one[f"map_{name}"].values[np.flatnonzero(level)[0]]
    ladder = 1e6 * one["amplitude"].values
    shown = (ladder > 0.5 * size.min()) & (ladder < 1.5 * size.max())
    return [
        Trace(panel, ladder[shown], scale * line[shown], f"simulated {at}", colour, "-",
              kind="simulated", switches={"axial force": at, "shown": "simulated"}),
        Trace(panel, size, scale * one[name].values[own], f"measured {at}", colour, marker="o",
              size=3.0, error=scale * one[f"{name}_std"].values[own], kind="measured",
              switches={"axial force": at, "shown": "measured"}),
    ]  # fmt: skip


def slip(one: xr.Dataset, simulated: bool) -> Figure:
    """Loops at some amplitudes, and slip of each pair over the four flanks at the largest."""
    sizes = 1e6 * one["picture_amplitude"].values
    drawn, axes = style.panels(1, 1 + len(sizes), 9.2, 3.0, width_ratios=[1.5] + [1.0] * len(sizes))
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
    if _warning(one):
        drawn.supxlabel(_warning(one), fontsize=9, fontweight="bold", color=PUBLISHED)
    return style.note_simulated(drawn, simulated)
