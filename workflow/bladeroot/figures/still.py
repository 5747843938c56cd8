"""A chart as a picture, for print and where there is no script."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy import ndarray

from bladeroot.figures.chart import NOTHING, Chart, Panel, Trace, empty, options
from bladeroot.figures.style import (
    PUBLISHED,
    note_simulated,
    panels,
    plain,
    plain_log_scale,
)

_MOST_OPTIONS = 16  # of a switch that a legend bears
_WIDTH, _HEIGHT = 4.6, 2.7  # of a panel with what stands about it, inches
# Of a panel: left, right, below, above of its axes. Measured texts would take most of the drawing.
_ABOUT = (0.8, 0.15, 0.5, 0.3)
_LEGEND_ROW = 0.17
_NOTE = 0.25  # a line above or below all panels
_BAR = 0.9  # a colour bar with its numbers and label


def still(chart: Chart) -> Figure:
    """The chart drawn with all that it holds."""
    handles = _legend(chart)
    columns = max(1, min(6, 110 // max([8 + len(str(h.get_label())) for h in handles], default=1)))
    below = _LEGEND_ROW * -(-len(handles) // columns) + _NOTE * bool(chart.warning)
    drawn, axes = _grid(chart, below)
    for axis, panel in zip(axes.flat, chart.panels, strict=False):
        _prepare(axis, panel)
    for axis in axes.flat[len(chart.panels) :]:
        axis.set_axis_off()
    norm = TwoSlopeNorm(0.0, -chart.scale[1], chart.scale[1]) if chart.scale else None
    for trace in chart.traces:
        _draw(axes.flat[trace.panel], trace, norm)
    for axis, panel in zip(axes.flat, chart.panels, strict=False):
        _finish(axis, panel)
    for panel in empty(chart):
        axis = axes.flat[panel]
        axis.set(xticks=[], yticks=[])
        axis.text(0.5, 0.5, NOTHING, ha="center", va="center", transform=axis.transAxes)
    width, height = drawn.get_size_inches()
    if norm is not None:
        place = drawn.add_axes([1.0 - _BAR / width, 0.25, 0.15 / width, 0.5])
        shown = ScalarMappable(norm, colormaps["RdBu_r"])
        drawn.colorbar(shown, place, extend="both", label=chart.scale[0])
    note = _NOTE / height
    if handles:
        place = (0.0, note * bool(chart.warning), 1.0, below / height)
        drawn.legend(
            handles=handles, loc="lower center", bbox_to_anchor=place, ncols=columns, fontsize=7.5
        )
    if chart.warning:
        drawn.supxlabel(chart.warning, fontsize=9, fontweight="bold", color=PUBLISHED)
    return note_simulated(drawn, chart.simulated)


def _grid(chart: Chart, below: float) -> tuple[Figure, ndarray]:
    """A figure with its panels' axes; below: inches under them for legend and warning."""
    rows = -(-len(chart.panels) // chart.columns)
    bar, note = _BAR * bool(chart.scale), _NOTE * chart.simulated
    width = max(_WIDTH * chart.columns, 7.2) + bar
    height = _HEIGHT * rows + below + note
    drawn, axes = panels(rows, chart.columns, width, height, layout=None)
    left, right, under, over = _ABOUT
    across = (width - bar) / chart.columns - left - right
    drawn.subplots_adjust(
        left=left / width,
        right=1.0 - (right + bar) / width,
        bottom=(below + under) / height,
        top=1.0 - (note + over) / height,
        wspace=(left + right) / across,
        hspace=(under + over) / (_HEIGHT - under - over),
    )
    return drawn, axes


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
