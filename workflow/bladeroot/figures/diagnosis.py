"""The diagnosis drawn: ranking of causes, and measured against simulated before and after them."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from bladeroot.figures.style import (
    MEASURED,
    STRUCTURE_COLOURS,
    force_colours,
    load_axis,
    note_simulated,
    nothing,
    panels,
    plain,
    plain_log_scale,
)

BEFORE, AFTER = "#b5462f", "#2a7f62"
PALE = "#c9d1d8"
CHANNELS = {
    "stick": "stick frequencies",
    "damping": "loss factors of the stuck joint",
    "curve": "curves over amplitude",
    "record": "findings in the records",
}
_SHOWN = 7  # candidates a panel
_NAMED, _CREDIBLE, _BARRED, _OTHER = "named", "explains it about as well", "not judged", "other"
_FILL = {_NAMED: AFTER, _CREDIBLE: "#8cc3ae", _BARRED: "#e3b27a", _OTHER: PALE}


def ranking(found: Sequence[xr.Dataset], verdicts: Sequence[Mapping], simulated: bool) -> Figure:
    """Evidence of every candidate over the simulation as it is, a panel a structure and data.

    found, verdicts: of each structure. What a panel shows besides mechanisms: any smooth function.
    """
    wanted = []
    for k, (one, said) in enumerate(zip(found, verdicts, strict=True)):
        for channel in CHANNELS:
            mine = one["channel"].values == channel
            evidence = one["log_evidence"].values[mine]
            # what does not depend on the structure is shown once
            if mine.any() and evidence.max() > 0.0 and (channel == "stick" or k == 0):
                wanted.append((one, said, channel))
    if not wanted:
        return nothing("nothing explains the records better than the simulation as it is")
    rows = (len(wanted) + 1) // 2
    drawn, axes = panels(rows, min(2, len(wanted)), 9.2, 0.5 + 2.5 * rows)
    for axis, (one, said, channel) in zip(axes.flat, wanted, strict=False):
        _ranks(axis, one, said, channel)
    for axis in axes.flat[len(wanted) :]:
        axis.set_axis_off()
    shown = [Patch(color=colour, label=name) for name, colour in _FILL.items()]
    shown.append(Patch(facecolor="white", edgecolor="#5c6b7a", hatch="///", label="any smooth law"))
    drawn.legend(handles=shown, loc="outside lower center", ncols=5, fontsize=7.5)
    return note_simulated(drawn, simulated)


def _ranks(axis, one: xr.Dataset, said: Mapping, channel: str) -> None:
    here = one.isel(candidate=np.flatnonzero(one["channel"].values == channel)[:_SHOWN][::-1])
    named = set(str(one.attrs.get("named", "")).split(";"))
    credible = {n for c in said["causes"] if c["mechanism"] in named for n in c["credible_set"]}
    evidence = here["log_evidence"].values
    for y, name in enumerate(here["candidate"].values.astype(str)):
        row = here.isel(candidate=y)
        if str(row["class"].values) == "smooth":
            axis.barh(y, evidence[y], color="white", edgecolor="#5c6b7a", hatch="///", height=0.7)
        else:
            axis.barh(y, evidence[y], color=_FILL[_kind(row, name, credible)], height=0.7)
        axis.annotate(
            f"{evidence[y]:z.1f}", (max(evidence[y], 0.0), y), (3, 0), textcoords="offset points",
            va="center", fontsize=7,
        )  # fmt: skip
    names = [
        n.replace("smooth in", "anything smooth in").replace("-", " ")
        for n in here["candidate"].values
    ]
    axis.set_ylim(len(names) - max(len(names), 4) - 0.6, len(names) - 0.4)
    axis.set_yticks(range(len(names)), list(map(plain, names)), fontsize=7.5)
    top = max(evidence.max(), 1.0)
    axis.set_xlim(min(max(evidence.min(), -0.25 * top), 0.0), 1.17 * top)
    axis.grid(axis="y", visible=False)
    axis.axvline(0.0, color="black", linewidth=0.8)
    axis.set_xlabel("log evidence")
    where = f"{one.attrs['structure']}: " if channel == "stick" else ""
    axis.set_title(f"{where}{CHANNELS[channel]}", loc="left")


def _kind(row: xr.Dataset, name: str, credible: set[str]) -> str:
    if int(row["is_named"]):
        return _NAMED
    if name in credible:
        return _CREDIBLE
    return _BARRED if str(row["barred"].values) else _OTHER


def frequencies(found: Sequence[xr.Dataset], simulated: bool) -> Figure:
    """Stick frequency over force, measured and simulated before and after, and what is left."""
    full = [one for one in found if "stick_residual" in one]
    if not full:
        return nothing("too few stick frequencies for a law of the load")
    factor, load = load_axis(full[0].attrs)
    if not load:
        return nothing("one condition: there is no law over a load")
    modes = [str(m) for m in full[0]["mode"].values]
    drawn, axes = panels(
        2 * len(full), len(modes), 9.2, 4.4 * len(full), sharex="col",
        height_ratios=[1.35, 1.0] * len(full),
    )  # fmt: skip
    for k, one in enumerate(full):
        for column, mode in enumerate(modes):
            _frequency(axes[2 * k, column], axes[2 * k + 1, column], one, mode, factor)
            axes[2 * k, column].set_title(f"{one.attrs['structure']}, {mode}", loc="left")
        axes[2 * k, 0].set_ylabel("stick frequency / Hz")
        axes[2 * k + 1, 0].set_ylabel("measured less\nsimulated / %")
    for axis in axes[-1]:
        axis.set_xlabel(load)
    axes[0, 0].legend(fontsize=7)
    return note_simulated(drawn, simulated)


def _frequency(above, below, one: xr.Dataset, mode: str, factor: float) -> None:
    here = one.isel(stick_record=one["stick_mode"].values == mode)
    force = factor * here["stick_force"].values
    every = np.unique(force)
    changed = bool(one.attrs["named"])
    for stage, colour, style in (("before", BEFORE, "--"), ("after", AFTER, "-")):
        if stage == "after" and not changed:
            continue
        said = here["stick_simulated"].sel(stage=stage).values
        mean = [said[force == f].mean() for f in every]
        name = "simulated as it was" if stage == "before" else "simulated with the cause"
        above.plot(every, mean, style, color=colour, label=name)
        left = 100.0 * here["stick_residual"].sel(stage=stage).values
        below.plot(force, left, "o", color=colour, markersize=3.5,
                   markerfacecolor="white" if stage == "before" else colour)  # fmt: skip
        below.plot(every, [left[force == f].mean() for f in every], style, color=colour,
                   linewidth=0.8)  # fmt: skip
    above.plot(force, here["stick_frequency"], "o", color=MEASURED, markersize=3, label="measured")
    below.axhline(0.0, color="black", linewidth=0.8)


def curves(found: Sequence[xr.Dataset], simulated: bool) -> Figure:
    """Frequency and loss factor over amplitude, measured and simulated before and after."""
    one = next((one for one in found if "curve_mode" in one), None)
    if one is None:
        return nothing("no curves over amplitude: the campaign begins at stick frequencies")
    modes = np.unique(one["curve_mode"].values.astype(str))
    drawn, axes = panels(2, len(modes), 9.2, 5.6, sharex="col")
    forces = np.unique(one["curve_force"].values)
    chosen = forces[
        np.unique(np.linspace(0, forces.size - 1, min(4, forces.size)).round().astype(int))
    ]
    factor, load = load_axis(one.attrs)
    colours = force_colours(forces.tolist(), factor)
    for column, mode in enumerate(modes):
        for row, name in enumerate(("curve_frequency", "curve_loss")):
            axis = axes[row, column]
            for f in chosen:
                _curve(axis, one, mode, f, name, colours.to_rgba(factor * f), (100.0, 1e3)[row])
            plain_log_scale(axis, "x")
        axes[0, column].set_title(mode, loc="left")
        axes[1, column].set_xlabel("amplitude at the sensor / µm")
    axes[0, 0].set_ylabel("frequency less its plateau / %")
    axes[1, 0].set_ylabel("loss factor less its plateau / 10⁻³")
    kinds = [
        Line2D([], [], color="#5c6b7a", marker="o", linestyle="", markersize=3, label="measured"),
        Line2D([], [], color="#5c6b7a", linestyle="--", label="simulated as it was"),
        Line2D([], [], color="#5c6b7a", label="simulated with the cause"),
    ]
    axes[0, 0].legend(handles=kinds, fontsize=7, loc="lower left")
    if load:
        drawn.colorbar(colours, ax=axes, label=load, shrink=0.7)
    return note_simulated(drawn, simulated)


def _curve(axis, one: xr.Dataset, mode: str, force: float, name: str, colour, unit: float) -> None:
    mine = (one["curve_mode"].values == mode) & (one["curve_force"].values == force)
    here = one.isel(point=np.flatnonzero(mine)).sortby("curve_amplitude")
    amplitude = 1e6 * here["curve_amplitude"].values
    axis.plot(amplitude, unit * here[name], "o", color=colour, markersize=2.2)
    for stage, style in (("before", "--"), ("after", "-")):
        axis.plot(amplitude, unit * here[f"{name}_simulated"].sel(stage=stage), style,
                  color=colour, linewidth=1.0)  # fmt: skip


def law(found: Sequence[xr.Dataset], simulated: bool) -> Figure:
    """kn and kt over force with their standard deviations, before and after."""
    full = [one for one in found if "law_k" in one]
    if not full:
        return nothing("too few stick frequencies for a law of the force")
    drawn, axes = panels(len(full), 2, 9.2, 2.8 * len(full))
    for row, one in enumerate(full):
        force = one["law_force"].values / 1e3
        for column, name in enumerate(("kn", "kt")):
            axis = axes[row, column]
            for stage, colour, style in (("before", BEFORE, "--"), ("after", AFTER, "-")):
                if stage == "after" and not one.attrs["named"]:
                    continue
                here = one.sel(stage=stage, stiffness=name)
                k, spread = 1e-9 * here["law_k"].values, np.exp(here["law_ln_std"].values)
                axis.fill_between(force, k / spread, k * spread, color=colour, alpha=0.18,
                                  linewidth=0)  # fmt: skip
                label = "as it was" if stage == "before" else "with the cause"
                axis.plot(force, k, style, color=colour, label=label)
            axis.set_xlabel("axial force / kN")
            axis.set_ylabel(f"{name} of a flank / GN/m")
            plain_log_scale(axis)
            axis.set_title(one.attrs["structure"], loc="left", color=STRUCTURE_COLOURS[3])
    axes[0, 0].legend(fontsize=7, title="simulation ± std", title_fontsize=7)
    return note_simulated(drawn, simulated)
