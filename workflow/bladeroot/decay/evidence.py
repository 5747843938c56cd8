"""The evidence of laws on a stretch of a decay, and the rates that they give.

All unknowns of a law but its shape are linear (`bladeroot.decay.laws`), so its marginal likelihood
is closed, and hundreds of laws cost milliseconds.
"""

from dataclasses import dataclass, replace
from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int
from numba import njit
from numpy import ndarray

from bladeroot.decay.laws import DOUBT, HINGES, NODES, Laws, hat, hats
from bladeroot.decay.stretch import (
    FEWEST,
    Stretch,
    integral,
    integrate,
    lengths,
    line_of,
    lines_below,
)

PARTS = NODES + 1  # of a law: the factor's nodes, and ln(e)


@dataclass(frozen=True)
class Frame:
    """A stretch made ready: the data in standard errors, less a straight line in time.

    line, slope: the basis of such lines, and the row that gives their slope, as of `line_of`.
    rate and variance: the slopes of the data's own lines.
    """

    stretch: Stretch
    line: Float[ndarray, "group 2"]
    slope: Float[ndarray, " 2"]
    y: Float[ndarray, "2 group"]
    rate: Float[ndarray, " 2"]
    variance: float

    def seen(self, cells: Float[ndarray, "column cell"]) -> tuple[ndarray, ndarray]:
        """What rates, as means over the cells, make of the data, and of their lines' slopes."""
        x = integral(self.stretch, cells) / self.stretch.std
        on_line = x @ self.line
        return x - on_line @ self.line.T, on_line @ self.slope


def framed(stretch: Stretch) -> Frame:
    """A stretch with its data apart from a straight line."""
    line, slope = line_of(stretch)
    y = (stretch.y - stretch.y.mean(axis=1, keepdims=True)) / stretch.std
    on_line = y @ line
    rate = on_line @ slope
    return Frame(stretch, line, slope, y - on_line @ line.T, rate, float(slope @ slope))


@dataclass(frozen=True)
class Sums:
    """What the evidence of laws needs of the groups; all for unit excess.

    part: the nodes of the factor, and ln(e).
    `tilt`: what a law's size takes off the rate, at zero shape and at the smallest amplitude.
    """

    gram: Float[ndarray, "law part part"]
    right: Float[ndarray, "2 law part"]
    tilt: Float[ndarray, "2 law part"]
    rate: Float[ndarray, " 2"]
    variance: float
    groups: int

    def joined(self, other: "Sums") -> "Sums":
        """Both sets of laws, on the same groups."""
        return replace(
            self,
            gram=np.concatenate([self.gram, other.gram]),
            right=np.concatenate([self.right, other.right], axis=1),
            tilt=np.concatenate([self.tilt, other.tilt], axis=1),
        )

    def chosen(self, laws: Int[ndarray, " law"]) -> "Sums":
        """Some of the laws, in the order given."""
        return replace(
            self, gram=self.gram[laws], right=self.right[:, laws], tilt=self.tilt[:, laws]
        )


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
    stretch = frame.stretch
    gram, right, on_line = _projections(
        laws.shape, laws.between, laws.first, _middle(stretch), *lengths(stretch),
        1.0 / stretch.std, np.ascontiguousarray(frame.line.T), frame.y,
    )  # fmt: skip
    tilt = on_line @ frame.slope
    smallest = stretch.path[np.argmin(stretch.path)]
    lowest = np.zeros_like(tilt)
    lowest[:, :NODES] = laws.lowest[:, None] * hats(np.array([smallest]), laws.first)[..., 0]
    tilt = np.stack([tilt, tilt - lowest])
    return Sums(gram, right, tilt, frame.rate, frame.variance, stretch.time.size)


