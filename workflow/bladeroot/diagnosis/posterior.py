"""Probabilities of sets of causes, from their log evidence.

Prior odds are stated in `guards`: each cause, and something of no catalogue, is less likely than
its absence. Evidence is tempered: laws are not exact, so a part of all that is explained is not
evidence for one law against another, nor for a second cause beside the first.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from bladeroot.diagnosis import guards

NONE, UNKNOWN = "none", "none-of-these"
Sets = dict[frozenset[str], float]
_DIGITS = 9


@dataclass(frozen=True)
class Weighed:
    """A set of causes with its log evidence over the baseline, and what the best smooth competitor
    adds to it (-inf: not tried), or a difference between the groups that the campaign states.

    misfit: probability that its laws miss so much that they are none of these
        (`plausibility.law_misfit`).
    """

    causes: frozenset[str]
    log_evidence: float
    smooth: float = -np.inf
    group: float = -np.inf
    misfit: float = 0.0


def temperature(explained: float, replicates: bool = True, trust: float = guards.TRUST) -> float:
    """By which log evidence is divided, where so much of it (nats) is explained by the best."""
    alone = 1.0 if replicates else guards.FEW_TEMPERATURE
    return alone * (1.0 + guards.MODEL_ERROR * trust * max(explained, 0.0))


def probabilities(
    models: Iterable[Weighed],
    replicates: bool = True,
    trust: float = guards.TRUST,
    tests: Mapping[str, float] | None = None,
) -> Sets:
    """Of each set of causes, `UNKNOWN` being one where the smooth competitor is part of it.

    trust: the part of its own effect to which a law is exact. tests: nats by which an independent
    measurement of a cause, which rests on no law, raises its odds beforehand.
    """
    models, tests = list(models), tests or {}
    best = max(one.log_evidence for one in models)
    others = [max(one.smooth, one.group) + one.log_evidence for one in models if not one.causes]
    reach = max(best, *others, 0.0)
    heat = temperature(reach, replicates, trust)
    alone = max((one.log_evidence for one in models if len(one.causes) == 1), default=0.0)
    log: Sets = {}

    def add(key: frozenset[str], value: float) -> None:
        log[key] = float(np.logaddexp(log.get(key, -np.inf), value))

    for one in models:
        prior = sum(tests.get(name, 0.0) - guards.PRIOR for name in one.causes)
        own = one.log_evidence / heat + prior
        own -= _invented(one, alone, trust) / heat
        add(one.causes, own + np.log1p(-one.misfit))
        for name in one.causes if one.misfit else ():  # any of them may be what is none
            add(one.causes - {name} | {UNKNOWN}, own + np.log(one.misfit / len(one.causes)))
        # A group is stated because it may matter: as likely as a cause of the catalogue.
        other = np.logaddexp(
            one.smooth / heat - guards.PRIOR_UNKNOWN, one.group / heat - guards.PRIOR
        )
        if np.isfinite(other):
            add(one.causes | {UNKNOWN}, own + float(other))
    top = max(log.values())
    weights = {key: float(np.exp(value - top)) for key, value in log.items()}
    return _of_one(weights)


def _of_one(sets: Sets) -> Sets:
    """Scaled to a sum of one."""
    total = sum(sets.values())
    return {key: value / total for key, value in sets.items()}


def _invented(one: Weighed, alone: float, trust: float) -> float:
    """Nats of a set's further causes that a law which is not quite right would invent, where the
    best single one explains so much; those that explain a good part of it are not invented.
    """
    count = len(one.causes) - 1
    if count < 1 or alone <= 0.0:
        return 0.0
    more = max(one.log_evidence - alone, 0.0)
    faded = float(np.exp(-more / (count * alone) / guards.FURTHER_FADES))
    return min(trust * count * alone * faded, more)


def with_unspoken(sets: Sets, names: Iterable[str]) -> Sets:
    """With causes that the data cannot speak of, each as probable as before any data.

    One at a time: two of them beside each other are rarer than what is listed.
    """
    names = list(names)
    odds = float(np.exp(-guards.PRIOR))
    whole = dict(sets)
    for key, value in sets.items():
        if len(key - {UNKNOWN}) < guards.MOST_CAUSES:
            for name in names:
                whole[key | {name}] = whole.get(key | {name}, 0.0) + odds * value
    return _of_one(whole)


def as_shown(sets: Sets) -> Sets:
    """The same where causes that the data do not speak of count as nothing: in each set those that
    do not raise the odds of the set without them beyond their prior by `guards.RAISED`.
    """
    least = float(np.exp(guards.RAISED - guards.PRIOR))
    found: Sets = {}
    for key, value in sets.items():
        shown = frozenset(n for n in key if value > least * sets.get(key - {n}, 0.0))
        found[shown] = found.get(shown, 0.0) + value
    return found


def conditional(sets: Mapping[frozenset[str], float], names: Iterable[str]) -> Sets:
    """Of what acts beside causes, were these all there."""
    there = frozenset(names)
    found = {key - there: value for key, value in sets.items() if key >= there}
    return _of_one(found)


def together(parts: Iterable[Sets], further: float = guards.FURTHER) -> Sets:
    """Of the sets over several kinds of data, which speak of different causes.

    further: nats by which each cause beside a first one is rarer than by chance.
    """
    whole: Sets = {frozenset(): 1.0}
    for part in parts:
        joined: Sets = {}
        for (a, p), (b, q) in product(whole.items(), part.items()):
            if p * q > guards.LEAST_PROBABILITY:
                joined[a | b] = joined.get(a | b, 0.0) + p * q
        whole = joined
    return _of_one({k: p * np.exp(-further * max(len(k) - 1, 0)) for k, p in whole.items()})


def inclusion(sets: Mapping[frozenset[str], float], name: str) -> float:
    """Probability that a cause, or `UNKNOWN`, is in the set."""
    return float(sum(value for key, value in sets.items() if name in key))


def entropy(sets: Mapping[frozenset[str], float]) -> float:
    """Of what is possible, nats."""
    p = np.array([value for value in sets.values() if value > 0.0])
    return float(-(p @ np.log(p)))


def credible(sets: Mapping[frozenset[str], float]) -> dict[str, float]:
    """What the most probable sets hold that reach `guards.CREDIBLE` together, by inclusion.

    Names of causes, `UNKNOWN`, and `NONE` where the empty set is one of them.
    """
    found, covered = {}, 0.0
    for key in sorted(sets, key=lambda one: (-sets[one], sorted(one))):
        if covered >= guards.CREDIBLE:
            break
        covered += sets[key]
        for name in key:
            found[name] = inclusion(sets, name)
        if not key:
            found[NONE] = sets[key]
    return dict(sorted(found.items(), key=lambda pair: (-pair[1], pair[0])))


def labelled(sets: Mapping[frozenset[str], float]) -> dict[str, float]:
    """By names as `verdict.json` has them, most probable first; they sum to one.

    Rounded, so that they do not depend on the order in which they were summed.
    """
    rounded = {"+".join(sorted(key)) or NONE: round(sets[key], _DIGITS) for key in sets}
    return dict(sorted(rounded.items(), key=lambda pair: (-pair[1], pair[0])))
