"""Naming causes in one channel: forward steps, each with everything that competes with it."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bladeroot.diagnosis import guards
from bladeroot.diagnosis.channel import Channel, Kernels
from bladeroot.diagnosis.gaussian import Fit, asked_for, best_fit, fit
from bladeroot.diagnosis.plausibility import explained_by_law, possible
from bladeroot.mechanisms.mechanism import Mechanism


@dataclass(frozen=True)
class Known:
    """What is known besides the campaign.

    splits: independent measurements by what a mechanism is `measured_by`: value and standard
    deviation of its first parameter. replicates: whether clampings are repeated often enough to
    tell gauge and level effects from their scatter. barred: mechanisms that are ranked but never
    named, with why.
    """

    splits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    replicates: bool = True
    barred: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Step:
    """One round: log evidence over the round's start of each mechanism and smooth competitor."""

    mechanisms: dict[str, float]
    smooth: dict[str, float]
    needed: float


@dataclass(frozen=True)
class Cause:
    """A cause as it was accepted; `credible` are the ids that explain it about as well."""

    mechanism: Mechanism
    gain: float
    credible: tuple[str, ...]


@dataclass(frozen=True)
class Found:
    """The search's outcome in one channel.

    fits: the baseline's and the final one. unexplained: what the remainder is smooth in, or "".
    """

    channel: Channel
    known: Known
    baseline: Fit
    final: Fit
    causes: tuple[Cause, ...]
    steps: tuple[Step, ...]
    unexplained: str

    @property
    def gain(self) -> float:
        """Log evidence of the final model over the baseline's."""
        return self.final.log_evidence - self.baseline.log_evidence


def search(channel: Channel, known: Known) -> Found:
    """Add causes one by one while what they explain is worth more than the guards ask.

    A cause that the smooth competitor beats is taken where a second one makes up for it. A cause
    that a later one makes needless is dropped again, for good.
    """
    baseline, fits = _with_one_more(channel, (), fit(channel.problem((), ())), known)
    current, causes, steps, unexplained = baseline, [], [], ""
    dropped: set[str] = set()
    first = guards.MISSING if known.replicates else guards.MISSING_FEW
    while len(causes) < guards.MOST_CAUSES:
        chosen = [cause.mechanism for cause in causes]
        if causes:
            current, fits = _with_one_more(channel, chosen, current, known)
        explained = current.log_evidence - baseline.log_evidence
        needed = max(guards.FURTHER, guards.FURTHER_PART * explained) if causes else first
        smooth = _smooth(channel, chosen, current)
        step = Step(
            _gains(current, fits),
            {name: one.log_evidence - current.log_evidence for name, one in smooth.items()},
            needed,
        )
        steps.append(step)
        never = {*known.barred, *dropped}
        ranked = _ranked(channel, chosen, current, fits, needed, never)
        best = max(ranked, key=ranked.get, default="")
        other = max(step.smooth, key=step.smooth.get, default="")
        gain, rival = ranked.get(best, -np.inf), step.smooth.get(other, -np.inf)
        if max(gain, rival) < needed:
            break
        if rival > gain + guards.SHAPE:
            both = max(guards.FURTHER, guards.FURTHER_PART * (explained + rival))
            least = rival - guards.SHAPE
            ranked = _beside(channel, chosen, current, fits, both, never, known, least)
            best = max(ranked, key=ranked.get, default="")
        if ranked.get(best, -np.inf) < needed:
            if not causes or rival > guards.UNEXPLAINED_PART * explained:
                unexplained = other
            break
        credible = _credible(channel, ranked, known)
        mechanism = next(one for one in channel.candidates if one.id == best)
        causes.append(Cause(prepared(mechanism, known)[0], step.mechanisms[best], credible))
        current = fits[best][0]
        causes, current, needless = _without_needless(channel, causes, current, needed, known)
        dropped |= needless
    return Found(channel, known, baseline, current, tuple(causes), tuple(steps), unexplained)


