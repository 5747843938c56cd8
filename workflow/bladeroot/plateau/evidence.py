"""The evidence of laws on a segment of a decay, and the rates that they give.

All unknowns of a law but its shape are linear (`bladeroot.plateau.laws`), so its marginal
likelihood is closed, and hundreds of laws cost milliseconds.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.plateau.laws import (
    BENDING_POWERS,
    DOUBT_STDS,
    FACTOR_NODES,
    FLAT_POWERS,
    HINGE_SHAPES,
    Laws,
    PerLaw,
    hats,
)
from bladeroot.plateau.segment import LINE_FEWEST_GROUPS, Segment, integral, line_of, lines_below


@dataclass(frozen=True)
class Frame:
    """A segment made ready: the data in standard errors, less a straight line in time.

    line, slope: the basis of such lines, and the row that gives their slope, as of `line_of`.
    rate and variance: the slopes of the data's own lines.
    """

    segment: Segment
    line: Float[ndarray, "group 2"]
    slope: Float[ndarray, " 2"]
    y: Float[ndarray, "2 group"]
    rate: Float[ndarray, " 2"]
    variance: float

    def seen(self, cells: Float[ndarray, "column cell"]) -> tuple[ndarray, ndarray]:
        """What rates, as means over the cells, make of the data, and of their lines' slopes."""
        x = integral(self.segment, cells)
        x /= self.segment.std
        on_line = x @ self.line
        x -= on_line @ self.line.T
        return x, on_line @ self.slope


def framed(segment: Segment) -> Frame:
    """A segment with its data apart from a straight line."""
    line, slope = line_of(segment)
    y = (segment.y - segment.y.mean(axis=1, keepdims=True)) / segment.std
    on_line = y @ line
    rate = on_line @ slope
    return Frame(segment, line, slope, y - on_line @ line.T, rate, float(slope @ slope))


@dataclass(frozen=True)
class Sums(PerLaw):
    """What the evidence of laws needs of the groups; all for unit excess.

    part: the nodes of the factor, and ln(e). `axis`: principal axes of a law's whitened columns,
    less their lines, in the parts' coefficients; `square`: their squares. On these axes: `alike`,
    the size c; `right`, the data; `tilt`, what the coefficients take off the rate, at zero shape
    and at the smallest amplitude.
    """

    axis: Float[ndarray, "law part axis"]
    square: Float[ndarray, "law axis"]
    alike: Float[ndarray, "law axis"]
    right: Float[ndarray, "law 2 axis"]
    tilt: Float[ndarray, "law 2 axis"]


@dataclass(frozen=True)
class Fits:
    """Each law with each of the doubts on one channel.

    `evidence`: ln of the marginal likelihood over that of a constant rate. `rate`: where the shape
    is zero, and at the smallest amplitude, with `variance`, its square error. `size`: the
    coefficients of the factor's nodes and of ln(e).
    """

    evidence: Float[ndarray, "law doubt"]
    rate: Float[ndarray, "2 law doubt"]
    variance: Float[ndarray, "2 law doubt"]
    size: Float[ndarray, "law doubt part"]


def sums(frame: Frame, laws: Laws) -> Sums:
    """Projections of each law's columns on one another and on the data."""
    segment = frame.segment
    cells = np.empty((laws.first.size, FACTOR_NODES + 1, laws.shape.shape[1]))
    np.multiply(
        laws.shape[:, None], hats(_middle(segment), laws.first), out=cells[:, :FACTOR_NODES]
    )
    cells[:, FACTOR_NODES] = laws.between
    x, tilt = frame.seen(cells.reshape(-1, cells.shape[-1]))
    x, tilt = x.reshape(*cells.shape[:2], -1), tilt.reshape(cells.shape[:2])
    square, axis = np.linalg.eigh(x @ x.swapaxes(1, 2))
    smallest = segment.path[np.argmin(segment.path)]
    lowest = np.zeros_like(tilt)
    lowest[:, :FACTOR_NODES] = laws.lowest[:, None] * hats(np.array([smallest]), laws.first)[..., 0]
    on_axes = (
        np.stack([*(x @ frame.y.T).transpose(2, 0, 1), tilt, tilt - lowest])[:, :, None] @ axis
    )
    right, tilt = np.split(on_axes[:, :, 0].swapaxes(0, 1), 2, axis=1)
    alike = axis[:, :FACTOR_NODES].sum(axis=1)
    return Sums(axis, np.maximum(square, 0.0), alike, right, tilt)


