"""The diagnosis drawn: measured against simulated, before and after the causes."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.colors import to_hex

from bladeroot.figures.chart import AMPLITUDE, Chart, Panel, Trace
from bladeroot.figures.style import MEASURED, force_colours
from bladeroot.loads import shown

# Colours of the simulation before and after it is extended.
BEFORE = "#b5462f"
AFTER = "#2a7f62"


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
    """What a simulation is called before its causes are part of it and, where it has any, after."""
    alone = one.attrs.get("kind") == "none"
    made = {"before": "a linear mode" if alone else "simulated as it was"}
    # a fault of records, or a cause that is too small to be fitted, changes no simulation
    simulated = ("stick_residual", "curve_frequency_simulated", "law_k")
    sides = [one[name].transpose("stage", ...).values for name in simulated if name in one]
    changed = [not np.array_equal(*side, equal_nan=True) for side in sides]
    if one.attrs["named"] and any(changed or [True]):
        made["after"] = "with the cause" if alone else "simulated with the cause"
    return made


def _stages(one: xr.Dataset) -> dict[str, tuple[str, str, str]]:
    """Colour, line and name of each."""
    looks = {"before": (BEFORE, "--"), "after": (AFTER, "-")}
    return {stage: (*looks[stage], name) for stage, name in stage_names(one).items()}


def curves(found: Sequence[xr.Dataset], simulated: bool) -> Chart | None:
    """Frequency and loss factor over amplitude, measured and simulated before and after.

    None where the campaign begins at stick frequencies, or no point of a mode is sure.
    """
    one = next((one for one in found if "curve_mode" in one), None)
    if one is None:
        return None
    modes = [str(mode) for mode in np.unique(one["curve_mode"].values)]
    modes = [mode for mode in modes if _is_seen(one.isel(point=one["curve_mode"].values == mode))]
    if not modes:
        return None
    factor, unit, load = shown(one.attrs)
    forces = np.unique(one["curve_force"].values)
    colours = force_colours(forces.tolist(), factor)
    panels, traces = [], []
    for name, label, scale in (
        ("curve_frequency", "change of frequency / %", 100.0),
        ("curve_loss", "change of loss factor / % (absolute)", 100.0),
    ):
        # a point that is less sure than the whole range says nothing and would stretch the axis
        reach = {m: scale * np.ptp(one[name].values[one["curve_mode"].values == m]) for m in modes}
        for mode in modes:
            panels.append(Panel(f"mode {mode}", AMPLITUDE, label, x_log=True))
            for force in forces:
                mine = (one["curve_mode"].values == mode) & (one["curve_force"].values == force)
                here = one.isel(point=np.flatnonzero(mine)).sortby("curve_amplitude")
                at = f"{factor * force:.4g} {unit}" if load else ""
                colour = to_hex(colours.to_rgba(factor * force)) if forces.size > 1 else MEASURED
                x, panel = 1e6 * here["curve_amplitude"].values, len(panels) - 1
                std = scale * here[f"{name}_std"].values
                switches = {load: at} if load else {}
                for stage, (_, line, kind) in _stages(one).items():
                    value = scale * here[f"{name}_simulated"].sel(stage=stage).values
                    traces.append(Trace(panel, x, value, f"{kind} {at}", colour, line, kind=kind,
                                        switches={**switches, "shown": kind}))  # fmt: skip
                traces.append(
                    Trace(panel, x, np.where(std < reach[mode], scale * here[name].values, np.nan),
                          f"measured {at}", colour, marker="o", size=3.0, error=std,
                          kind="measured", switches={**switches, "shown": "measured"})
                )  # fmt: skip
    return Chart(
        "Frequency and loss factor over amplitude as change from the plateau (without one, from "
        "their smaller amplitudes): measured (dots, with the errors that the verdict counts, the "
        "scatter of repeats and groups among them; what is less sure than the whole range is left "
        "out), and compared (lines).",
        panels, traces, columns=len(modes), colours=load, simulated=simulated,
    )  # fmt: skip


def _is_seen(here: xr.Dataset) -> bool:
    """Whether any point of a mode is surer than the range of all of them."""
    return any(
        (here[f"{name}_std"] < np.ptp(here[name].values)).any()
        for name in ("curve_frequency", "curve_loss")
    )
