"""The diagnosis drawn: ranking of causes, and measured against simulated before and after them."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from bladeroot.figures import style
from bladeroot.figures.chart import AMPLITUDE, Chart, Panel, Trace
from bladeroot.figures.style import (
    MEASURED,
    force_colours,
    note_simulated,
    nothing,
    plain,
)
from bladeroot.loads import shown

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
    drawn, axes = style.panels(rows, min(2, len(wanted)), 9.2, 0.5 + 2.5 * rows)
    for axis, (one, said, channel) in zip(axes.flat, wanted, strict=False):
        _ranks(axis, one, said, channel)
    for axis in axes.flat[len(wanted) :]:
        axis.set_axis_off()
    fills = [Patch(color=colour, label=name) for name, colour in _FILL.items()]
    fills.append(Patch(facecolor="white", edgecolor="#5c6b7a", hatch="///", label="any smooth law"))
    drawn.legend(handles=fills, loc="outside lower center", ncols=5, fontsize=7.5)
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


def frequencies(found: Sequence[xr.Dataset], simulated: bool) -> Chart | None:
    """Stick frequency over the load, measured and simulated before and after, and what is left.

    None where there is no law over a load.
    """
    full = [one for one in found if "stick_residual" in one]
    factor, unit, load = shown(full[0].attrs) if full else (1.0, "", "")
    if not load:
        return None
    modes = [str(m) for m in full[0]["mode"].values]
    panels, traces = [], []
    for one in full:
        for label in ("stick frequency / Hz", "measured less simulated / %"):
            for mode in modes:
                above = label.startswith("stick")
                panels.append(Panel(f"{one.attrs['structure']}, {mode}", f"{load} / {unit}", label,
                                    zero=not above))  # fmt: skip
                here = one.isel(stick_record=one["stick_mode"].values == mode)
                traces += _frequency(here, factor, len(panels) - 1, above)
    return Chart(
        f"Stick frequency over the {load}, measured and as judged, before and after the cause is "
        "part of the simulation; below, what is left.",
        panels, traces, columns=len(modes), simulated=simulated,
    )  # fmt: skip


def _frequency(here: xr.Dataset, factor: float, panel: int, above: bool) -> list[Trace]:
    names = here["stick_record"].values.astype(str).tolist()
    force = factor * here["stick_force"].values
    every = np.unique(force)
    key, scale = ("stick_simulated", 1.0) if above else ("stick_residual", 100.0)
    traces = []
    for stage, (colour, line, kind) in _stages(here).items():
        value = scale * here[key].sel(stage=stage).values
        mean = np.array([value[force == f].mean() for f in every])
        switches = {"shown": kind}
        traces.append(Trace(panel, every, mean, kind, colour, line, kind=kind, switches=switches))
        if not above:
            traces.append(
                Trace(panel, force, value, kind, colour, marker="o", size=3.5, texts=names,
                      hollow=stage == "before", switches=switches)
            )  # fmt: skip
    if above:
        traces.append(Trace(panel, force, here["stick_frequency"].values, "measured", MEASURED,
                            marker="o", size=3.5, texts=names, kind="measured",
                            switches={"shown": "measured"}))  # fmt: skip
    return traces


def stage_names(one: xr.Dataset) -> dict[str, str]:
    """What a simulation is called before and after its causes are part of it."""
    if one.attrs.get("kind") == "none":
        return {"before": "a linear mode", "after": "with the cause"}
    return {"before": "simulated as it was", "after": "simulated with the cause"}


def _stages(one: xr.Dataset) -> dict[str, tuple[str, str, str]]:
    """Colour, line and name of the simulation as it was, and with causes where there are any."""
    name = stage_names(one)
    made = {"before": (BEFORE, "--", name["before"])}
    return made | ({"after": (AFTER, "-", name["after"])} if one.attrs["named"] else {})


def curves(found: Sequence[xr.Dataset], simulated: bool) -> Chart | None:
    """Frequency and loss factor over amplitude, measured and simulated before and after.

    None where the campaign begins at stick frequencies.
    """
    one = next((one for one in found if "curve_mode" in one), None)
    if one is None:
        return None
    modes = [str(mode) for mode in np.unique(one["curve_mode"].values)]
    factor, unit, load = shown(one.attrs)
    forces = np.unique(one["curve_force"].values)
    colours = force_colours(forces.tolist(), factor)
    panels, traces = [], []
    for name, label, scale in (
        ("curve_frequency", "frequency less its plateau / %", 100.0),
        ("curve_loss", "loss factor less its plateau / 10⁻³", 1e3),
    ):
        for mode in modes:
            panels.append(Panel(f"mode {mode}", AMPLITUDE, label, x_log=True))
            for force in forces:
                mine = (one["curve_mode"].values == mode) & (one["curve_force"].values == force)
                here = one.isel(point=np.flatnonzero(mine)).sortby("curve_amplitude")
                at = f"{factor * force:.4g} {unit}" if load else ""
                colour = to_hex(colours.to_rgba(factor * force)) if forces.size > 1 else MEASURED
                x, panel = 1e6 * here["curve_amplitude"].values, len(panels) - 1
                switches = {load: at} if load else {}
                for stage, (_, line, kind) in _stages(one).items():
                    value = scale * here[f"{name}_simulated"].sel(stage=stage).values
                    traces.append(Trace(panel, x, value, f"{kind} {at}", colour, line, kind=kind,
                                        switches={**switches, "shown": kind}))  # fmt: skip
                traces.append(
                    Trace(panel, x, scale * here[name].values, f"measured {at}", colour, marker="o",
                          size=3.0, error=scale * here[f"{name}_std"].values, kind="measured",
                          switches={**switches, "shown": "measured"})
                )  # fmt: skip
    return Chart(
        "Frequency and loss factor over amplitude as change from the plateau: measured (dots), "
        "and as judged before and after the cause is part of the simulation (lines).",
        panels, traces, columns=len(modes), colours=load, simulated=simulated,
    )  # fmt: skip


def law(found: Sequence[xr.Dataset], simulated: bool) -> Chart | None:
    """kn and kt over force with their standard deviations, before and after."""
    full = [one for one in found if "law_k" in one]
    if not full:
        return None
    panels, traces = [], []
    for one in full:
        factor, unit, called = shown(one.attrs)
        force = one["law_force"].values * factor
        for name in one["stiffness"].values.astype(str):
            of_flank = " of a flank" if name in ("kn", "kt") else ""
            panels.append(Panel(one.attrs["structure"], f"{called} / {unit}",
                                f"{name}{of_flank} / GN/m", y_log=True))  # fmt: skip
            panel = len(panels) - 1
            for stage, (colour, line, kind) in _stages(one).items():
                here = one.sel(stage=stage, stiffness=name)
                k, spread = 1e-9 * here["law_k"].values, np.exp(here["law_ln_std"].values)
                switches = {"shown": kind}
                traces += [
                    Trace(panel, force, low=k / spread, high=k * spread, colour=colour,
                          switches=switches),
                    Trace(panel, force, k, kind, colour, line, kind=kind, switches=switches),
                ]  # fmt: skip
    return Chart(
        "Contact stiffness over the force as the simulation has it before and after, each with "
        "one standard deviation. A band before the cause is that of what does not fit.",
        panels, traces, simulated=simulated,
    )  # fmt: skip