def fits(frame: Frame, found: Sums, channel: int, excess: float) -> Fits:
    """Evidence and rates of all laws on a channel; all variances are `excess` times the stated.

    A node's coefficient is the size c and a part of its own, that of ln(e) a part of its own. The
    size has a prior as wide as its estimate, or as what one group could tell about it. The parts
    are independent, and so are the axes; the size joins them in one direction (Sherman, Morrison).
    """
    square, right = found.square / excess, found.right[:, channel] / excess
    alike, tilt = found.alike[:, None], found.tilt.swapaxes(0, 1)[:, :, None]
    whole = (found.alike**2 * square).sum(axis=-1, keepdims=True) + 1e-300
    size = ((found.alike * right).sum(axis=-1, keepdims=True) / whole) ** 2
    wide = np.maximum(size, frame.segment.time.size / whole)
    own = (size * np.array(DOUBT_STDS) ** 2 + 1e-12 * wide)[..., None]
    square, right = square[:, None], right[:, None]
    narrowed = 1.0 / (1.0 + own * square)
    known = 1.0 + wide * (alike**2 * square * narrowed).sum(axis=-1)
    shared = wide * (alike * right * narrowed).sum(axis=-1) / known
    evidence = 0.5 * (
        (own * right**2 * narrowed).sum(axis=-1)
        + known * shared**2 / wide
        - np.log(known)
        + np.log(narrowed).sum(axis=-1)
    )
    mean = own * narrowed * (right - square * alike * shared[..., None]) + alike * shared[..., None]
    spread = (own * tilt**2 * narrowed).sum(axis=-1)
    spread += wide / known * (tilt * alike * narrowed).sum(axis=-1) ** 2
    return Fits(
        evidence,
        frame.rate[channel] - (tilt * mean).sum(axis=-1),
        excess * frame.variance + spread,
        mean @ found.axis.swapaxes(1, 2),
    )


def misfit(
    frame: Frame, laws: Laws, law: int, size: Float[ndarray, " part"], channel: int
) -> Float[ndarray, " group"]:
    """What one law leaves over of a channel, in stated standard errors."""
    factor = size[:FACTOR_NODES] @ hats(_middle(frame.segment), laws.first[[law]])[0]
    cells = factor * laws.shape[[law]] + size[FACTOR_NODES] * laws.between[[law]]
    return frame.y[channel] - frame.seen(cells)[0][0]


def excess_variance(rest: Float[ndarray, " group"]) -> float:
    """By how much a misfit exceeds the stated variances.

    Misfits that are alike in neighbouring groups count as fewer independent ones.
    """
    square = (rest**2).sum()
    alike = (rest[1:] * rest[:-1]).sum() / square - 2.0 / np.sqrt(rest.size)
    alike = float(np.clip(alike, 0.0, 0.98))
    return max(1.0, float(square) / max(rest.size - 4, 1)) * (1.0 + alike) / (1.0 - alike)


def with_lines_below(
    found: Fits, segment: Segment, onsets: Float[ndarray, " onset"], channel: int
) -> Fits:
    """The same, but for laws that reach a constant: their rates by a straight line where they do.

    What happens above tells where the constant ends: at a hinge's onset, and where a flat law is
    nearer to its limit than such a line tells. For the rate itself no law is exact enough: above
    the onset it may exceed the noise a million times.
    """
    slope, variance = lines_below(segment, onsets)
    hinges = slice(found.evidence.shape[0] - HINGE_SHAPES * onsets.size, None)
    best = onsets[int(np.argmax(found.evidence[hinges].max(axis=1))) // HINGE_SHAPES]
    under = segment.below(best)
    if under.time.size >= LINE_FEWEST_GROUPS:
        variance = variance * excess_variance(framed(under).y[channel])
    known = np.repeat(np.isfinite(variance), HINGE_SHAPES)[:, None]
    rate, spread = found.rate.copy(), found.variance.copy()
    for values, line in ((rate, slope[channel]), (spread, variance)):
        values[:, hinges] = np.where(
            known, np.repeat(line, HINGE_SHAPES)[:, None], values[:, hinges]
        )
    for law, power in enumerate(FLAT_POWERS, len(BENDING_POWERS)):
        lost = found.size[law, :, 0] * np.exp(power * (onsets[:, None] - segment.path.max()))
        within = (lost**2 < variance[:, None]) & np.isfinite(variance)[:, None]
        end = np.where(within, np.arange(onsets.size)[:, None], -1).max(axis=0)
        for doubt in np.flatnonzero(end >= 0):
            rate[:, law, doubt] = slope[channel, end[doubt]]
            spread[:, law, doubt] = variance[end[doubt]] + lost[end[doubt], doubt] ** 2
    return replace(found, rate=rate, variance=spread)


def _middle(segment: Segment) -> Float[ndarray, " cell"]:
    """Ln A in the cells."""
    return 0.5 * (segment.log[1:] + segment.log[:-1])
