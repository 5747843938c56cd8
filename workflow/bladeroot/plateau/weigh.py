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
from bladeroot.plateau.laws import BENDING, HINGES, hinge_laws, hinges, smooth_laws
from bladeroot.plateau.posterior import DOUBTS, NEGLIGIBLE, SMOOTH, Catalogue, Weighed, combined
from bladeroot.plateau.segment import Segment, first_departure

SHOWN = 0.8  # weight of laws with a plateau at which it is stated: see benchmarks/plateau.py
DETECTION = 30.0  # chi-square gain of a hinge that shows a departure
REACH = np.log([4.0, 2.0, 1.5])  # how far above it, in ln A, the laws are weighed, if they hold
# prior weight of a constant over that of any other kind, where no law's ln evidence gets to that
NO_DEPARTURE, NOTHING = 30.0, 10.0
SEEDS = 60  # onsets at which each shape is tried first
# onsets between the ends to begin with, most that matter that are refined, and new ones a round
# between them and beside the best
BEGIN, ENOUGH, BETWEEN, BESIDE = 10, 8, 8, 5
MISFIT = 20.0  # excess variance about all laws from which the record does not speak for a constant


def weigh(segment: Segment) -> Weighed:
    """Weights of all laws on the informative part of a record.

    That part is the longest of a few on which the laws hold without their greatest doubt. A plateau
    must show on the longer ones, too, up to the first on which the phase's laws hold, as errors
    that neighbours share look like a law on a short one. A departure that was only the noise's own
    wander sends the search further up the record.
    """
    detection = DETECTION
    while True:
        top = first_departure(segment, detection)
        if top is None:
            return _weighed(segment)[0]
        found, excess = _weighed(segment.below(top + REACH[0]))
        shown, unsure = found.phase.plateau, True
        for reach in REACH[1:]:
            unsure &= found.phase.doubtful > 0.5
            if max(found.phase.doubtful, found.decline.doubtful) <= 0.5 or shown < SHOWN:
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
    new = np.union1d(np.linspace(low, high, BEGIN + 2)[1:-1], _seeds(frame, low, high))
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
        new = [_finer(onsets, evidence[k][SMOOTH:] / excess[k], low, high) for k in range(2)]
        new = np.setdiff1d(np.concatenate(new), onsets)
        if not new.size:
            break
    order = np.argsort(onsets)
    rising = SMOOTH + (np.arange(HINGES) + HINGES * order[:, None]).ravel()
    total = total.chosen(np.concatenate([np.arange(SMOOTH), rising]))
    both = [fits(frame, total, channel, excess[channel]) for channel in range(2)]
    both = [with_lines_below(both[k], window, onsets[order], k) for k in range(2)]
    constant = [(frame.rate[k], excess[k] * frame.variance) for k in range(2)]
    still = [best[k] < NOTHING * excess[k] and excess[k] < MISFIT for k in range(2)]
    still = [NO_DEPARTURE if one else 1.0 for one in still]
    bent = []
    for channel in range(2):
        law = int(np.argmax(both[channel].evidence[: len(BENDING), 0]))
        rest = misfit(frame, smooth, law, both[channel].size[law, 0], channel)
        bent.append(max(excess_variance(rest), excess[channel]) / excess[channel])
    found = combined(Catalogue(onsets[order], low, high), both, constant, still, bent)
    return found, max(excess)


def _best(evidence: Float[ndarray, "law doubt"]) -> tuple[int, int]:
    """The best law and its doubt; what only the greatest explains may be errors that are alike."""
    return divmod(int(np.argmax(evidence[:, :-1])), DOUBTS - 1)


def _seeds(frame: Frame, low: float, high: float) -> Float[ndarray, " onset"]:
    """Best onset (ln A0) of each shape, taken at its word, in either channel.

    A law that holds exactly may show on a range of onsets that a coarse search steps over.
    """
    onsets = np.linspace(low, high, SEEDS + 2)[1:-1]
    columns = frame.seen(hinges(frame.segment, onsets))[0]
    size = np.einsum("lg,lg->l", columns, columns)
    gain = (frame.y @ columns.T) ** 2 / np.maximum(size, 1e-300)
    gain = gain.reshape(2, SEEDS, HINGES)
    best = np.clip(gain.argmax(axis=1), 1, SEEDS - 2)
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
    value = evidence.reshape(onsets.size, HINGES).max(axis=1)[order]
    good = np.flatnonzero(value > value.max() - NEGLIGIBLE)
    more = np.empty(0)
    if good.size < ENOUGH:
        more = np.linspace(around[good[0]], around[good[-1] + 2], BETWEEN + 2)[1:-1]
    best = int(np.argmax(value))
    beside = value[max(best - 1, 0) : best + 2]
    if beside.max() - beside.min() > 1.0:
        more = np.concatenate([more, np.linspace(around[best], around[best + 2], BESIDE + 2)[1:-1]])
    return more
