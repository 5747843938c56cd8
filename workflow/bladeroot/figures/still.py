"""A chart as a picture, for print and where there is no script."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bladeroot.figures.chart import Chart, Panel, Trace, options
from bladeroot.figures.style import (
    PUBLISHED,
    note_simulated,
    panels,
    plain,
    plain_log_scale,
)

_MOST_OPTIONS = 16  # of a switch that a legend bears
_WIDTH, _HEIGHT = 4.6, 2.7  # of a panel, inches


def still(chart: Chart) -> Figure:
    """The chart drawn with all that it holds."""
    rows = -(-len(chart.panels) // chart.columns)
    width = max(_WIDTH * chart.columns, 7.2)
    drawn, axes = panels(rows, chart.columns, width, _HEIGHT * rows + 0.3)
    for axis, panel in zip(axes.flat, chart.panels, strict=False):
        _prepare(axis, panel)
    for axis in axes.flat[len(chart.panels) :]:
        axis.set_axis_off()
    norm = TwoSlopeNorm(0.0, -chart.scale[1], chart.scale[1]) if chart.scale else None
    for trace in chart.traces:
        _draw(axes.flat[trace.panel], trace, norm)
    for axis, panel in zip(axes.flat, chart.panels, strict=False):
        _finish(axis, panel)
    if norm is not None:
        shown = ScalarMappable(norm, colormaps["RdBu_r"])
        drawn.colorbar(shown, ax=axes, shrink=0.6, extend="both", label=chart.scale[0])
    handles = _legend(chart)
    if handles:
        columns = max(1, min(6, 110 // max(8 + len(str(h.get_label())) for h in handles)))
        drawn.legend(handles=handles, loc="outside lower center", ncols=columns, fontsize=7.5)
    if chart.warning:
        drawn.supxlabel(chart.warning, fontsize=9, fontweight="bold", color=PUBLISHED)
    return note_simulated(drawn, chart.simulated)


def _prepare(axis: Axes, panel: Panel) -> None:
    axis.set_title(panel.title, loc="left")
    axis.set_xlabel(panel.x)
    axis.set_ylabel(panel.y)
    if panel.band:
        axis.axhspan(*panel.band, color="#eef1f4", zorder=0)
    if panel.zero:
        axis.axhline(0.0, color="black", linewidth=0.8)


def _draw(axis: Axes, trace: Trace, norm: TwoSlopeNorm | None) -> None:
    if trace.low is not None:
        axis.fill_between(
            trace.x, trace.low, trace.high, color=trace.colour, alpha=0.2, linewidth=0
        )
    elif trace.values is not None:
        axis.scatter(trace.x, trace.y, c=trace.values, cmap="RdBu_r", norm=norm, marker="s",
                     s=34, linewidths=0.2, edgecolors="#5c6b7a")  # fmt: skip
    else:
        style = {
            "color": trace.colour, "linestyle": trace.line or "none", "linewidth": trace.width,
            "marker": trace.marker or "none", "markersize": trace.size, "alpha": trace.opacity,
            "markerfacecolor": "white" if trace.hollow else trace.colour,
        }  # fmt: skip
        if trace.line or (trace.error is None and trace.x_error is None):
            axis.plot(trace.x, trace.y, **style)
        else:
            axis.errorbar(trace.x, trace.y, trace.error, trace.x_error, elinewidth=0.8, **style)


def _finish(axis: Axes, panel: Panel) -> None:
    for name, log in (("x", panel.x_log), ("y", panel.y_log)):
        if log:
            plain_log_scale(axis, name)
    if panel.x_ticks:
        axis.set_xticks(range(len(panel.x_ticks)), list(map(plain, panel.x_ticks)))
    if panel.x_range:
        axis.set_xlim(*panel.x_range)
    if panel.y_range:
        axis.set_ylim(*panel.y_range)


def _legend(chart: Chart) -> list[Line2D]:
    """Kinds of traces, then the options of the switch that has the colours."""
    first: dict[str, Trace] = {}
    for trace in chart.traces:
        if trace.kind:
            first.setdefault(trace.kind, trace)
    coloured = options(chart).get(chart.colours, {})
    handles = [
        Line2D(
            [], [], label=kind, color="#5c6b7a" if coloured else trace.colour,
            linestyle=trace.line or "none", marker=trace.marker or "none", markersize=4,
            markerfacecolor="white" if trace.hollow else None,
        )
        for kind, trace in first.items()
    ]  # fmt: skip
    names = [(option, traces[0].colour) for option, traces in coloured.items()]
    shown = np.unique(
        np.linspace(0, len(names) - 1, min(len(names), _MOST_OPTIONS)).round().astype(int)
    )
    return handles + [Line2D([], [], color=names[k][1], label=names[k][0]) for k in shown]
