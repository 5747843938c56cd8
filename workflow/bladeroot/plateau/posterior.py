"""From the evidence of laws to what a record says: weights, verdict, rates, and the onset.

Four kinds of law have the same prior weight: a constant, laws that bend all the way down, flat
ones, and hinges (ln A0 and shape uniform). A constant has more where no departure shows, but in the
verdict alone: what would not show is in the rates' errors. Phase and log-amplitude have shapes of
their own; half of the prior says that both have the same onset.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray
from scipy.special import ndtr

from bladeroot.plateau.evidence import Fits
from bladeroot.plateau.laws import BENDING_POWERS, DOUBT_STDS, FLAT_POWERS, HINGE_SHAPES

CENTRAL_INTERVALS = {68: (0.158655, 0.841345), 95: (0.025, 0.975)}  # their ends, by size in %
STDS_OF_95 = 1.96  # half of a normal distribution's interval of 95 %, in standard deviations
NEGLIGIBLE_WEIGHT = 1e-6  # parts of less weight, over the largest or over all, are left out

# A constant segment at least this long in ln A counts as a plateau that is shown.
SHORTEST_PLATEAU = np.log(2.0)
# Error of ln A0 by the blocks and the integration over the cells, found by simulation.
ONSET_ERROR = 1e-4
NEGLIGIBLE_EVIDENCE = 8.0  # ln of the evidence below the best, from which on a law does not matter
LEAST_EXTRAPOLATED_POWER = 0.5  # of A: a law of a smaller power is not believed down to A = 0
SMOOTH_COUNT = len(BENDING_POWERS) + len(FLAT_POWERS)
DOUBT_COUNT = len(DOUBT_STDS)


@dataclass(frozen=True)
class Mixture:
    """A probability that is a sum of normal parts."""

    weight: Float[ndarray, " part"]
    mean: Float[ndarray, " part"]
    variance: Float[ndarray, " part"]

    def quantiles(self, share: tuple[float, ...]) -> Float[ndarray, " share"]:
        """Values below which these shares of the probability lie."""
        some = self.weight > NEGLIGIBLE_WEIGHT * self.weight.max()
        weight, std = self.weight[some], np.sqrt(self.variance[some])
        mean, weight = self.mean[some], weight / weight.sum()
        low = np.full(len(share), (mean - 4.0 * std).min())
        high = np.full(len(share), (mean + 4.0 * std).max())
        # by bisection, to 1e-5 of the smallest standard deviation or what a number can tell
        for _ in range(min(int(np.log2((high[0] - low[0]) / std.min()) + 17.0), 60)):
            at = 0.5 * (low + high)
            above = ndtr((at[:, None] - mean) / std) @ weight >= share
            low, high = np.where(above, low, at), np.where(above, at, high)
        return 0.5 * (low + high)

    def middle(self) -> tuple[float, float]:
        """Median, and a standard error that serves for both of its intervals.

        The geometric mean of half the interval of 68 % and half that of 95 % over 1.96. A standard
        deviation would depend on far parts of hardly any weight.
        """
        q = self.quantiles((*CENTRAL_INTERVALS[95], *CENTRAL_INTERVALS[68], 0.5))
        return float(q[4]), float(np.sqrt(0.5 * (q[3] - q[2]) * (q[1] - q[0]) / (2.0 * STDS_OF_95)))


@dataclass(frozen=True)
class Channel:
    """What one channel says, with what the other one knows of the onset.

    `weight` sums to one over all laws: the constant, the smooth ones and the hinges, each with all
    doubts; each kind has the same prior weight. `rate` and `variance` are theirs, at zero shape and
    at the smallest amplitude. `tenable` marks the laws from sqrt(A) upwards that fit no worse than
    the best of those that bend all the way down, with an allowance for the misfit of that one.
    `plateau` is the weight of laws with a plateau long enough to be shown, `doubtful` that of the
    greatest doubt. `bent`: by how much the misfit of the best law that bends all the way down,
    without doubt about it, exceeds the variances.
    """

    weight: Float[ndarray, " law"]
    rate: Float[ndarray, "2 law"]
    variance: Float[ndarray, "2 law"]
    tenable: Bool[ndarray, " law"]
    plateau: float
    constant: float
    doubtful: float
    bent: float

    def mean(self) -> tuple[float, float]:
        """Rate of the plateau; the laws' spread in its error."""
        return Mixture(self.weight, self.rate[0], self.variance[0]).middle()

    def limits(self) -> tuple[float, float]:
        """Lowest and highest limit at zero amplitude of any tenable law, 1.96 errors included."""
        if not self.tenable.any():
            return np.nan, np.nan
        rate, std = self.rate[0, self.tenable], np.sqrt(self.bent * self.variance[0, self.tenable])
        return float((rate - STDS_OF_95 * std).min()), float((rate + STDS_OF_95 * std).max())


@dataclass(frozen=True)
class Weighed:
    """Both channels, the onset's posterior in ln A0, and the lowest ln A that was looked at.

    `departs` is the weight of a constant that ends at an onset, in either channel; without any,
    `onset` is None.
    """

    decline: Channel
    phase: Channel
    onset: Mixture | None
    departs: float
    lowest: float


@dataclass(frozen=True)
class Catalogue:
    """The laws that were fitted: `SMOOTH_COUNT` smooth ones, then `HINGE_SHAPES` at each onset.

    onsets: ln A0, rising. low, high: ends of the segment in ln A.
    """

    onsets: Float[ndarray, " onset"]
    low: float
    high: float

    @property
    def prior(self) -> Float[ndarray, " onset"]:
        """Of each onset: the share of the segment that is nearest to it."""
        middle = 0.5 * (self.onsets[1:] + self.onsets[:-1])
        edge = np.concatenate([[self.low], middle, [self.high]])
        return np.maximum(np.diff(edge) / (self.high - self.low), 1e-12)


