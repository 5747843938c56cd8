"""Contact theory: traction profiles and stiffness against force (figs 6.4, 6.5, 6.9 to 6.12)."""

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.figure import Figure

from bladeroot.figures.style import (
    PUBLISHED,
    STRUCTURE_COLOURS,
    note_simulated,
    panels,
    plain_log_scale,
)

_STATE_LINES = ("-", "--")
_LABELS = {"kn": "normal stiffness of a flank", "kt": "tangential stiffness of a flank"}


def tractions(theory: xr.Dataset) -> Figure:
    """Pressure and shear across the flank for several ratios T/(mu N) (figs 6.4, 6.5)."""
    drawn, axes = panels(1, 2, 8.0, 3.1, sharex=True)
    ratios = theory["load_ratio"].values
    position = 1e3 * theory["position"].values
    colours = colormaps["viridis"](np.linspace(0, 0.9, len(ratios)))
    for ratio, colour in zip(ratios, colours, strict=True):
        for axis, name in ((axes[0, 0], "pressure"), (axes[0, 1], "shear")):
            value = 1e-6 * theory[name].sel(load_ratio=ratio).values
            axis.plot(position, value, color=colour, label=f"{ratio:.2g}")
    flat = 1e3 * theory.attrs["flat_half_width"]
    for axis, title in ((axes[0, 0], "pressure / MPa"), (axes[0, 1], "shear / MPa")):
        axis.axvspan(-flat, flat, color="#eeeeee", zorder=0, linewidth=0)
        axis.set_xlabel("position across the flank / mm")
        axis.set_ylabel(title)
    axes[0, 1].legend(title="T / (µN)", ncols=2, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return drawn


def compared(theory: xr.Dataset, stiffness: xr.Dataset, simulated: bool) -> Figure:
    """kn and kt of a flank against axial force: theory, identified, published."""
    drawn, axes = panels(1, 2, 8.6, 3.9, sharex=True)
    for axis, name in zip(axes[0], ("kn", "kt"), strict=True):
        for state, line in zip(theory["friction_state"].values, _STATE_LINES, strict=True):
            axis.plot(
                1e-3 * theory["axial_force"],
                1e-9 * theory[f"{name}_of_axial_force"].sel(friction_state=state),
                color="black",
                linestyle=line,
                label=f"theory, {state.replace('mu', 'µ')}",
            )
        if f"{name}_published" in theory:
            published = 1e-9 * theory[f"{name}_published"].values
            axis.errorbar(
                1e-3 * theory["force"].values,
                published,
                published * theory[f"{name}_published_relative_std"].values,
                fmt="D",
                markersize=4,
                markerfacecolor="white",
                color=PUBLISHED,
                capsize=2,
                label="thesis, Table 5.2 × 33",
            )
        for index, structure in enumerate(stiffness["structure"].values):
            found = stiffness.sel(structure=structure)
            if not np.isfinite(found[name]).any():
                axis.plot([], [], " ", label=f"with {structure}: no root at any force")
                continue
            value = 1e-9 * found[name].values
            factor = np.exp(found[f"ln_{name}_std"].values)
            axis.errorbar(
                1e-3 * found["force"].values + 0.15 * (index + 1),
                value,
                [value - value / factor, value * factor - value],
                fmt="o",
                markersize=4,
                color=STRUCTURE_COLOURS[index],
                capsize=2,
                label=f"identified with {structure}",
            )
        plain_log_scale(axis)
        axis.set_xlabel("axial force / kN")
        axis.set_ylabel(f"{_LABELS[name]} / GN/m")
    axes[0, 0].legend(loc="upper left", fontsize=7)
    return note_simulated(drawn, simulated)
