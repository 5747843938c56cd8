"""The look that all figures share, and how one is written down."""

import io
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from bladeroot.loads import shown, value_of

MEASURED = "#1b3a5c"
PUBLISHED = "#b5462f"
# White or thin lines are hard to see on or in viridis's yellow.
COLOURS = ListedColormap(colormaps["viridis"](np.linspace(0.0, 0.88, 256)))
STRUCTURE_COLOURS = ("#2a7f62", "#d08a1d", "#6a51a3", "#4c4c4c")
MODE_COLOURS = {"1B": "#1b3a5c", "2B": "#8a4fa3"}
_TICKS = 7  # at most, on a logarithmic axis
_WIDE_DECADES = 2.4  # more have no room for the numbers between two powers of ten
SIMULATED_NOTE = "simulated records (virtual test bench)"

mpl.rcParams |= {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titley": 1.0,
    "axes.labelsize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.2,
    # Texts stay texts: a page is smaller, and can be searched. Its style names the fonts.
    "svg.fonttype": "none",
    # Same data, same bytes: Snakemake then sees that nothing changed.
    "svg.hashsalt": "bladeroot",
}


class Drawing(Figure):
    """A figure that a notebook shows where it is a cell's last value."""

    def _repr_html_(self) -> str:
        text = svg(self)
        style = '<svg style="max-width: 100%; height: auto" '
        return text[text.index("<svg") :].replace("<svg ", style, 1)


def panels(
    rows: int,
    columns: int,
    width: float,
    height: float,
    layout: str | None = "constrained",
    **kwargs,
):
    """A figure of a size in inches with a grid of axes (2-D array), in the project's style.

    layout: as of `matplotlib.figure.Figure`.
    """
    drawn = Drawing(figsize=(width, height), layout=layout)
    return drawn, drawn.subplots(rows, columns, squeeze=False, **kwargs)


def svg(drawn: Figure) -> str:
    """The figure as SVG text, the same bytes for the same data.

    A dollar sign in a text is one: names of records and clampings are no mathematics. The library's
    own powers of ten at ticks are; names at ticks are `plain`.
    """
    for label in _beside_ticks(drawn):
        label.set_parse_math(False)
    text = io.StringIO()
    # `savefig` draws everything once more, to no end
    FigureCanvasSVG(drawn).print_svg(text, metadata={"Date": None})
    return text.getvalue()


def _beside_ticks(artist: Artist) -> Iterator[Text]:
    """All texts but those of ticks, which are only made as the figure is drawn."""
    if isinstance(artist, Axis):
        yield from (artist.label, artist.offsetText)
        return
    if isinstance(artist, Text):
        yield artist
    for child in artist.get_children():
        yield from _beside_ticks(child)


def plain(text: str) -> str:
    """A name as a label of ticks, where dollar signs would begin mathematics."""
    return text.replace("$", r"\$")


def force_colours(forces: Sequence[float], factor: float = 1e-3) -> ScalarMappable:
    """Colours of loads, to be shown with a colour bar in the unit that `factor` leads to."""
    low, high = min(forces) * factor, max(forces) * factor
    if low == high:
        low, high = low - 1, high + 1
    return ScalarMappable(Normalize(low, high), COLOURS)


def note_simulated(drawn: Figure, simulated: bool) -> Figure:
    """Say on the figure itself when its records are simulated."""
    if simulated:
        drawn.suptitle(SIMULATED_NOTE, x=0.995, ha="right", fontsize=7, color=PUBLISHED)
    return drawn


def title_of_record(axis: Axes, attrs: Mapping[str, Any], more: str = "") -> None:
    """A record's name, mode and force; below, in brief, why it is bad if it is."""
    factor, unit, load = shown(attrs)
    said = f", {factor * value_of(attrs):.2f} {unit}" if load else ""
    name = f"{attrs['record']}: mode {attrs['mode']}{said}{more}"
    reason = textwrap.fill(attrs["reason"], 92, max_lines=2, placeholder=" ...")
    axis.set_title(f"{name}\n{reason}".strip(), loc="left", fontsize=8.5)


def plain_log_scale(axis, name: str = "y") -> None:
    """A logarithmic axis (`x` or `y`) with plain numbers, as many as the range can bear."""
    axis.set(**{f"{name}scale": "log"})
    line = getattr(axis, f"{name}axis")
    wide = np.ptp(np.log10(getattr(axis, f"get_{name}lim")())) > _WIDE_DECADES
    line.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0), numticks=_TICKS))
    line.set_minor_locator(NullLocator())
    line.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