def combined(
    catalogue: Catalogue,
    both: list[Fits],
    constant: list[tuple[float, float]],
    still: list[float],
    bent: list[float],
) -> Weighed:
    """Posterior over the laws of both channels, their onsets tied in half of the prior.

    By channel, constant: its rate and variance; still: its prior weight over another kind's;
    bent: excess variance about the best law that bends all the way down, without doubt about it,
    over that about the best law of all.
    """
    by_channel = [_weights(catalogue, *one) for one in zip(both, still, strict=True)]
    by_onset = [hinge.sum(axis=(1, 2)) for _, hinge in by_channel]
    channels = []
    facts = list(zip(both, constant, still, bent, strict=True))
    for one, (smooth, hinge) in enumerate(by_channel):
        # an onset of the other channel speaks for the same one here
        other = by_onset[1 - one]
        tie = 1.0 - 0.5 * other.sum() + 0.5 * other / catalogue.prior
        weight = np.concatenate([smooth, (hinge * tie[:, None, None]).ravel()])
        channels.append(_channel(catalogue, weight / weight.sum(), *facts[one]))
    onset, departs = _onset(catalogue, by_onset)
    return Weighed(*channels, onset, departs, catalogue.low)


def _weights(
    catalogue: Catalogue, found: Fits, still: float
) -> tuple[Float[ndarray, " law"], Float[ndarray, "onset hinge doubt"]]:
    """Weights by one channel alone: the constant and the smooth laws, and the hinges."""
    peak = max(float(found.evidence.max()), 0.0)
    likely = np.exp(found.evidence - peak) / DOUBT_COUNT
    kinds = [len(BENDING_POWERS), len(FLAT_POWERS)]
    smooth = likely[:SMOOTH_COUNT] / np.repeat(kinds, kinds)[:, None]
    smooth = np.concatenate([[still * np.exp(-peak)], smooth.ravel()])
    hinge = likely[SMOOTH_COUNT:].reshape(-1, HINGE_SHAPES, DOUBT_COUNT)
    hinge = hinge * catalogue.prior[:, None, None] / HINGE_SHAPES
    whole = smooth.sum() + hinge.sum()
    return smooth / whole, hinge / whole


def _channel(
    catalogue: Catalogue,
    weight: Float[ndarray, " law"],
    found: Fits,
    constant: tuple[float, float],
    still: float,
    bent: float,
) -> Channel:
    """What the weights make of one channel; the constant has `still` times another kind's prior."""
    even = np.concatenate([weight[:1] / still, weight[1:]])
    rate, variance = (
        np.column_stack([np.full(2, base), values.reshape(2, -1)])
        for base, values in zip(constant, (found.rate, found.variance), strict=True)
    )
    evidence = np.concatenate([[0.0], found.evidence.ravel()])
    tenable = np.ones(evidence.size, dtype=bool)
    tenable[
        1 : 1 + DOUBT_COUNT * int(np.sum(np.array(BENDING_POWERS) < LEAST_EXTRAPOLATED_POWER))
    ] = False
    tenable[DOUBT_COUNT::DOUBT_COUNT] = False  # the greatest doubt extrapolates to anywhere
    bending = np.arange(evidence.size) <= DOUBT_COUNT * len(BENDING_POWERS)
    tenable &= evidence > evidence[tenable & bending].max() - NEGLIGIBLE_EVIDENCE * bent
    doubtful = float(weight[DOUBT_COUNT::DOUBT_COUNT].sum())
    even /= even.sum()
    # a flat law is a plateau where what is left of it at the smallest amplitude is within the error
    flat = slice(1 + DOUBT_COUNT * len(BENDING_POWERS), 1 + DOUBT_COUNT * SMOOTH_COUNT)
    shown = 0.0
    if weight[flat].sum() > NEGLIGIBLE_WEIGHT:
        error = Mixture(even, rate[0], variance[0]).middle()[1]
        shown = weight[flat] @ (np.abs(rate[1, flat] - rate[0, flat]) < error)
    hinge = (
        weight[1 + DOUBT_COUNT * SMOOTH_COUNT :].reshape(-1, HINGE_SHAPES * DOUBT_COUNT).sum(axis=1)
    )
    shown += hinge[catalogue.onsets >= catalogue.low + SHORTEST_PLATEAU].sum()
    if catalogue.high - catalogue.low >= SHORTEST_PLATEAU:
        shown += weight[0]
    return Channel(even, rate, variance, tenable, float(shown), float(weight[0]), doubtful, bent)


def _onset(
    catalogue: Catalogue, by_onset: list[Float[ndarray, " onset"]]
) -> tuple[Mixture | None, float]:
    """Posterior of ln A0, where the first of both channels leaves, and its weight."""
    one, two = by_onset
    not_one, not_two = 1.0 - one.sum(), 1.0 - two.sum()
    # the tail beyond an onset, half of its own cell included
    after = [part[::-1].cumsum()[::-1] - 0.5 * part for part in by_onset]
    weight = 0.5 * one * two / catalogue.prior + 0.5 * (one * after[1] + two * after[0])
    weight += one * not_two + two * not_one
    whole = weight.sum()
    if not whole > 1e-300:
        return None, 0.0
    width = catalogue.prior * (catalogue.high - catalogue.low)
    onset = Mixture(weight, catalogue.onsets, width**2 / 12.0 + ONSET_ERROR**2)
    return onset, float(whole / (whole + not_one * not_two))
