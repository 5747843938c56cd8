"""What the simulation leaves of the measurement, before and after its causes, side by side."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.figures.chart import AMPLITUDE, Chart, Panel, Trace
from bladeroot.figures.diagnosis import stage_names
from bladeroot.loads import shown

_MODES = ("#1b3a5c", "#d08a1d", "#6a51a3", "#4c4c4c")
_DIRECTIONS = {1.0: ("^", "loading"), -1.0: ("v", "unloading"), 0.0: ("o", "direction not known")}
_COLOUR_LABEL = "measured less simulated, standard deviations"
_COLOUR_LIMIT = 6.0  # standard deviations at the ends of the colours


def records(found: Sequence[xr.Dataset], simulated: bool) -> Chart | None:
    """Stick frequencies: what is left in standard deviations, over load, time and clamping.

    None where there is no law of stick frequencies, or nothing was varied to draw them over.
    """
    full = [one for one in found if "stick_residual_scaled" in one]
    rows = [(one, name, values) for one in full for name, values in _axes_of(one)]
    if not rows:
        return None
    panels, traces = [], []
    for one, name, values in rows:
        for stage, text in stage_names(one).items():
            panels.append(Panel(f"{one.attrs['structure']}, {text}", name,
                                "standard deviations", zero=True, band=(-2.0, 2.0)))  # fmt: skip
            left = one["stick_residual_scaled"].sel(stage=stage).values
            traces += _scatter(one, values, left, len(panels) - 1)
    fitted = " (fitted with the cause)" if any("after" in stage_names(one) for one in full) else ""
    return Chart(
        "What is left of each record's stick frequency, in standard deviations of "
        f"what clamping, reading and noise scatter{fitted}, over what the "
        "campaign varied. Grey: two standard deviations.",
        panels, traces, colours="mode", simulated=simulated,
    )  # fmt: skip


def _scatter(one: xr.Dataset, x: np.ndarray, left: np.ndarray, panel: int) -> list[Trace]:
    """A trace a mode and direction."""
    modes, records = one["stick_mode"].values.astype(str), one["stick_record"].values.astype(str)
    traces = []
    for mode, colour in zip(one["mode"].values.astype(str), _MODES, strict=False):
        for sign, (marker, way) in _DIRECTIONS.items():
            mine = (modes == mode) & (one["stick_direction"].values == sign)
            if mine.any():
                traces.append(
                    Trace(panel, x[mine], left[mine], f"mode {mode}", colour, marker=marker,
                          size=3.5, kind=way, texts=records[mine].tolist(),
                          switches={"mode": str(mode), "direction": way})
                )  # fmt: skip
    return traces


def _axes_of(one: xr.Dataset) -> list[tuple[str, np.ndarray]]:
    """What a campaign lets its residuals be drawn over."""
    force, hold, time = (one[f"stick_{name}"].values for name in ("force", "hold", "time"))
    factor, unit, load = shown(one.attrs)
    over = [(f"{load} / {unit}", factor * force)] if load else []
    if np.ptp(time) > 0.0:
        over.append(("time since the first record / h", time / 3600.0))
    held = np.unique(hold).size
    if np.unique(force).size < held < hold.size:
        first = [time[hold == h].min() for h in range(held)]
        modes = one["stick_mode"].values
        single = max(np.bincount(hold[modes == mode]).max() for mode in np.unique(modes)) == 1
        # without a load, what is one record of each mode is a motion, held as all others are
        name = "event" if single and not load else "clamping"
        over.append((f"{name}, in order", np.argsort(np.argsort(first, kind="stable"))[hold] + 1))
    return over


def curves(found: Sequence[xr.Dataset], simulated: bool) -> Chart | None:
    """Curves over amplitude: what is left in standard deviations over amplitude and load.

    None where the campaign begins at stick frequencies, and without a load: the curves themselves
    show it then.
    """
    one = next((one for one in found if "curve_mode" in one), None)
    factor, unit, load = shown(one.attrs) if one is not None else (1.0, "", "")
    if not load:
        return None
    modes = np.unique(one["curve_mode"].values.astype(str))
    panels, traces = [], []
    for mode in modes:
        here = one.isel(point=np.flatnonzero(one["curve_mode"].values == mode))
        force = factor * here["curve_force"].values
        for name, quantity in (("curve_frequency", "frequency"), ("curve_loss", "loss factor")):
            for stage, text in stage_names(one).items():
                panels.append(
                    Panel(f"{mode}, {quantity}, {text}", AMPLITUDE, f"{load} / {unit}", x_log=True)
                )
                left = (here[name] - here[f"{name}_simulated"].sel(stage=stage)) / here[
                    f"{name}_std"
                ]
                traces.append(
                    Trace(len(panels) - 1, 1e6 * here["curve_amplitude"].values, force,
                          f"mode {mode}, {quantity}", values=left.values)
                )  # fmt: skip
    return Chart(
        f"What is left of the curves over amplitude and {load}: blue where the measurement lies "
        "below what it is compared with, red above.",
        panels, traces, scale=(_COLOUR_LABEL, _COLOUR_LIMIT), simulated=simulated,
    )  # fmt: skip
