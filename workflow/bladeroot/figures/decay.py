"""Frequency and damping against amplitude (figs 3.11, 3.12, 3.17)."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.figure import Figure

from bladeroot.figures.style import (
    drawn_values,
    force_colours,
    load_axis,
    note_simulated,
    nothing,
    panels,
    plain_log_scale,
)
from bladeroot.loads import value_of

# Curves of a mode that are drawn: more hide each other, and each makes the page 30 kB larger.
MOST = 100


def backbones(decays: Sequence[xr.Dataset]) -> Figure:
    """f_n(A) above, loss factor(A) below, a column a mode, a curve a record, coloured by force.

    Where all have one load, by group and sensor, hold or record, whichever first tells them apart.
    Of more than `MOST` records of a mode so many are drawn, evenly over their loads; the title
    says so.
    """
    decays = [decay for decay in decays if decay.sizes["point"]]
    if not decays:
        return nothing("no usable record")
    modes = sorted({decay.attrs["mode"] for decay in decays})
    factor, load = load_axis(decays[0].attrs)
    forces = force_colours([value_of(decay.attrs) for decay in decays], factor)
    several = len({value_of(decay.attrs) for decay in decays}) > 1
    drawn, axes = panels(2, len(modes), 4.4 * len(modes) + 0.6, 6.2, sharex="col")
    for column, mode in enumerate(modes):
        above, below = axes[:, column]
        here = [decay for decay in decays if decay.attrs["mode"] == mode]
        count = len(here)
        here = _spread(here)
        names = _names(here)
        kinds = list(dict.fromkeys(names))
        for decay, name in zip(here, names, strict=True):
            one = colormaps["turbo"]((kinds.index(name) + 0.5) / len(kinds))
            colour = forces.to_rgba(factor * value_of(decay.attrs)) if several else one
            amplitude = 1e6 * decay["amplitude"].values
            for axis, quantity, scale in ((above, "frequency", 1.0), (below, "loss_factor", 1e2)):
                value = scale * drawn_values(decay, quantity)
                spread = scale * decay[f"{quantity}_std"].values
                axis.plot(amplitude, value, color=colour, linewidth=0.9)
                axis.fill_between(
                    amplitude, value - spread, value + spread, color=colour, alpha=0.2, linewidth=0
                )
        part = f", {len(here)} of {count} records" if len(here) < count else ""
        above.set_title(f"mode {mode}{part}", loc="left")
        above.set_xscale("log")
        for axis, quantity, scale in ((above, "frequency", 1.0), (below, "loss_factor", 1e2)):
            axis.set_ylim(*_limits(here, quantity, scale))
        plain_log_scale(below)
        below.set_xlabel("displacement amplitude at the sensor / µm")
        if not several:
            lines = dict(zip(names, above.lines, strict=True))
            columns = 1 + len(lines) // 8
            above.legend(lines.values(), lines.keys(), fontsize=6, ncols=columns, loc="lower left")
    axes[0, 0].set_ylabel("natural frequency / Hz")
    axes[1, 0].set_ylabel("loss factor / %")
    if several:
        drawn.colorbar(forces, ax=axes[:, -1], label=load, aspect=40)
    return note_simulated(drawn, any(bool(d.attrs.get("simulated")) for d in decays))


def _spread(decays: Sequence[xr.Dataset]) -> list[xr.Dataset]:
    """At most `MOST` of the records, evenly over their loads."""
    if len(decays) <= MOST:
        return list(decays)
    order = np.argsort([value_of(decay.attrs) for decay in decays], kind="stable")
    kept = order[np.arange(MOST) * (len(decays) - 1) // (MOST - 1)]
    return [decays[k] for k in sorted(kept)]


def _names(decays: Sequence[xr.Dataset]) -> list[str]:
    """Group and sensor of each record, else its hold, or itself where there is one hold only."""
    kinds = [
        ", ".join(filter(None, (str(d.attrs.get(name, "")) for name in ("group", "sensor"))))
        for d in decays
    ]
    holds = [str(decay.attrs["hold"]) for decay in decays]
    for names in (kinds, holds):
        if len(set(names)) > 1:
            return names
    return [str(decay.attrs["record"]) for decay in decays]


def _limits(decays: Sequence[xr.Dataset], name: str, scale: float) -> tuple[float, float]:
    """Axis limits that the last, lost points of a few curves cannot stretch."""
    values = scale * np.concatenate([drawn_values(decay, name) for decay in decays])
    values = values[values > 0.0]  # a logarithmic axis has no place for an amplitude that grows
    low, high = np.percentile(values, [0.1, 99.9]) if values.size else (1.0, 2.0)
    if name == "loss_factor":
        return 0.6 * low, 1.6 * high
    margin = 0.08 * (high - low) + 1e-3 * high
    return low - margin, high + margin
