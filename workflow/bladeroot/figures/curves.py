"""Frequency and damping over amplitude: means of each load, and every record (figs 3.11-3.20)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.colors import to_hex

from bladeroot.figures.chart import AMPLITUDE, Chart, Panel, Trace, sure, thinned
from bladeroot.figures.style import force_colours
from bladeroot.loads import shown, value_of

# Records of a mode that are drawn: more hide each other, and each makes the page some 10 kB larger.
MOST_RECORDS = 100
MODES = 4  # that stand side by side
_QUANTITIES = (
    ("frequency", "natural frequency / Hz", 1.0),
    ("loss_factor", "loss factor / %", 1e2),
)


def means(curves: xr.Dataset) -> Chart | None:
    """f_n(A) above, loss factor(A) below, a column a mode, a curve a load, group and sensor.

    curves: dims level, amplitude, as from `bladeroot.pooling.curves.mean_curves`. None where no
    record is usable.
    """
    modes = list(dict.fromkeys(curves["mode"].values.astype(str)))
    if not modes:
        return None
    traces = []
    for row, (quantity, _, scale) in enumerate(_QUANTITIES):
        for column, mode in enumerate(modes[:MODES]):
            here = curves.isel(level=np.flatnonzero(curves["mode"].values == mode))
            traces += _levels(here, quantity, scale, row * len(modes[:MODES]) + column)
    coloured, switch = _coloured(traces, curves["force"].values.tolist(), curves.attrs)
    load = shown(curves.attrs)[2]
    more = f" {len(modes) - MODES} more modes are in the chapter." if len(modes) > MODES else ""
    return Chart(
        "Natural frequency and loss factor over displacement amplitude: mean of the records"
        + (f" at each {load}" if load else "")
        + ", with one standard error. A record's own level counts once; where the course over "
        "amplitude, without that level, is not known to 0.1 % of the frequency or 20 % of the loss "
        f"factor nothing is drawn.{more}",
        _panels(modes[:MODES]),
        coloured,
        columns=len(modes[:MODES]),
        colours=switch,
        simulated=bool(curves.attrs["simulated"]),
    )


def records(decays: Sequence[xr.Dataset]) -> Chart | None:
    """A curve a usable record; at most `MOST_RECORDS` of a mode, evenly over their loads."""
    decays = [decay for decay in decays if decay.sizes["point"]]
    if not decays:
        return None
    factor, unit, load = shown(decays[0].attrs)
    modes, parts, traces = list(dict.fromkeys(d.attrs["mode"] for d in decays)), {}, []
    for column, mode in enumerate(modes):
        every = [decay for decay in decays if decay.attrs["mode"] == mode]
        here = _spread(every)
        parts[mode] = f", {len(here)} of {len(every)} records" if len(here) < len(every) else ""
        for decay in here:
            at = thinned(decay.sizes["point"])
            one = decay.isel(point=at)
            switches = _switches(one.attrs, factor, unit, load)
            for row, (quantity, _, scale) in enumerate(_QUANTITIES):
                traces.append(
                    Trace(
                        row * len(modes) + column,
                        1e6 * one["amplitude"].values,
                        scale * sure(one, quantity),
                        name=", ".join([decay.attrs["record"], *switches.values()]),
                        line="-",
                        error=scale * one[f"{quantity}_std"].values,
                        switches={**switches, "record": decay.attrs["record"]},
                        width=0.9,
                    )
                )
    coloured, switch = _coloured(traces, [value_of(d.attrs) for d in decays], decays[0].attrs)
    panels = [
        Panel(panel.title + parts.get(panel.title.removeprefix("mode "), ""), panel.x, panel.y,
              x_log=panel.x_log, y_log=panel.y_log, y_range=_limits(traces, k, panel.y_log))
        for k, panel in enumerate(_panels(modes))
    ]  # fmt: skip
    return Chart(
        "Natural frequency and loss factor over displacement amplitude (FREEVIB, 3.11), a curve "
        "for each usable record; one standard error stands beside the pointer.",
        panels,
        coloured,
        columns=len(modes),
        colours=switch,
        simulated=any(bool(decay.attrs.get("simulated")) for decay in decays),
    )


def _panels(modes: Sequence[str]) -> list[Panel]:
    return [
        Panel(f"mode {mode}", AMPLITUDE, label, x_log=True, y_log=quantity == "loss_factor")
        for quantity, label, _ in _QUANTITIES
        for mode in modes
    ]


def _levels(here: xr.Dataset, quantity: str, scale: float, panel: int) -> list[Trace]:
    made = []
    for k in range(here.sizes["level"]):
        one = here.isel(level=k)
        made += _line(
            one, scale * sure(one, quantity), scale * one[f"{quantity}_std"].values, panel
        )
    return made


def _line(one: xr.Dataset, value: np.ndarray, std: np.ndarray, panel: int) -> list[Trace]:
    """A level's curve and its band, where anything of it is known."""
    known = np.flatnonzero(np.isfinite(value) & np.isfinite(std))
    if not known.size:
        return []
    at = np.arange(known[0], known[-1] + 1)  # gaps inside stay
    at = at[thinned(at.size)]
    facts = {name: str(one[name].item()) for name in ("group", "sensor") if name in one.coords}
    factor, unit, load = shown(one.attrs)
    switches = _switches({**facts, "load": float(one["force"])}, factor, unit, load)
    x, value, std = 1e6 * one["amplitude"].values[at], value[at], std[at]
    name = ", ".join(switches.values()) or f"mode {one['mode'].item()}"
    return [
        Trace(panel, x, low=value - std, high=value + std, name=name, switches=switches),
        Trace(panel, x, value, name=name, line="-", error=std, switches=switches),
    ]