def _gains(current: Fit, fits: Mapping[str, tuple[Fit, float]]) -> dict[str, float]:
    """Log evidence over `current` of each fit, with what independent measurements add to it."""
    return {
        name: one.log_evidence - current.log_evidence + more for name, (one, more) in fits.items()
    }


def _ranked(
    channel: Channel,
    chosen: Sequence[Mechanism],
    current: Fit,
    fits: Mapping[str, tuple[Fit, float]],
    needed: float,
    never: Collection[str],
) -> dict[str, float]:
    """The gains of the mechanisms that may be named next.

    That is: all causes stay possible, and the new one explains what is needed by its mean.
    """
    gains = _gains(current, fits)
    return {
        one.id: gains[one.id]
        for one in channel.candidates
        if one.id in fits
        and one.id not in never
        and possible(channel, [*chosen, one], fits[one.id][0])
        and explained_by_law(current, fits[one.id][0]) + fits[one.id][1] >= needed
    }


def _beside(
    channel: Channel,
    chosen: Sequence[Mechanism],
    current: Fit,
    fits: Mapping[str, tuple[Fit, float]],
    needed: float,
    never: Collection[str],
    known: Known,
    least: float,
) -> dict[str, float]:
    """The ranking beside a second cause, if two explain at least so much where one does not.

    Where two causes act, either law alone may miss much.
    """
    by_id = {one.id: one for one in channel.candidates}
    alone = {name: gain for name, gain in _gains(current, fits).items() if name not in never}

    def beside(name: str) -> dict[str, float]:
        both, fitted = [*chosen, prepared(by_id[name], known)[0]], fits[name][0]
        more = _mechanisms(channel, both, fitted, known)
        return _ranked(channel, both, fitted, more, needed, never)

    best = sorted(alone, key=alone.get, reverse=True)[: guards.OPENINGS]
    rankings = {first: beside(first) for first in best}
    pairs = {
        (first, second): alone[first] + gain
        for first, gains in rankings.items()
        for second, gain in gains.items()
    }
    pair = max(pairs, key=pairs.get, default=None)
    if pair is None or pairs[pair] < least:
        return {}
    return rankings.get(pair[1]) or beside(pair[1])


def _without_needless(
    channel: Channel, causes: Sequence[Cause], fitted: Fit, needed: float, known: Known
) -> tuple[list[Cause], Fit, set[str]]:
    """The causes without those that the last one makes needless, their fit, and whom it dropped."""
    kept, dropped = list(causes), set()
    by_id = {one.id: one for one in channel.candidates}
    for one in causes[:-1]:
        rest = [other for other in kept if other is not one]
        first = channel.base
        for other in kept[: kept.index(one)]:
            first += len(other.mechanism.parameters)
        own = np.arange(first, first + len(one.mechanism.parameters))
        problem = channel.problem([other.mechanism for other in rest], ())
        without = fit(problem, np.delete(fitted.parameters, own), fitted.scales)
        measured = prepared(by_id[one.mechanism.id], known)[1]
        if fitted.log_evidence + measured - without.log_evidence < needed:
            kept, fitted = rest, without
            dropped.add(one.mechanism.id)
    return kept, fitted, dropped


def _with_one_more(
    channel: Channel, chosen: Sequence[Mechanism], fitted: Fit, known: Known
) -> tuple[Fit, dict[str, tuple[Fit, float]]]:
    """The fit with the chosen ones and those with one mechanism more.

    The first is also tried from where the best of the others ends: a mechanism that does nothing
    may find a better summit of the model without it, which is no evidence.
    """
    fits = _mechanisms(channel, chosen, fitted, known)
    own = fitted.parameters.size
    if not own or not fits:
        return fitted, fits
    best = max((one for one, _ in fits.values()), key=lambda one: one.log_evidence)
    second = fit(channel.problem(chosen, ()), best.parameters[:own], best.scales)
    gain = second.log_evidence - fitted.log_evidence
    if gain > guards.OTHER_SUMMIT:
        fits = _mechanisms(channel, chosen, second, known)
    return second if gain > 0.0 else fitted, fits


