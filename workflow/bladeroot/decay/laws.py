"""Laws by which a decay's rates may depend on amplitude, and the evidence of each.

A rate (of phase or of log-amplitude) is rate0 + c h(A) m(A): a shape h with a size c, and a factor
m, which is one within some per cent because no law of slip is known better than that. m is straight
in ln A between nodes; its values there are independent about one with a standard deviation
(`DOUBT`) that is itself weighed by the evidence. All unknowns but the shape's are linear, so the
marginal likelihood of a shape is closed, and hundreds of them cost milliseconds.

Shapes, with e = max(0, A/A0 - 1): hinges at an onset A0, which are e^p, 1 - A0/A, and stiffness
and damping of a Coulomb slider (3.19; near its critical amplitude it softens like e^(3/2) and damps
like e); flat laws A^p with p >= 2, whose limit is a plateau for all purposes; and laws that bend
all the way down, A^p with smaller p and ln A.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.decay.stretch import Stretch, integral, line_of

DOUBT = (0.01, 0.1, 0.4)
NODES, NODE_STEP = 4, 0.7  # nodes of the factor, and their distance in ln A: half to double
BENDING = (0.0, 0.25, 0.5, 0.75, 1.0, 1.3, 1.6)  # 0: logarithmic
FLAT = (2.0, 2.5, 3.0)
HINGES = 7  # shapes at one onset


@dataclass(frozen=True)
class Frame:
    """A stretch made ready: what its rates integrate to, in standard errors, a line aside.

    operator: from rates at the groups to that. slope: the same rates' part in the line's slope.
    y: the data in the same terms; rate and variance: the slopes of their own lines.
    """

    stretch: Stretch
    operator: Float[ndarray, "group group"]
    slope: Float[ndarray, " group"]
    y: Float[ndarray, "2 group"]
    rate: Float[ndarray, " 2"]
    variance: float


def framed(stretch: Stretch) -> Frame:
    """Operator and data of a stretch."""
    q, slope = line_of(stretch)
    y = (stretch.y - stretch.y.mean(axis=1, keepdims=True)) / stretch.std
    operator = integral(stretch, np.eye(stretch.time.size)) / stretch.std[:, None]
    on_line = q.T @ operator
    return Frame(
        stretch, operator - q @ on_line, slope @ on_line, y - (y @ q) @ q.T, (y @ q) @ slope,
        float(slope @ slope),
    )  # fmt: skip


@dataclass(frozen=True)
class Sums:
    """What the evidence of laws needs of the groups; all for unit excess.

    `tilt`: what a law's size takes off the rate, at zero shape and at the smallest amplitude.
    """

    gram: Float[ndarray, "law node node"]
    right: Float[ndarray, "2 law node"]
    tilt: Float[ndarray, "2 law node"]
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
    coefficients at the factor's nodes.
    """

    evidence: Float[ndarray, "law doubt"]
    rate: Float[ndarray, "2 law doubt"]
    variance: Float[ndarray, "2 law doubt"]
    size: Float[ndarray, "law doubt node"]


def smooth_shapes(
    stretch: Stretch,
) -> tuple[Float[ndarray, "group law"], Float[ndarray, " law"]]:
    """Shapes without an onset, `BENDING` then `FLAT`, and ln A of each one's lowest node.

    The logarithm is zero at the smallest amplitude, as it has no limit; the others at A = 0.
    """
    high = stretch.log.max()
    power = np.array(BENDING + FLAT)
    log = stretch.log - stretch.log.min()
    shape = np.where(power > 0.0, np.exp(np.outer(stretch.log - high, power)), log[:, None])
    return shape, np.full(power.size, high - (NODES - 1) * NODE_STEP)


def hinge_shapes(
    stretch: Stretch, onsets: Float[ndarray, " onset"]
) -> tuple[Float[ndarray, "group law"], Float[ndarray, " law"]]:
    """`HINGES` shapes at each onset (ln A0), which are also their lowest nodes."""
    e = np.maximum(0.0, np.exp(stretch.log[:, None] - onsets) - 1.0)
    root = np.sqrt(e)
    s = e / (1.0 + e)
    # 3.19: with theta = pi - theta_B, the stiffness lost is (theta - sin(2 theta) / 2) / pi
    theta = 2.0 * np.arctan(root)
    lost = theta - np.sin(theta) * np.cos(theta)
    shapes = [np.sqrt(e * root), e, e * root, e * e, s, s * (1.0 - s), lost]
    return np.stack(shapes, axis=2).reshape(e.shape[0], -1), np.repeat(onsets, HINGES)


def sums(frame: Frame, shape: Float[ndarray, "group law"], first: Float[ndarray, " law"]) -> Sums:
    """Projections of each law's columns on one another and on the data."""
    rates = _rates(frame.stretch, shape, first)
    lowest = rates[int(np.argmin(frame.stretch.log))]
    x = (frame.operator @ rates).reshape(frame.slope.size, NODES, -1).transpose(2, 1, 0)
    tilt = frame.slope @ rates
    tilt = np.stack([tilt, tilt - lowest]).reshape(2, NODES, -1).transpose(0, 2, 1)
    right = np.stack([x @ row for row in frame.y])
    return Sums(x @ x.transpose(0, 2, 1), right, tilt, frame.rate, frame.variance, frame.slope.size)


def fits(found: Sums, channel: int, excess: float) -> Fits:
    """Evidence and rates of all laws on a channel; all variances are `excess` times the stated.

    The size c has a prior as wide as its estimate, or as what one group could tell about it.
    """
    gram, right = found.gram / excess, found.right[channel] / excess
    whole = np.maximum(gram.sum(axis=(1, 2)), 1e-300)
    size2 = (right.sum(axis=1) / whole) ** 2
    wide = np.maximum(size2, found.groups / whole)
    free = size2[:, None] * np.square(DOUBT) + 1e-12 * wide[:, None]
    prior = wide[:, None, None, None] + free[:, :, None, None] * np.eye(NODES)
    core = np.eye(NODES) + gram[:, None] @ prior
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


def excess_variance(
    frame: Frame,
    shape: Float[ndarray, "group 1"],
    first: Float[ndarray, " 1"],
    size: Float[ndarray, " node"],
    channel: int,
) -> float:
    """By how much the misfit of a law exceeds the stated variances; what is alike in neighbouring
    groups counts as the fewer independent ones that it is.
    """
    rest = frame.y[channel] - frame.operator @ (_rates(frame.stretch, shape, first) @ size)
    square = (rest**2).sum()
    alike = (rest[1:] * rest[:-1]).sum() / square - 2.0 / np.sqrt(rest.size)
    alike = float(np.clip(alike, 0.0, 0.98))
    return max(1.0, float(square) / max(rest.size - 4, 1)) * (1.0 + alike) / (1.0 - alike)


def _rates(
    stretch: Stretch, shape: Float[ndarray, "group law"], first: Float[ndarray, " law"]
) -> Float[ndarray, "group column"]:
    """Each shape times each hat of the factor (node by node, then law)."""
    node = np.clip((stretch.log[:, None] - first) / NODE_STEP, 0, NODES - 1)
    hats = np.maximum(0.0, 1.0 - np.abs(node[:, None] - np.arange(NODES)[:, None]))
    return (hats * shape[:, None]).reshape(stretch.time.size, -1)
