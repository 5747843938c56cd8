"""A chart as data: panels and traces, from which the page's live figure and its still are made."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr
from numpy import ndarray

# Points of curves are drawn up to these relative standard errors; the artifacts hold them all.
LARGEST_ERRORS = {"frequency": 1e-3, "loss_factor": 0.2}
AMPLITUDE = "amplitude at the sensor / µm"
NOTHING = "nothing to draw"
_MOST_POINTS = 100  # of a curve: more are closer together than a pixel, and make the page larger


@dataclass(frozen=True)
class Panel:
    """A pair of axes: what stands above it and at it.

    x_ticks: names of the places 0, 1, ... where x counts things; band: limits of a grey strip.
    """

    title: str
    x: str
    y: str
    x_log: bool = False
    y_log: bool = False
    x_ticks: Sequence[str] = ()
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    zero: bool = False
    band: tuple[float, float] | None = None


@dataclass(frozen=True)
class Trace:
    """Points of one thing in one panel, NaN where nothing is known.

    line: "-", "--", ":" or "". marker: "o", "s", "D", "^", "v" or "". error, x_error: a standard
    deviation to both sides. low, high: a band instead of points. values: a number a point, which
    its colour shows. texts: a name a point, in place of that of all. kind: what the legend calls
    all such traces. switches: what the reader may switch off, by name.
    """

    panel: int
    x: ndarray
    y: ndarray | None = None
    name: str = ""
    colour: str = "#1b3a5c"
    line: str = ""
    marker: str = ""
    hollow: bool = False
    error: ndarray | None = None
    x_error: ndarray | None = None
    low: ndarray | None = None
    high: ndarray | None = None
    values: ndarray | None = None
    texts: Sequence[str] = ()
    kind: str = ""
    switches: Mapping[str, str] = field(default_factory=dict)
    width: float = 1.2
    size: float = 4.0
    opacity: float = 1.0


@dataclass(frozen=True)
class Chart:
    """Panels in rows of `columns`, their traces, and the one place of the caption.

    colours: the first switch whose options have colours of their own. scale: what `values` are, and
    the limit of their colours to both sides. warning: what must be read with the picture.
    """

    caption: str
    panels: Sequence[Panel]
    traces: Sequence[Trace]
    columns: int = 2
    colours: str = ""
    scale: tuple[str, float] | None = None
    simulated: bool = False
    warning: str = ""


def options(chart: Chart) -> dict[str, dict[str, list[Trace]]]:
    """What may be switched: of each switch its options with their traces, where there are two."""
    found: dict[str, dict[str, list[Trace]]] = {}
    for trace in chart.traces:
        for switch, option in trace.switches.items():
            found.setdefault(switch, {}).setdefault(option, []).append(trace)
    return {switch: several for switch, several in found.items() if len(several) > 1}


def empty(chart: Chart) -> set[int]:
    """Panels without a point."""
    full = {trace.panel for trace in chart.traces if _points(trace).any()}
    return set(range(len(chart.panels))) - full


def _points(trace: Trace) -> ndarray:
    heights = trace.y if trace.low is None else trace.low + trace.high
    return np.isfinite(np.asarray(trace.x, float)) & np.isfinite(np.asarray(heights, float))


def runs(known: ndarray) -> list[slice]:
    """Runs of consecutive known points."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
    return [slice(first, last) for first, last in edges.reshape(-1, 2)]


def thinned(count: int) -> ndarray:
    """Indices of at most as many points as can be seen apart, evenly, with both ends."""
    return np.unique(np.linspace(0, count - 1, min(count, _MOST_POINTS)).round().astype(int))


def sure(curves: xr.Dataset, name: str) -> ndarray:
    """Values of a curve, NaN where their relative standard error exceeds what is drawn.

    Of a mean curve that is the error of its course: how well its level is known does not hide it.
    """
    value = curves[name].values
    std = curves[f"{name}_change_std" if f"{name}_change_std" in curves else f"{name}_std"].values
    known = std < LARGEST_ERRORS[name] * np.abs(value)
    return np.where(known, value, np.nan)
