"""Laws by which a decay's rates may depend on amplitude.

A rate (of phase or of log-amplitude) is rate0 + c h(A) m(A): a shape h with a size c, and a factor
m, which is one within some per cent because no law of slip is known better than that. m is straight
in ln A between nodes; its values there are independent about one with a standard deviation, the
doubt about the law (`DOUBT_STDS`), that is itself weighed by the evidence. Above an onset d ln(e)
is added, where d is zero with the same standard deviation, as no exponent is known exactly either.

Shapes, with e = max(0, A/A0 - 1): hinges at an onset A0, which are e^p, 1 - A0/A, and stiffness
and damping of a Coulomb slider (3.19; near its critical amplitude it softens like e^(3/2) and damps
like e); flat laws A^p with p >= 2, whose limit is a plateau for all purposes; and laws that bend
all the way down, A^p with smaller p and ln A.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.plateau.segment import Segment, over_cells

# The shapes h: powers of A, or shapes at an onset.
BENDING_POWERS = (0.0, 0.25, 0.5, 0.75, 1.0, 1.3, 1.6)  # bend all the way down; 0: the logarithm
FLAT_POWERS = (2.0, 2.5, 3.0)  # have a plateau for their limit
HINGE_SHAPES = 7  # number of shapes at each onset
# The factor m.
DOUBT_STDS = (0.01, 0.1, 0.4)  # standard deviations of its values and of d, each weighed
FACTOR_NODES = 4  # number of its nodes
NODE_SPACING = 0.7  # distance of the nodes in ln A: about a factor of two in amplitude


@dataclass(frozen=True)
class PerLaw:
    """Arrays with a row for each law."""

    def joined(self, other: "PerLaw") -> "PerLaw":
        """Both sets of laws, on the same segment."""
        pairs = ((name, [rows, getattr(other, name)]) for name, rows in vars(self).items())
        return type(self)(**{name: np.concatenate(both) for name, both in pairs})

    def chosen(self, laws: Int[ndarray, " law"]) -> "PerLaw":
        """Some of the laws, in the order given."""
        return type(self)(**{name: rows[laws] for name, rows in vars(self).items()})


@dataclass(frozen=True)
class Laws(PerLaw):
    """Laws on a segment: means over its cells of the shapes, and of the same times ln(e).

    first: ln A of the factor's lowest node. lowest: the shape at the smallest amplitude.
    """

    shape: Float[ndarray, "law cell"]
    between: Float[ndarray, "law cell"]
    first: Float[ndarray, " law"]
    lowest: Float[ndarray, " law"]


def smooth_laws(segment: Segment) -> Laws:
    """Laws without an onset, `BENDING_POWERS` then `FLAT_POWERS`.

    The logarithm is zero at the smallest amplitude, as it has no limit; the others at A = 0.
    """
    high = segment.path.max()
    power = np.array(BENDING_POWERS + FLAT_POWERS)[:, None]
    log = segment.path - segment.path.min()
    shape = np.where(power > 0.0, np.exp(power * (segment.path - high)), log)
    cells = over_cells(segment, shape)
    first = np.full(power.size, high - (FACTOR_NODES - 1) * NODE_SPACING)
    return Laws(cells, np.zeros_like(cells), first, shape[:, np.argmin(segment.path)])


def hinge_laws(segment: Segment, onsets: Float[ndarray, " onset"]) -> Laws:
    """`HINGE_SHAPES` laws at each onset (ln A0), which are also their lowest nodes.

    Every onset lies above the smallest amplitude.
    """
    e, rate = _hinges(segment, onsets)
    log = np.log(np.where(e > 0.0, e, 1.0))
    shape, between = (
        over_cells(segment, one.reshape(-1, log.shape[1])) for one in (rate, rate * log[:, None])
    )
    return Laws(
        shape, between, np.repeat(onsets, HINGE_SHAPES), np.zeros(HINGE_SHAPES * onsets.size)
    )


def hinges(segment: Segment, onsets: Float[ndarray, " onset"]) -> Float[ndarray, "law cell"]:
    """Means over the cells of the hinges at each onset (ln A0), its shapes in turn."""
    e, rate = _hinges(segment, onsets)
    return over_cells(segment, rate.reshape(-1, e.shape[1]))


def _hinges(segment: Segment, onsets: Float[ndarray, " onset"]) -> tuple[ndarray, ndarray]:
    """e along the path for each onset (ln A0), and the `HINGE_SHAPES` shapes."""
    e = np.maximum(np.exp(segment.path) * np.exp(-onsets)[:, None] - 1.0, 0.0)
    root, s = np.sqrt(e), e / (1.0 + e)
    # 3.19: with theta = pi - theta_B = 2 atan(sqrt(e)), the stiffness lost is
    # (theta - sin(2 theta) / 2) / pi
    slider = 2.0 * (np.arctan(root) - root * (1.0 - e) / (1.0 + e) ** 2)
    shapes = [e**0.75, e, e * root, e**2, s, s * (1.0 - s), slider]
    return e, np.stack(shapes, axis=1)


def hats(
    log: Float[ndarray, " value"], first: Float[ndarray, " law"]
) -> Float[ndarray, "law node value"]:
    """The factor's parts that belong to its nodes, at some ln A."""
    place = np.clip((log - first[:, None]) / NODE_SPACING, 0.0, FACTOR_NODES - 1.0)
    return np.maximum(0.0, 1.0 - np.abs(place[:, None] - np.arange(FACTOR_NODES)[:, None]))