@njit(cache=True, error_model="numpy", fastmath=True)
@no_type_check
def _projections(
    shape: Float[ndarray, "law cell"],
    between: Float[ndarray, "law cell"],
    first: Float[ndarray, " law"],
    log: Float[ndarray, " cell"],
    length: Float[ndarray, " cell"],
    bend: Float[ndarray, " group"],
    scale: Float[ndarray, " group"],
    line: Float[ndarray, "2 group"],
    y: Float[ndarray, "2 group"],
) -> tuple[
    Float[ndarray, "law part part"], Float[ndarray, "2 law part"], Float[ndarray, "law part 2"]
]:
    """Products of the laws' whitened columns less their lines; with the data; with the lines."""
    laws, groups = shape.shape[0], scale.size
    gram = np.empty((laws, PARTS, PARTS))
    right = np.empty((2, laws, PARTS))
    on_line = np.empty((laws, PARTS, 2))
    x = np.empty((PARTS, groups))
    cells = np.empty(groups - 1)
    for law in range(laws):
        for part in range(PARTS):
            if part < NODES:
                for cell in range(groups - 1):
                    cells[cell] = shape[law, cell] * hat(log[cell], first[law], part)
            else:
                cells[:] = between[law]
            integrate(cells, length, bend, x[part])
            one = two = 0.0
            for group in range(groups):
                x[part, group] *= scale[group]
                one += x[part, group] * line[0, group]
                two += x[part, group] * line[1, group]
            on_line[law, part, 0], on_line[law, part, 1] = one, two
            for group in range(groups):
                x[part, group] -= one * line[0, group] + two * line[1, group]
            one = two = 0.0
            for group in range(groups):
                one += x[part, group] * y[0, group]
                two += x[part, group] * y[1, group]
            right[0, law, part], right[1, law, part] = one, two
            for other in range(part + 1):
                one = 0.0
                for group in range(groups):
                    one += x[part, group] * x[other, group]
                gram[law, part, other] = gram[law, other, part] = one
    return gram, right, on_line


def fits(found: Sums, channel: int, excess: float) -> Fits:
    """Evidence and rates of all laws on a channel; all variances are `excess` times the stated.

    The size c has a prior as wide as its estimate, or as what one group could tell about it.
    """
    right = np.ascontiguousarray(found.right[channel])
    evidence, size, spread = _marginal(
        found.gram / excess, right / excess, found.tilt, found.groups, np.array(DOUBT)
    )
    tilted = np.einsum("ldp,rlp->rld", size, found.tilt)
    variance = excess * found.variance + spread
    return Fits(evidence, found.rate[channel] - tilted, variance, size)