def _switches(facts: dict, factor: float, unit: str, load: str) -> dict[str, str]:
    """What a curve is told from others by: its load, and its group and sensor."""
    made = {load: _label(value_of(facts), factor, unit)} if load else {}
    names = [str(facts.get(name, "")) for name in ("group", "sensor")]
    if any(names):
        made["curve"] = ", ".join(filter(None, names))
    return made


def _coloured(
    traces: Sequence[Trace], loads: Sequence[float], facts: Mapping
) -> tuple[list[Trace], str]:
    """The same with colours by load where there are several, else by what tells them apart, and
    the name of that switch.
    """
    factor, unit, load = shown(facts)
    several = sorted(set(loads)) if load else []
    keys = dict.fromkeys(key for trace in traces for key in trace.switches)
    if len(several) > 1:
        switch, scale = load, force_colours(several, factor)
        colour = {_label(v, factor, unit): to_hex(scale.to_rgba(factor * v)) for v in several}
    else:
        options = {key: dict.fromkeys(t.switches.get(key, "") for t in traces) for key in keys}
        switch = next((key for key in keys if len(options[key]) > 1), next(iter(keys), ""))
        names = options.get(switch, {"": None})
        # as it is, the map's middle is too bright a green to be seen on white
        several = 0.82 * colormaps["turbo"](np.linspace(0.06, 0.94, len(names)))[:, :3]
        colour = {name: to_hex(one) for name, one in zip(names, several, strict=True)}
    return [replace(one, colour=colour[one.switches.get(switch, "")]) for one in traces], switch


def _label(load: float, factor: float, unit: str) -> str:
    return f"{factor * load:.4g} {unit}"


def _spread(decays: Sequence[xr.Dataset]) -> list[xr.Dataset]:
    """At most `MOST_RECORDS` of them, evenly over their loads."""
    if len(decays) <= MOST_RECORDS:
        return list(decays)
    order = np.argsort([value_of(decay.attrs) for decay in decays], kind="stable")
    kept = order[np.arange(MOST_RECORDS) * (len(decays) - 1) // (MOST_RECORDS - 1)]
    return [decays[k] for k in sorted(kept)]


def _limits(traces: Sequence[Trace], panel: int, log: bool) -> tuple[float, float]:
    """Axis limits that the last, lost points of a few curves cannot stretch."""
    values = np.concatenate([trace.y for trace in traces if trace.panel == panel])
    values = values[values > 0.0]  # a logarithmic axis has no place for an amplitude that grows
    low, high = np.percentile(values, [0.1, 99.9]) if values.size else (1.0, 2.0)
    margin = 0.08 * (high - low) + 1e-3 * high
    return (0.6 * low, 1.6 * high) if log else (low - margin, high + margin)
