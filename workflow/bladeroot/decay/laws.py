"""Laws by which a decay's rates may depend on amplitude, and the evidence of each.

A rate (of phase or of log-amplitude) is rate0 + c h(A) m(A): a shape h with a size c, and a factor
m, which is one within some per cent because no law of slip is known better than that. m is straight
in ln A between nodes; its values there are independent about one with a standard deviation
(`DOUBT`) that is itself weighed by the evidence. Above an onset d ln(e) is added, with d as much in
doubt about zero, as no exponent is known exactly either. All unknowns but the shape's are linear,
so the marginal likelihood of a shape is closed, and hundreds of them cost milliseconds.

Shapes, with e = max(0, A/A0 - 1): hinges at an onset A0, which are e^p, 1 - A0/A, and stiffness
and damping of a Coulomb slider (3.19; near its critical amplitude it softens like e^(3/2) and damps
like e); flat laws A^p with p >= 2, whose limit is a plateau for all purposes; and laws that bend
all the way down, A^p with smaller p and ln A.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.decay.stretch import (
    FEWEST,
    Stretch,
    integral,
    line_of,
    lines_below,
    over_cells,
)

DOUBT = (0.01, 0.1, 0.4)
NODES, NODE_STEP = 4, 0.7  # nodes of the factor, and their distance in ln A: half to double
BENDING = (0.0, 0.25, 0.5, 0.75, 1.0, 1.3, 1.6)  # 0: logarithmic
FLAT = (2.0, 2.5, 3.0)
HINGES = 7  # shapes at one onset


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

    def seen(self, cells: Float[ndarray, "cell column"]) -> tuple[ndarray, ndarray]:
        """What integrals over the cells make of the data, and of their lines' slopes."""
        x = integral(self.stretch, cells) / self.stretch.std[:, None]
        on_line = self.line.T @ x
        return x - self.line @ on_line, self.slope @ on_line


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


@dataclass(frozen=True)
class Shapes:
    """Shapes along a path, the same times ln(e), and ln A of the factor's lowest node."""

    shape: Float[ndarray, "step law"]
    between: Float[ndarray, "step law"]
    first: Float[ndarray, " law"]

    def joined(self, other: "Shapes") -> "Shapes":
        """Both sets of laws, on the same path."""
        return Shapes(
            np.hstack([self.shape, other.shape]),
            np.hstack([self.between, other.between]),
            np.concatenate([self.first, other.first]),
        )

    def one(self, law: int) -> "Shapes":
        """A single law."""
        here = slice(law, law + 1)
        return Shapes(self.shape[:, here], self.between[:, here], self.first[here])


def smooth_shapes(stretch: Stretch) -> Shapes:
    """Shapes without an onset, `BENDING` then `FLAT`.

    The logarithm is zero at the smallest amplitude, as it has no limit; the others at A = 0.
    """
    high = stretch.path.max()
    power = np.array(BENDING + FLAT)
    log = stretch.path - stretch.path.min()
    shape = np.where(power > 0.0, np.exp(np.outer(stretch.path - high, power)), log[:, None])
    first = np.full(power.size, high - (NODES - 1) * NODE_STEP)
    return Shapes(shape, np.zeros_like(shape), first)


def hinge_shapes(stretch: Stretch, onsets: Float[ndarray, " onset"]) -> Shapes:
    """`HINGES` shapes at each onset (ln A0), which are also their lowest nodes."""
    e = np.maximum(0.0, np.exp(stretch.path[:, None] - onsets) - 1.0)
    root = np.sqrt(e)
    s = e / (1.0 + e)
    # 3.19: with theta = pi - theta_B, the stiffness lost is (theta - sin(2 theta) / 2) / pi
    theta = 2.0 * np.arctan(root)
    lost = theta - np.sin(theta) * np.cos(theta)
    shape = np.stack([np.sqrt(e * root), e, e * root, e * e, s, s * (1.0 - s), lost], axis=2)
    between = shape * np.log(np.maximum(e, 1e-300))[..., None]
    flat = (e.shape[0], -1)
    return Shapes(shape.reshape(flat), between.reshape(flat), np.repeat(onsets, HINGES))


def sums(frame: Frame, laws: Shapes) -> Sums:
    """Projections of each law's columns on one another and on the data."""
    x, tilt = frame.seen(_cells(frame.stretch, laws))
    x = x.reshape(frame.y.shape[1], NODES + 1, -1).transpose(2, 1, 0)
    smallest = int(np.argmin(frame.stretch.path))
    hats = _hats(frame.stretch.path[smallest : smallest + 1], laws.first)[0]
    lowest = np.vstack([laws.shape[smallest] * hats, laws.between[smallest]])
    tilt = tilt.reshape(NODES + 1, -1)
    tilt = np.stack([tilt, tilt - lowest]).transpose(0, 2, 1)
    right = np.stack([x @ row for row in frame.y])
    return Sums(x @ x.transpose(0, 2, 1), right, tilt, frame.rate, frame.variance, x.shape[2])


def fits(found: Sums, channel: int, excess: float) -> Fits:
    """Evidence and rates of all laws on a channel; all variances are `excess` times the stated.

    The size c has a prior as wide as its estimate, or as what one group could tell about it.
    """
    gram, right = found.gram / excess, found.right[channel] / excess
    whole = np.maximum(gram[:, :NODES, :NODES].sum(axis=(1, 2)), 1e-300)
    size2 = (right[:, :NODES].sum(axis=1) / whole) ** 2
    wide = np.maximum(size2, found.groups / whole)
    free = size2[:, None] * np.square(DOUBT) + 1e-12 * wide[:, None]
    alike = np.zeros((NODES + 1, NODES + 1))
    alike[:NODES, :NODES] = 1.0
    own = np.eye(NODES + 1)
    prior = wide[:, None, None, None] * alike + free[:, :, None, None] * own
    core = own + gram[:, None] @ prior
    posterior = prior @ np.linalg.inv(core)
    size = (posterior @ right[:, None, :, None])[..., 0]
    evidence = 0.5 * (size * right[:, None]).sum(axis=-1) - 0.5 * np.linalg.slogdet(core)[1]
    tilt = found.tilt[:, :, None]
    spread = ((posterior @ tilt[..., None])[..., 0] * tilt).sum(axis=-1)
    return Fits(
        evidence,
        found.rate[channel] - (size * tilt).sum(axis=-1),
        excess * found.variance + np.maximum(spread, 0.0),
        size,
    )


def misfit(
    frame: Frame, law: Shapes, size: Float[ndarray, " part"], channel: int
) -> Float[ndarray, " group"]:
    """What one law leaves over of a channel, in stated standard errors."""
    cells = _cells(frame.stretch, law) @ size
    return frame.y[channel] - frame.seen(cells[:, None])[0][:, 0]


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


def _cells(stretch: Stretch, laws: Shapes) -> Float[ndarray, "cell column"]:
    """Integrals over the cells by part, then law: shapes times the factor's hats, and `between`."""
    middle = 0.5 * (stretch.log[1:] + stretch.log[:-1])
    columns = _hats(middle, laws.first) * over_cells(stretch, laws.shape)[:, None]
    return np.hstack([columns.reshape(middle.size, -1), over_cells(stretch, laws.between)])


def _hats(
    log: Float[ndarray, " value"], first: Float[ndarray, " law"]
) -> Float[ndarray, "value node law"]:
    """The factor's part that belongs to each of its nodes."""
    node = np.clip((log[:, None] - first) / NODE_STEP, 0, NODES - 1)
    return np.maximum(0.0, 1.0 - np.abs(node[:, None] - np.arange(NODES)[:, None]))
