"""The blocks of a decay, joined into groups, and what a rate integrates to over them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray
from scipy.interpolate import CubicHermiteSpline

# Steps in a cell, the time from one group to the next, on which laws are integrated. An even number
# for Simpson's rule.
STEPS_PER_CELL = 4
LINE_FEWEST_GROUPS = 8  # groups through which a straight line is laid, at least

# The search for the amplitude up to which a record shows that it leaves a constant rate.
ONSETS_PER_E = 8  # onsets that are tried while the amplitude falls by a factor of e
NARROWEST_WINDOW = 0.4  # ln A from the smallest amplitude to a window's top, at least
WINDOW_FEWEST_GROUPS = 10  # groups in a window, at least


@dataclass(frozen=True)
class Segment:
    """Groups of blocks in time order; `y` holds log-amplitude and phase, `log` ln A for the laws.

    `width` is the variance of the times in a group, whose mean is not the value at its middle.
    `path` is ln A at the groups and at `STEPS_PER_CELL` - 1 even steps in time between each two.
    """

    time: Float[ndarray, " group"]
    y: Float[ndarray, "2 group"]
    std: Float[ndarray, " group"]
    width: Float[ndarray, " group"]
    path: Float[ndarray, " step"]

    @property
    def log(self) -> Float[ndarray, " group"]:
        """Ln A at the groups."""
        return self.path[::STEPS_PER_CELL]

    def firsts_below(self, log: Float[ndarray, " value"]) -> Int[ndarray, " value"]:
        """The groups from which on amplitudes, given as ln A, are not exceeded any more."""
        return np.searchsorted(-np.maximum.accumulate(self.log[::-1])[::-1], -log - 1e-9)

    def below(self, log: float) -> "Segment":
        """The groups from which on an amplitude, given as ln A, is not exceeded any more."""
        first = int(self.firsts_below(np.array([log]))[0])
        return Segment(
            self.time[first:], self.y[:, first:], self.std[first:], self.width[first:],
            self.path[STEPS_PER_CELL * first :],
        )  # fmt: skip


def grouped(
    time: Float[ndarray, " block"],
    y: Float[ndarray, "2 block"],
    std: Float[ndarray, " block"],
    log: Float[ndarray, " block"],
    most: int = 200,
) -> Segment:
    """Neighbouring blocks joined so that every group falls by about the same in ln A."""
    fallen = np.maximum.accumulate(log[0] - log)
    step = max(fallen[-1] / most, 1e-9)
    start = np.flatnonzero(np.diff(np.floor(fallen / step), prepend=-1.0) > 0)
    weight = std**-2.0
    total = np.add.reduceat(weight, start)

    def mean(values: Float[ndarray, "*part block"]) -> Float[ndarray, "*part group"]:
        return np.add.reduceat(values * weight, start, axis=-1) / total

    centre = mean(time)
    width = np.maximum(mean(time**2) - centre**2, 0.0)
    number = np.arange(STEPS_PER_CELL * (centre.size - 1) + 1) / STEPS_PER_CELL
    steps = np.interp(number, np.arange(centre.size), centre)
    return Segment(centre, mean(y), total**-0.5, width, cubic(steps, time, log))


def cubic(
    at: Float[ndarray, " step"], time: Float[ndarray, " value"], y: Float[ndarray, " value"]
) -> Float[ndarray, " step"]:
    """Hermite's interpolation, which keeps bends that straight lines cut; level beyond the ends."""
    inside = np.clip(at, time[0], time[-1])
    return CubicHermiteSpline(time, y, np.gradient(y, time))(inside)


def over_cells(segment: Segment, rate: Float[ndarray, "law step"]) -> Float[ndarray, "law cell"]:
    """Mean over time from each group to the next, by Simpson's rule."""
    share = np.where(np.arange(STEPS_PER_CELL) % 2, 4.0, 2.0) / (3.0 * STEPS_PER_CELL)
    inner = rate[:, :-1].reshape(-1, segment.time.size - 1, STEPS_PER_CELL) @ share
    rate = rate[:, ::STEPS_PER_CELL]
    return inner + (rate[:, 1:] - rate[:, :-1]) / (3.0 * STEPS_PER_CELL)


