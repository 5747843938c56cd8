"""A chart as what the plotting library in a page (plotly.js) reads."""

import html
import json
import math
from collections.abc import Iterable

import numpy as np
from numpy import ndarray

from bladeroot.figures.chart import NOTHING, Chart, Panel, Trace, empty, options, runs

_DASHES = {"-": "solid", "--": "dash", ":": "dot"}
_MARKERS = {"o": "circle", "s": "square", "D": "diamond", "^": "triangle-up", "v": "triangle-down"}
_SIGNS = {"-": "\u2014", "--": "- -", ":": "\u00b7\u00b7\u00b7", "": "\u25cf"}
_HEIGHT = 290  # pixels of a panel
_INK, _LINE = "#1c2733", "#d7dde3"


def live(chart: Chart) -> str:
    """The chart as JSON that may stand inside a page's script element."""
    # the library leaves out axes that no trace names, and lays the title of one on another
    none = np.array([np.nan])
    places = [Trace(panel, none, none) for panel in sorted(empty(chart))]
    document = {
        "data": [_trace(trace, chart) for trace in [*chart.traces, *places]],
        "layout": _layout(chart),
        "columns": chart.columns,
        "panels": len(chart.panels),
        "height": _HEIGHT,
        "switches": [
            {"name": switch, "options": [[option, *_sign(of)] for option, of in several.items()]}
            for switch, several in options(chart).items()
        ],
    }
    # ends no script element, whatever a name holds; all beyond ASCII is escaped, line ends included
    text = json.dumps(document, allow_nan=False, separators=(",", ":"))
    return text.replace("&", r"\u0026").replace("<", r"\u003c").replace(">", r"\u003e")


def _sign(traces: list[Trace]) -> tuple[str, str]:
    """How an option looks: its line or points, and its colour; nothing where it has several."""
    drawn = [trace for trace in traces if trace.low is None] or traces
    colours, lines = ({getattr(one, name) for one in drawn} for name in ("colour", "line"))
    colour = colours.pop() if len(colours) == 1 else ""
    sign = _SIGNS[lines.pop()] if len(lines) == 1 else "\u25a0" * bool(colour)
    return sign, colour


def words(text: str) -> str:
    """A text that the library shows as it is: no tags, no entities, no place of a number."""
    return html.escape(text, quote=False).replace("%{", "%\u200b{")


def _numbers(values: ndarray | Iterable[float], digits: int = 7) -> list[float | None]:
    """To so many digits, None where nothing is known."""
    text = f"{{:.{digits}g}}".format
    return [float(text(v)) if math.isfinite(v) else None for v in np.asarray(values, float)]


def _axis(number: int) -> str:
    return str(number + 1) if number else ""


def _trace(trace: Trace, chart: Chart) -> dict:
    panel = chart.panels[trace.panel]
    made = {
        "type": "scatter",
        "xaxis": f"x{_axis(trace.panel)}",
        "yaxis": f"y{_axis(trace.panel)}",
        "name": words(trace.kind or trace.name),
        "meta": dict(trace.switches),
        "showlegend": False,
    }
    if trace.low is not None:
        return made | _band(trace)
    made |= {
        "x": _numbers(trace.x, 5),
        "y": _numbers(trace.y),
        "mode": "+".join(["lines"] * bool(trace.line) + ["markers"] * (not trace.line or
                         bool(trace.marker))),
        "line": {"color": trace.colour, "width": 1.3 * trace.width,
                 "dash": _DASHES.get(trace.line, "solid")},
        "marker": {"color": trace.colour, "size": 1.5 * trace.size,
                   "symbol": _MARKERS.get(trace.marker, "circle") + "-open" * trace.hollow},
        "opacity": trace.opacity,
        "hovertemplate": _hover(trace, panel, chart),
    }  # fmt: skip
    if trace.texts:
        made["text"] = list(map(words, trace.texts))
    for name, error in (("error_y", trace.error), ("error_x", trace.x_error)):
        if error is not None and not trace.line:  # a line of bars hides itself
            made[name] = {"type": "data", "array": _numbers(error, 3), "thickness": 1, "width": 2}
    if trace.error is not None:
        made["customdata"] = _numbers(trace.error, 3)
    if trace.values is not None:
        made["customdata"] = _numbers(trace.values, 3)
        edge = {"width": 0.5, "color": "#5c6b7a"}
        made["marker"] = {"color": made["customdata"], "coloraxis": "coloraxis", "size": 10,
                          "symbol": "square", "line": edge}  # fmt: skip
    return made


