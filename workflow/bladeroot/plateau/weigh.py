"""Which laws a decay follows: the segment that tells, and the search for the onset on it.

The laws (`bladeroot.plateau.laws`) are weighed on the segment from the smallest amplitude to a few
times the one at which the record shows that it leaves a constant.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.plateau.evidence import (
    Frame,
    excess_variance,
    fits,
    framed,
    misfit,
    sums,
    with_lines_below,
)
from bladeroot.plateau.laws import BENDING_POWERS, HINGE_SHAPES, hinge_laws, hinges, smooth_laws
from bladeroot.plateau.posterior import (
    DOUBT_COUNT,
    NEGLIGIBLE_EVIDENCE,
    SMOOTH_COUNT,
    Catalogue,
    Weighed,
    combined,
)
from bladeroot.plateau.segment import Segment, first_departure

# When a plateau is stated: weight of the laws that have one, at least (benchmarks/plateau.py).
STATED_PLATEAU_WEIGHT = 0.8

# The part of the record on which laws are weighed: up to some way above the amplitude at which a
# departure from a constant shows.
DEPARTURE_GAIN = 30.0  # chi-square that a straight hinge gains, from which a departure shows
# ln A above it, tried in this order: each next one where laws hold with their greatest doubt only.
DEPARTURE_REACHES = np.log([4.0, 2.0, 1.5])

# A constant has CONSTANT_PRIOR times the prior weight of any other kind of law where no departure
# shows: where no law's ln evidence over it reaches DEPARTURE_EVIDENCE times the excess variance.
# It has no more than the others where the excess variance about the best law reaches
# TRUSTED_MISFIT: no law fits then, and the record does not speak for a constant.
CONSTANT_PRIOR = 30.0
DEPARTURE_EVIDENCE = 10.0
TRUSTED_MISFIT = 20.0

# The onsets (ln A0) at which hinges are fitted, refined round by round.
EVEN_ONSETS = 10  # evenly from end to end, to begin with
SEED_ONSETS = 60  # evenly too, of which the best of each shape joins them
# Where fewer onsets than this matter, a round adds ONSETS_BETWEEN new ones over their range.
ENOUGH_ONSETS = 8
ONSETS_BETWEEN = 8
ONSETS_BESIDE_BEST = 5  # new ones a round on both sides of the best, where its neighbours fit worse


def weigh(segment: Segment) -> Weighed:
    """Weights of all laws on the informative part of a record.

    That part is the longest of a few on which the laws hold without their greatest doubt. A plateau
    must show on the longer ones, too, up to the first on which the phase's laws hold: on a short
    part, errors that neighbours share look like a law. Where a departure turns out to be noise, the
    search goes on further up the record, against a higher gain.
    """
    detection = DEPARTURE_GAIN
    while True:
        top = first_departure(segment, detection)
        if top is None:
            return _weighed(segment)[0]
        found, excess = _weighed(segment.below(top + DEPARTURE_REACHES[0]))
        shown, unsure = found.phase.plateau, True
        for reach in DEPARTURE_REACHES[1:]:
            unsure &= found.phase.doubtful > 0.5
            if (
                max(found.phase.doubtful, found.decline.doubtful) <= 0.5
                or shown < STATED_PLATEAU_WEIGHT
            ):
                break
            found, _ = _weighed(segment.below(top + reach))
            shown = min(shown, found.phase.plateau) if unsure else shown
        found = replace(found, phase=replace(found.phase, plateau=shown))
        if min(found.phase.constant, found.decline.constant) < 0.5:
            return found
        detection *= 2.0 * excess


def _weighed(window: Segment) -> tuple[Weighed, float]:
    """Weights on one window, by a search for the onset that refines itself; largest excess."""
    low, high = float(window.log.min()), float(window.log.max())
    onsets, frame = np.empty(0), framed(window)
    new = np.union1d(np.linspace(low, high, EVEN_ONSETS + 2)[1:-1], _seeds(frame, low, high))
    total, evidence, best, excess = None, [np.empty(0)] * 2, [-np.inf] * 2, [1.0] * 2
    for _ in range(4):
        laws = hinge_laws(window, new)
        if total is None:
            smooth = smooth_laws(window)
            laws = smooth.joined(laws)
        more = sums(frame, laws)
        total = more if total is None else total.joined(more)
        onsets = np.concatenate([onsets, new])
        for channel in range(2):
            own = fits(frame, more, channel, 1.0)
            law, doubt = _best(own.evidence)
            if own.evidence[law, doubt] > best[channel]:
                best[channel] = float(own.evidence[law, doubt])
                rest = misfit(frame, laws, law, own.size[law, doubt], channel)
                excess[channel] = excess_variance(rest)
            highest = own.evidence.max(axis=1)
            evidence[channel] = np.concatenate([evidence[channel], highest])
        new = [_finer(onsets, evidence[k][SMOOTH_COUNT:] / excess[k], low, high) for k in range(2)]
        new = np.setdiff1d(np.concatenate(new), onsets)
        if not new.size:
            break
    order = np.argsort(onsets)
    rising = SMOOTH_COUNT + (np.arange(HINGE_SHAPES) + HINGE_SHAPES * order[:, None]).ravel()
    total = total.chosen(np.concatenate([np.arange(SMOOTH_COUNT), rising]))
    both = [fits(frame, total, channel, excess[channel]) for channel in range(2)]
    both = [with_lines_below(both[k], window, onsets[order], k) for k in range(2)]
    constant = [(frame.rate[k], excess[k] * frame.variance) for k in range(2)]
    still = [
        best[k] < DEPARTURE_EVIDENCE * excess[k] and excess[k] < TRUSTED_MISFIT for k in range(2)
    ]
    still = [CONSTANT_PRIOR if one else 1.0 for one in still]
    bent = []
    for channel in range(2):
        law = int(np.argmax(both[channel].evidence[: len(BENDING_POWERS), 0]))
        rest = misfit(frame, smooth, law, both[channel].size[law, 0], channel)
        bent.append(max(excess_variance(rest), excess[channel]) / excess[channel])
    found = combined(Catalogue(onsets[order], low, high), both, constant, still, bent)
    return found, max(excess)


def _best(evidence: Float[ndarray, "law doubt"]) -> tuple[int, int]:
    """The best law and its doubt, but the greatest, which may explain errors that are alike."""
    return divmod(int(np.argmax(evidence[:, :-1])), DOUBT_COUNT - 1)


def _seeds(frame: Frame, low: float, high: float) -> Float[ndarray, " onset"]:
    """Best onset (ln A0) of each shape, without doubt about it, in either channel.

    A law that holds exactly may fit only at onsets between those of a coarse search.
    """
    onsets = np.linspace(low, high, SEED_ONSETS + 2)[1:-1]
    columns = frame.seen(hinges(frame.segment, onsets))[0]
    size = np.einsum("lg,lg->l", columns, columns)
    gain = (frame.y @ columns.T) ** 2 / np.maximum(size, 1e-300)
    gain = gain.reshape(2, SEED_ONSETS, HINGE_SHAPES)
    best = np.clip(gain.argmax(axis=1), 1, SEED_ONSETS - 2)
    around = [np.take_along_axis(gain, best[:, None] + k, axis=1)[:, 0] for k in (-1, 0, 1)]
    bend = around[0] - 2.0 * around[1] + around[2]
    bend = np.where(bend < -1e-9 * np.abs(around[1]), bend, -np.inf)
    vertex = np.clip(0.5 * (around[0] - around[2]) / bend, -1.0, 1.0)
    return np.unique(onsets[best] + vertex * (onsets[1] - onsets[0]))


def _finer(
    onsets: Float[ndarray, " onset"], evidence: Float[ndarray, " hinge"], low: float, high: float
) -> Float[ndarray, " more"]:
    """More onsets between those that matter and beside the best, until there are enough."""
    order = np.argsort(onsets)
    around = np.concatenate([[low], onsets[order], [high]])
    value = evidence.reshape(onsets.size, HINGE_SHAPES).max(axis=1)[order]
    good = np.flatnonzero(value > value.max() - NEGLIGIBLE_EVIDENCE)
    more = np.empty(0)
    if good.size < ENOUGH_ONSETS:
        more = np.linspace(around[good[0]], around[good[-1] + 2], ONSETS_BETWEEN + 2)[1:-1]
    best = int(np.argmax(value))
    beside = value[max(best - 1, 0) : best + 2]
    if beside.max() - beside.min() > 1.0:
        more = np.concatenate(
            [more, np.linspace(around[best], around[best + 2], ONSETS_BESIDE_BEST + 2)[1:-1]]
        )
    return more
