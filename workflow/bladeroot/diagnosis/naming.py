"""Naming causes in one channel: sets of causes, each with everything that competes with it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from bladeroot.diagnosis import guards
from bladeroot.diagnosis.channel import Channel
from bladeroot.diagnosis.families import (
    Known,
    Model,
    baseline,
    mixed,
    prepared,
    smooth,
    with_one_more,
    without,
)
from bladeroot.diagnosis.plausibility import (
    explained_by_law,
    law_misfit,
    possible,
    surely_there,
)
from bladeroot.diagnosis.posterior import (
    NONE,
    UNKNOWN,
    Sets,
    Weighed,
    as_shown,
    conditional,
    credible,
    inclusion,
    probabilities,
    with_unspoken,
)
from bladeroot.inference.gaussian import Fit
from bladeroot.mechanisms.mechanism import Mechanism

# The class of mechanisms whose laws run in what a remainder is smooth in, by its first word.
_CLASS_OF = {
    "force": "force-law", "force,": "force-law", "time": "time", "time,": "time",
    "direction": "direction", "amplitude": "amplitude",
}  # fmt: skip


@dataclass(frozen=True)
class Step:
    """One set with one cause more: log evidence over the set of each mechanism (in all its forms)
    and of each smooth competitor.
    """

    mechanisms: dict[str, float]
    smooth: dict[str, float]


@dataclass(frozen=True)
class Cause:
    """A cause of the most probable set.

    gain: log evidence over the set without it. credible: what may stand in its place, itself first,
    to `guards.CREDIBLE`; of one member where it is certain. probability: that it is a cause.
    """

    mechanism: Mechanism
    gain: float
    credible: tuple[str, ...]
    probability: float


@dataclass(frozen=True)
class Found:
    """The search's outcome in one channel.

    fits: the baseline's and the final one; maxima: the baseline's others. unexplained: what the
    remainder is smooth in where that is more probable than not, or "". models: of every set that
    was fitted, each cause in its best form; steps: beside none, and beside the causes.
    insufficient: the mechanism that is barred and yet the most probable, or "". sizes: first
    parameter of each mechanism over its forms and the sets that hold it, by their probability: mean
    and standard deviation.
    """

    channel: Channel
    known: Known
    baseline: Fit
    final: Fit
    causes: tuple[Cause, ...]
    steps: tuple[Step, ...]
    unexplained: str
    probabilities: Sets
    models: Mapping[frozenset[str], Model]
    insufficient: str = ""
    sizes: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    maxima: tuple[Fit, ...] = ()

    @property
    def here(self) -> frozenset[str]:
        """The causes."""
        return frozenset(cause.mechanism.id for cause in self.causes)

    @property
    def alone(self) -> dict[str, Model]:
        """Of every mechanism the model that has it alone."""
        return {n: self.models[frozenset({n})] for n in self.steps[0].mechanisms}

    @property
    def beside(self) -> dict[str, Model]:
        """Of every other mechanism that was tried beside the causes the model that has it there."""
        sets = {n: self.here | {n} for n in self.steps[0].mechanisms if n not in self.here}
        return {n: self.models[ids] for n, ids in sets.items() if ids in self.models}

    @property
    def quiet(self) -> bool:
        """Whether the data show nothing, whatever they would not show."""
        return as_shown(self.probabilities).get(frozenset(), 0.0) >= guards.CERTAIN

    @property
    def rest(self) -> Sets:
        """Probabilities of what acts beside the causes, were these all there."""
        return conditional(self.probabilities, self.here)

    @property
    def open(self) -> list[str]:
        """What may be, beside the causes, where neither that nor nothing is certain: mechanisms,
        `UNKNOWN`, `NONE`; or [].
        """
        sets = self.rest
        if max(sets.get(frozenset(), 0.0), inclusion(sets, UNKNOWN)) >= guards.CERTAIN:
            return []
        shown = as_shown(sets)
        found = credible(shown)
        # One that is barred does not stand for certain.
        if shown.get(frozenset(), 0.0) >= guards.CERTAIN or len(found) == 1:
            found = credible(sets) | {UNKNOWN: 0.0}
        return list(found) if set(found) & set(self.beside) else []


class _Search:
    """Models that were fitted, by their causes, and what was tried beside each."""

    def __init__(self, channel: Channel, known: Known) -> None:
        self.channel, self.known = channel, known
        self.models: dict[frozenset, Model] = {}
        self.steps: dict[frozenset, Step] = {}
        self.allowed: dict[frozenset, bool] = {frozenset(): True}
        # Sets that may be and are not surely there: worth little more than without the last cause.
        self.unsure: dict[frozenset, float] = {}
        self.tests = {one.id: prepared(one, known)[1] for one in channel.candidates}

    def expand(self, model: Model) -> None:
        """Try one cause more, and the smooth competitors, beside a model."""
        if model.ids in self.steps:
            return
        few = len(model.causes) < guards.MOST_CAUSES
        more = with_one_more(self.channel, model, self.known) if few else {}
        self.models[model.ids] = model
        gains = {name: one.log_evidence - model.log_evidence for name, one in more.items()}
        self.steps[model.ids] = Step(gains, smooth(self.channel, model))
        for name, one in more.items():
            old = self.models.get(one.ids)
            allowed = name not in self.known.ruled_out and self._allowed(model, one)
            maybe = not allowed and name not in self.known.ruled_out and self.allowed[model.ids]
            if maybe and possible(self.channel, one.causes, one.fit):
                shown = min(one.log_evidence, model.log_evidence + guards.UNSURE)
                self.unsure[one.ids] = max(shown, self.unsure.get(one.ids, -np.inf))
            if old is None or (allowed, one.log_evidence) > (
                self.allowed[one.ids],
                old.log_evidence,
            ):
                self.models[one.ids], self.allowed[one.ids] = one, allowed
            both = {**one.sizes, **(old.sizes if old else {})}
            self.models[one.ids] = replace(self.models[one.ids], sizes=both)

    def without(self, model: Model, gone: str) -> Model:
        """The model without one of its causes, which what is left must stand for itself."""
        rest = without(self.channel, model, gone)
        rest = replace(rest, log_evidence=rest.log_evidence - self.tests[gone])
        self.allowed[rest.ids] = possible(self.channel, rest.causes, rest.fit) and surely_there(
            self.channel, rest.causes, rest.fit
        )
        return rest

    def _allowed(self, model: Model, more: Model) -> bool:
        """Whether all causes of a set stay possible and its last is surely there."""
        if not possible(self.channel, more.causes, more.fit):
            return False  # where a law is at no size that it can have, its slopes may be none
        measured = prepared(more.causes[-1], self.known)[1]
        by_mean = explained_by_law(model.fit, more.fit) + measured
        return by_mean >= 0.5 * guards.SIGMAS**2 and (
            measured > 0.0 or surely_there(self.channel, more.causes, more.fit)
        )

    def _idle(self, model: Model) -> bool:
        """Whether one of the causes explains nothing beside the others, possible or not."""
        rests = [self.models.get(model.ids - {one.id}) for one in model.causes]
        return any(rest and rest.log_evidence > model.log_evidence for rest in rests)

    def _impossible(self, model: Model) -> list[float]:
        """What sets with one cause more explain besides, at sizes that no such cause can have."""
        return [
            more.log_evidence - model.log_evidence
            for ids, more in self.models.items()
            if ids > model.ids and len(ids) == len(model.ids) + 1 and ids not in self.unsure
            and not self.allowed[ids] and not ids & set(self.known.ruled_out)
        ]  # fmt: skip

    def _rival(self, model: Model) -> float:
        """What a set counts as that is not surely there and explains more than any that is, of as
        many causes: as much as these. Its law misses much, and so does theirs, which is no name.
        """
        sure = [
            one.log_evidence for ids, one in self.models.items()
            if self.allowed[ids] and len(ids) == len(model.ids) and not self._idle(one)
        ]  # fmt: skip
        return max(sure) if sure and max(sure) < model.log_evidence else -np.inf

    def weighed(self) -> Sets:
        """Probabilities of all sets that may be.

        What only a cause of impossible size explains is of no catalogue, as what is smooth.
        """
        rows = []
        for ids, model in self.models.items():
            by_test = sum(self.tests[name] for name in ids)
            if not self.allowed[ids] or self._idle(model):
                if ids in self.unsure:
                    shown = max(self.unsure[ids], self._rival(model))
                    chance = law_misfit(self.channel, model.fit)
                    rows.append(Weighed(ids, shown - by_test, misfit=chance))
                continue
            step = self.steps.get(ids)
            tried = dict(step.smooth) if step else {}
            group = tried.pop("group", -np.inf)
            gains = np.array([*tried.values(), *self._impossible(model)] if step else [])
            other = np.logaddexp.reduce(gains) - np.log(gains.size) if gains.size else -np.inf
            evidence, chance = model.log_evidence - by_test, law_misfit(self.channel, model.fit)
            rows.append(Weighed(ids, evidence, float(other), group, chance))
        return probabilities(rows, self.known.replicates, self.channel.trust, self.tests)

    def best(self) -> frozenset:
        """The most probable set of causes, whatever is unexplained beside it."""
        sums: Sets = {}
        for key, value in self.weighed().items():
            if self.allowed.get(key - {UNKNOWN}, False):
                sums[key - {UNKNOWN}] = sums.get(key - {UNKNOWN}, 0.0) + value
        return max(sums, key=lambda key: (sums[key], sorted(key)))


def search(channel: Channel, known: Known) -> Found:
    """Sets of causes about the most probable one, until none beside it is more probable.

    Beside a set all are tried that have one cause more, less, or another in its place. Where what
    is smooth explains most, two causes are tried together: either law alone may miss much.
    """
    made = _Search(channel, known)
    made.models[frozenset()] = baseline(channel)
    made.expand(made.models[frozenset()])
    for _ in range(guards.ROUNDS):
        here = made.best()
        before = set(made.steps)
        model = made.models[here]
        made.expand(model)
        for one in model.causes:
            rest = model.ids - {one.id}
            if rest not in made.steps:
                made.expand(made.models.get(rest) or made.without(model, one.id))
        if inclusion(made.weighed(), UNKNOWN) > 0.5:
            for ids in _openings(made, here):
                made.expand(made.models[ids])
        if made.best() == here and set(made.steps) == before:
            break
    return _found(made)


def _openings(made: _Search, here: frozenset) -> list[frozenset]:
    """The sets with one cause more than the best one that explain most."""
    if len(here) + 1 >= guards.MOST_CAUSES:
        return []
    never = {*made.known.ruled_out}
    gains = {n: g for n, g in made.steps[here].mechanisms.items() if n not in never}
    order = sorted(gains, key=gains.get, reverse=True)[: guards.OPENINGS]
    return [here | {name} for name in order if gains[name] > 0.0]


def _found(made: _Search) -> Found:
    best, sets = made.best(), with_unspoken(made.weighed(), made.channel.unspoken)
    barred = sorted(best & set(made.known.barred))
    here = best - set(barred)
    if not made.allowed.get(here, False):
        here = frozenset()
    model = made.models[here]
    first = made.steps[frozenset()]
    steps = (first, made.steps[here]) if here in made.steps else (first,)
    rest = made.steps.get(here, first).smooth if inclusion(sets, UNKNOWN) > 0.5 else {}
    unexplained = max(rest, key=rest.get, default="")
    causes = [_cause(made, model, one, sets, unexplained) for one in model.causes]
    leading = max(barred, key=lambda name: (inclusion(sets, name), name), default="")
    if not barred and set(first.mechanisms) <= set(made.known.barred):
        leading = _leading(sets)
    return Found(
        made.channel, made.known, made.models[frozenset()].fit, model.fit, tuple(causes), steps,
        unexplained, sets, made.models, leading,
        {n: _size(made, n, sets) for n in first.mechanisms},
        model.maxima,
    )  # fmt: skip


def _size(made: _Search, name: str, sets: Sets) -> tuple[float, float]:
    """First parameter of a mechanism over the sets that hold it."""
    holding = [(ids, one) for ids, one in made.models.items() if name in ids]
    weights = [sets.get(ids, 0.0) + sets.get(ids | {UNKNOWN}, 0.0) for ids, _ in holding]
    if not sum(weights) > 0.0:
        return made.models[frozenset({name})].size(name)
    return mixed(weights, [one.size(name) for _, one in holding])


def _leading(sets: Sets) -> str:
    """The most probable mechanism of those that the data raise, where none and none of the
    catalogue are less probable; or "".
    """
    shown = as_shown(sets)
    share = {name: inclusion(shown, name) for name in frozenset().union(*shown)}
    first = max(share, key=lambda name: (share[name], name), default=UNKNOWN)
    return first if first != UNKNOWN and share[first] > shown.get(frozenset(), 0.0) else ""


def _cause(made: _Search, model: Model, one: Mechanism, sets: Sets, unexplained: str) -> Cause:
    """With what may stand in its place: mechanisms, nothing, or none of the catalogue.

    A mechanism that needs a measurement that there is not has its siblings in the set; one whose
    law leaves over what is smooth in its own variable has none of the catalogue.
    """
    rest = model.ids - {one.id}
    instead: dict[str, float] = {}
    for key, value in as_shown(sets).items():
        if one.id not in key:
            nothing = UNKNOWN if UNKNOWN in key else NONE
            for name in key - {UNKNOWN} - rest or {nothing}:
                instead[name] = instead.get(name, 0.0) + value
    probability = inclusion(sets, one.id)
    credible, covered = [one.id], probability
    others = sorted(instead, key=lambda n: (-instead[n], n))
    for name in others if probability < guards.CERTAIN else []:
        if len(credible) > 1 and covered >= guards.CREDIBLE:
            break
        credible.append(name)
        covered += instead[name]
    unsplit = {
        x.id for x in made.channel.candidates
        if x.needed and x.measured_by not in made.known.splits
    }  # fmt: skip
    if one.id in unsplit:
        siblings = [x.id for x in made.channel.candidates if x.kind == one.kind]
        credible += [n for n in siblings if n in unsplit and n not in credible]
    if _CLASS_OF.get(unexplained.partition(" ")[0]) == one.kind and UNKNOWN not in credible:
        credible.append(UNKNOWN)
    before = made.models.get(rest)
    gain = model.log_evidence - (before.log_evidence if before else 0.0)
    return Cause(one, float(gain), tuple(credible), probability)