@njit(cache=True, error_model="numpy")
@no_type_check
def _marginal(
    gram: Float[ndarray, "law part part"],
    right: Float[ndarray, "law part"],
    tilt: Float[ndarray, "2 law part"],
    groups: int,
    doubts: Float[ndarray, " doubt"],
) -> tuple[
    Float[ndarray, "law doubt"], Float[ndarray, "law doubt part"], Float[ndarray, "2 law doubt"]
]:
    """ln of the marginal likelihood, mean coefficients, and what their errors do to `tilt`.

    The coefficients are T z with z ~ N(0, 1): the first of z is the size c, alike in all nodes, the
    others are each node's own and that of ln(e). The posterior of z has the precision
    1 + T' gram T, which is factored as L L'.
    """
    laws = right.shape[0]
    evidence = np.empty((laws, doubts.size))
    size = np.empty((laws, doubts.size, PARTS))
    spread = np.empty((2, laws, doubts.size))
    low = np.empty((PARTS + 1, PARTS + 1))
    z = np.empty((3, PARTS + 1))  # of the data, and of both rows of `tilt`
    squares = np.empty(3)
    for law in range(laws):
        whole, along = 1e-300, 0.0
        for a in range(NODES):
            along += right[law, a]
            for b in range(NODES):
                whole += gram[law, a, b]
        square = (along / whole) ** 2
        wide = max(square, groups / whole)
        for doubt in range(doubts.size):
            common = np.sqrt(wide)
            own = np.sqrt(square * doubts[doubt] ** 2 + 1e-12 * wide)
            low[0, 0] = 1.0 + wide * whole
            z[0, 0], z[1, 0], z[2, 0] = common * along, 0.0, 0.0
            for a in range(PARTS):
                row = 0.0
                for b in range(NODES):
                    row += gram[law, a, b]
                low[a + 1, 0] = common * own * row
                for b in range(a + 1):
                    low[a + 1, b + 1] = own * own * gram[law, a, b]
                low[a + 1, a + 1] += 1.0
                z[0, a + 1] = own * right[law, a]
                for k in range(2):
                    z[k + 1, a + 1] = own * tilt[k, law, a]
                    if a < NODES:
                        z[k + 1, 0] += common * tilt[k, law, a]
            determinant = 1.0
            squares[:] = 0.0
            for a in range(PARTS + 1):
                for b in range(a + 1):
                    value = low[a, b]
                    for c in range(b):
                        value -= low[a, c] * low[b, c]
                    low[a, b] = np.sqrt(value) if a == b else value / low[b, b]
                determinant *= low[a, a]
                for k in range(3):
                    value = z[k, a]
                    for b in range(a):
                        value -= low[a, b] * z[k, b]
                    z[k, a] = value / low[a, a]
                    squares[k] += z[k, a] ** 2
            evidence[law, doubt] = 0.5 * squares[0] - np.log(determinant)
            spread[0, law, doubt], spread[1, law, doubt] = squares[1], squares[2]
            for a in range(PARTS, -1, -1):
                for b in range(a + 1, PARTS + 1):
                    z[0, a] -= low[b, a] * z[0, b]
                z[0, a] /= low[a, a]
            for a in range(PARTS):
                shared = common * z[0, 0] if a < NODES else 0.0
                size[law, doubt, a] = shared + own * z[0, a + 1]
    return evidence, size, spread


def misfit(
    frame: Frame, law: Laws, size: Float[ndarray, " part"], channel: int
) -> Float[ndarray, " group"]:
    """What one law leaves over of a channel, in stated standard errors."""
    factor = size[:NODES] @ hats(_middle(frame.stretch), law.first)[0]
    cells = factor * law.shape + size[NODES] * law.between
    return frame.y[channel] - frame.seen(cells)[0][0]


def excess_variance(rest: Float[ndarray, " group"]) -> float:
    """By how much a misfit exceeds the stated variances; what is alike in neighbouring groups
    counts as the fewer independent ones that it is.
    """
    square = (rest**2).sum()
    alike = (rest[1:] * rest[:-1]).sum() / square - 2.0 / np.sqrt(rest.size)
    alike = float(np.clip(alike, 0.0, 0.98))
    return max(1.0, float(square) / max(rest.size - 4, 1)) * (1.0 + alike) / (1.0 - alike)


def with_lines_below(
    found: Fits, stretch: Stretch, onsets: Float[ndarray, " onset"], channel: int
) -> Fits:
    """The same, but for laws with an onset: their rates by a straight line below it.

    What happens above tells where the constant ends. For the rate itself no law is exact enough,
    as there it may stand out of the noise a million times.
    """
    slope, variance = lines_below(stretch, onsets)
    hinges = slice(found.evidence.shape[0] - HINGES * onsets.size, None)
    best = onsets[int(np.argmax(found.evidence[hinges].max(axis=1))) // HINGES]
    under = stretch.below(best)
    if under.time.size >= FEWEST:
        variance = variance * excess_variance(framed(under).y[channel])
    known = np.repeat(np.isfinite(variance), HINGES)[:, None]
    rate, spread = found.rate.copy(), found.variance.copy()
    for values, line in ((rate, slope[channel]), (spread, variance)):
        values[:, hinges] = np.where(known, np.repeat(line, HINGES)[:, None], values[:, hinges])
    return replace(found, rate=rate, variance=spread)


def _middle(stretch: Stretch) -> Float[ndarray, " cell"]:
    """Ln A in the cells."""
    return 0.5 * (stretch.log[1:] + stretch.log[:-1])