def prepared(mechanism: Mechanism, known: Known) -> tuple[Mechanism, float]:
    """A mechanism with what an independent measurement says of it, and that one's log evidence.

    The measurement belongs to the data of every model: those without the mechanism must explain it
    as an error of its own.
    """
    if mechanism.measured_by not in known.splits:
        return mechanism, 0.0
    value, std = known.splits[mechanism.measured_by]
    first = mechanism.parameters[0]
    weight = 1.0 / (1.0 / first.std**2 + 1.0 / std**2)
    mean = weight * (first.mean / first.std**2 + value / std**2)
    parameter = replace(first, mean=mean, std=float(np.sqrt(weight)))
    wide = np.hypot(first.std, std)
    gain = -0.5 * ((value - first.mean) / wide) ** 2 - np.log(wide)
    gain += 0.5 * (value / std) ** 2 + np.log(std)
    changed = replace(mechanism, parameters=(parameter, *mechanism.parameters[1:]))
    return changed, float(gain)


def _mechanisms(
    channel: Channel, chosen: Sequence[Mechanism], current: Fit, known: Known
) -> dict[str, tuple[Fit, float]]:
    """Fits with one more mechanism each, and what independent measurements add to the evidence.

    The baseline starts afresh: where it had to make up for a cause, there is no way down from it.
    """
    fits = {}
    taken = {one.id for one in chosen}
    causes = current.parameters[channel.base :]
    thorough = channel.name == "curve" and any(
        _asks(current, kernels) for kernels in channel.smooth(current).values()
    )
    for one in channel.candidates:
        if one.id in taken:
            continue
        changed, gain = prepared(one, known)
        problem = channel.problem([*chosen, changed], ())
        before = np.append(problem.prior.mean[: channel.base], causes)
        starts = [np.append(before, s) for s in (changed.start, *changed.starts)]
        if thorough:
            # As yet the curves are noise to the fit: a few steps from there tell no start's worth.
            ends = [fit(problem, start, current.scales) for start in starts]
            fits[one.id] = (max(ends, key=lambda end: end.log_evidence), gain)
        else:
            fits[one.id] = (best_fit(problem, starts, current.scales), gain)
    return fits


def _smooth(channel: Channel, chosen: Sequence[Mechanism], current: Fit) -> dict[str, Fit]:
    """Fits with each smooth competitor instead; from two starts where the data ask for it."""
    fits = {}
    for name, kernels in channel.smooth(current).items():
        problem = channel.problem(chosen, kernels)
        usual = problem.scales.mean
        starts = [np.append(current.scales, usual[current.scales.size :])]
        if _asks(current, kernels):
            starts.append(usual)
        both = [fit(problem, current.parameters, scales) for scales in starts]
        fits[name] = max(both, key=lambda one: one.log_evidence)
    return fits


def _asks(current: Fit, kernels: Kernels) -> bool:
    """Whether a fit's misses ask for one of these covariances."""
    return any(asked_for(current, unit) > guards.ASKED for unit, _ in kernels)


def _credible(channel: Channel, gains: Mapping[str, float], known: Known) -> tuple[str, ...]:
    """The mechanisms that explain it about as well, best first.

    Where the best needs a measurement that there is not, its siblings belong to the set.
    """
    order = sorted(gains, key=gains.get, reverse=True)
    near = [name for name in order if gains[name] > gains[order[0]] - guards.CREDIBLE]
    by_id = {one.id: one for one in channel.candidates}
    unsplit = {n for n in by_id if by_id[n].needed and by_id[n].measured_by not in known.splits}
    top = by_id[order[0]]
    if top.id in unsplit:
        siblings = sorted(unsplit, key=lambda n: -gains.get(n, -np.inf))
        near += [n for n in siblings if by_id[n].kind == top.kind and n not in near]
    return tuple(near)