def integral(segment: Segment, cells: Float[ndarray, "law cell"]) -> Float[ndarray, "law group"]:
    """Integral over time as the groups see it, zero at the record's end, from the cells' means."""
    length = np.diff(segment.time)
    gap = 0.5 * (length[1:] + length[:-1])
    total = np.empty((cells.shape[0], segment.time.size))
    np.subtract(cells[:, 1:], cells[:, :-1], out=total[:, 1:-1])
    total[:, 0], total[:, -1] = total[:, 1], total[:, -2]
    # what a change of the rate from cell to cell adds to the mean over a group
    total *= 0.5 * segment.width / np.concatenate([gap[:1], gap, gap[-1:]])
    total[:, :-1] -= np.cumsum((cells * length)[:, ::-1], axis=1)[:, ::-1]
    return total


def line_of(segment: Segment) -> tuple[Float[ndarray, "group 2"], Float[ndarray, " 2"]]:
    """Orthonormal basis of constants and straight lines in the whitened groups.

    Also the row by which a whitened series projected on that basis gives its slope in time.
    """
    scale = 1.0 / segment.std
    weight = scale**2
    from_middle = segment.time - (segment.time @ weight) / weight.sum()
    length = np.sqrt(np.array([weight.sum(), from_middle**2 @ weight]))
    return np.stack([scale, from_middle * scale], axis=1) / length, np.array([0.0, 1.0 / length[1]])


def lines_below(
    segment: Segment, onsets: Float[ndarray, " onset"]
) -> tuple[Float[ndarray, "2 onset"], Float[ndarray, " onset"]]:
    """Slopes of straight lines through the groups below each onset (ln A0), and their variance.

    The variance is infinite where they are fewer than `LINE_FEWEST_GROUPS`.
    """
    # the groups below an onset begin two after the last one above it, as the one between may hold
    # blocks from above
    first = np.minimum(segment.firsts_below(onsets) + 1, segment.time.size - LINE_FEWEST_GROUPS)
    weight = segment.std**-2.0
    time = segment.time - segment.time[-1]
    y = segment.y - segment.y[:, -1:]
    terms = np.stack([np.ones_like(time), time, time**2, *y, *(y * time)]) * weight
    one, t, tt, *rest = np.cumsum(terms[:, ::-1], axis=1)[:, ::-1][:, first]
    y, ty = np.stack(rest[:2]), np.stack(rest[2:])
    spread = np.maximum(tt - t**2 / one, 1e-300)
    few = segment.log[first - 1] > onsets
    return (ty - t * y / one) / spread, np.where(few, np.inf, 1.0 / spread)


def first_departure(segment: Segment, detection: float) -> float | None:
    """Smallest ln A up to which the record shows that it leaves a constant rate, or None.

    From the smallest amplitude upwards, windows of growing amplitude are tested for a straight
    hinge anywhere in them, against a chi-square gain of `detection` in either channel.
    """
    low, high = segment.log.min(), segment.log.max()
    onsets = np.linspace(low, high, max(ONSETS_PER_E, int(ONSETS_PER_E * (high - low)) + 1))
    tops = onsets[3:][onsets[3:] >= low + NARROWEST_WINDOW]
    first = segment.firsts_below(tops)
    enough = segment.time.size - first >= WINDOW_FEWEST_GROUPS
    tops, first = tops[enough], first[enough]
    hinges = np.maximum(0.0, np.exp(segment.path) * np.exp(-onsets)[:, None] - 1.0)
    x = integral(segment, over_cells(segment, hinges))
    line, _ = line_of(segment)
    y = segment.y - segment.y[:, -1:]
    y = y - (y / segment.std) @ line @ line.T * segment.std
    time = segment.time - segment.time[-1]

    def over(terms: Float[ndarray, "*part group"]) -> Float[ndarray, "*part window"]:
        """Weighted sums over the groups of each window."""
        return np.cumsum((terms * segment.std**-2.0)[..., ::-1], axis=-1)[..., ::-1][..., first]

    whole, late = over(np.ones_like(time)), over(time)
    spread = over(time**2) - late**2 / whole
    tilt = over(x * time) - over(x) * late / whole  # column, window
    square = over(x**2) - over(x) ** 2 / whole - tilt**2 / spread
    rise = over(y * time) - over(y) * late / whole  # channel, window
    both = over(y[:, None] * x) - over(y)[:, None] * over(x) / whole - rise[:, None] * tilt / spread
    # of the hinges below each window's top, those that bend in it
    square[onsets[:, None] >= tops] = 0.0
    seen = square > 1e-12 * square.max(axis=0)
    gain = np.where(seen, (both**2).max(axis=0) / np.where(seen, square, 1.0), 0.0).max(axis=0)
    shown = np.flatnonzero(gain > detection)
    return float(tops[shown[0]]) if shown.size else None