def _hover(trace: Trace, panel: Panel, chart: Chart) -> str:
    """What stands beside the pointer: the name, then each axis with its value."""
    name = "%{text}" if trace.texts else words(trace.name)
    lines = [f"<b>{name}</b>"] if name else []
    x = "" if panel.x_ticks else f"{words(panel.x.partition(chr(10))[0])}: %{{x:.4g}}"
    y = f"{words(panel.y.replace(chr(10), ' '))}: %{{y:.6g}}"
    if trace.values is not None:
        y += f"<br>{words(chart.scale[0])}: %{{customdata:.2g}}"
    elif trace.error is not None:
        y += " ± %{customdata:.2g}"
    return "<br>".join([*lines, *filter(None, [x]), y]) + "<extra></extra>"


def _band(trace: Trace) -> dict:
    """A closed outline round each run of points that is known."""
    x: list[float | None] = []
    y: list[float | None] = []
    for run in runs(np.isfinite(trace.low) & np.isfinite(trace.high)):
        along = _numbers(trace.x[run], 5)
        x += [*along, *along[::-1], None]
        y += [*_numbers(trace.high[run]), *_numbers(trace.low[run])[::-1], None]
    return {
        "x": x[:-1], "y": y[:-1], "mode": "lines", "fill": "toself", "hoverinfo": "skip",
        "line": {"width": 0}, "fillcolor": trace.colour, "opacity": 0.2,
    }  # fmt: skip


def _layout(chart: Chart) -> dict:
    made: dict = {
        "grid": {"pattern": "independent"},
        "margin": {"l": 64, "r": 16, "t": 30, "b": 48},
        "font": {"family": "Source Sans 3, Segoe UI, DejaVu Sans, Arial, sans-serif", "size": 12,
                 "color": _INK},
        "hovermode": "closest",
        "plot_bgcolor": "#fff",
        "paper_bgcolor": "#fff",
        "annotations": [],
        "shapes": [],
    }  # fmt: skip
    bare = empty(chart)
    for k, panel in enumerate(chart.panels):
        made[f"xaxis{_axis(k)}"] = _scale(panel.x, panel.x_log, panel.x_range, panel.x_ticks)
        made[f"yaxis{_axis(k)}"] = _scale(panel.y, panel.y_log, panel.y_range, ())
        made["annotations"].append(
            {"text": f"<b>{words(panel.title)}</b>", "showarrow": False, "x": 0, "y": 1,
             "xref": f"x{_axis(k)} domain", "yref": f"y{_axis(k)} domain", "xanchor": "left",
             "yanchor": "bottom", "font": {"size": 12.5}}
        )  # fmt: skip
        if k in bare:
            for name in "xy":
                made[f"{name}axis{_axis(k)}"] |= {"showticklabels": False, "showgrid": False}
            made["annotations"].append(
                {"text": NOTHING, "showarrow": False, "x": 0.5, "y": 0.5,
                 "xref": f"x{_axis(k)} domain", "yref": f"y{_axis(k)} domain"}
            )  # fmt: skip
        place = {"xref": f"x{_axis(k)} domain", "x0": 0, "x1": 1, "yref": f"y{_axis(k)}",
                 "layer": "below"}  # fmt: skip
        if panel.band:
            made["shapes"].append(
                place | {"type": "rect", "y0": panel.band[0], "y1": panel.band[1],
                         "fillcolor": "#eef1f4", "line": {"width": 0}}
            )  # fmt: skip
        if panel.zero:
            line = {"type": "line", "y0": 0, "y1": 0, "line": {"width": 1}}
            made["shapes"].append(place | line)
    if chart.scale:
        name, limit = chart.scale
        made["coloraxis"] = {
            "cmin": -limit, "cmax": limit, "colorscale": [[0, "#2166ac"], [0.5, "#f7f7f7"],
                                                          [1, "#b2182b"]],
            "colorbar": {"title": {"text": words(name), "side": "right"}, "thickness": 12},
        }  # fmt: skip
    return made


def _scale(title: str, log: bool, limits: tuple | None, ticks: Iterable[str]) -> dict:
    made = {
        "title": {"text": words(title).replace("\n", "<br>"), "standoff": 6},
        "type": "log" if log else "linear",
        "gridcolor": _LINE,
        "linecolor": _INK,
        "zeroline": False,
        "exponentformat": "power",
        "automargin": True,
    }
    if limits:
        made["range"] = [math.log10(v) if log else v for v in limits]
    names = list(ticks)
    if names:
        made |= {"tickvals": list(range(len(names))), "ticktext": list(map(words, names))}
    return made
