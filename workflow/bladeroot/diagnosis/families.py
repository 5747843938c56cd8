"""Fits of a cause in all its forms: the evidence is the family's, the form never decides a name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bladeroot.diagnosis import guards
from bladeroot.diagnosis.causes import places
from bladeroot.diagnosis.channel import Channel, Kernels
from bladeroot.diagnosis.curve_model import strain
from bladeroot.diagnosis.plausibility import possible, sizes
from bladeroot.diagnosis.posterior import temperature
from bladeroot.inference.gaussian import Fit, about, best_fit, fit, maxima_of
from bladeroot.inference.hold_out import asked_along, asked_for
from bladeroot.inference.problem import Problem
from bladeroot.mechanisms.mechanism import Mechanism

_SIZES = (0.0, 3.0, 6.0)  # standard deviations of the scales' priors to begin from
_ROUGH = 0.1  # nats a step, at which a fit over amplitude ends: laws explain hundreds there
_PLACES = 8  # of a step or a bend that are begun from
SPELL = "time, through the contact for a part of the campaign"
_INSIDE = 1e-3  # of its range, from a limit at which a bounded parameter has no coordinate


@dataclass(frozen=True)
class Known:
    """What is known besides the campaign.

    splits: independent measurements by what a mechanism is `measured_by`: value and standard
    deviation of its first parameter. replicates: whether clampings are repeated often enough to
    tell gauge and level effects from their scatter. barred: mechanisms that are ranked but never
    named for want of data, with why. ruled_out: those that the campaign says are not there.
    """

    splits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    replicates: bool = True
    barred: Mapping[str, str] = field(default_factory=dict)
    ruled_out: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Model:
    """A set of causes, each in its best form, fitted together.

    log_evidence: over the baseline, summed over the forms, with what independent measurements add.
    sizes: of causes that were added in all their forms, the first parameter over these forms: mean
    and standard deviation. maxima: the baseline's fits at its other maxima.
    """

    causes: tuple[Mechanism, ...]
    fit: Fit
    log_evidence: float
    sizes: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    maxima: tuple[Fit, ...] = ()

    @property
    def ids(self) -> frozenset[str]:
        """Of the causes."""
        return frozenset(one.id for one in self.causes)

    def size(self, name: str) -> tuple[float, float]:
        """First parameter of a cause: over its forms, or in the form that it has; and its std."""
        base = self.fit.parameters.size - places(self.causes)[-1].stop
        pairs = zip(self.causes, places(self.causes, base), strict=True)
        one, own = next(pair for pair in pairs if pair[0].id == name)
        return self.sizes.get(name) or sizes(one, self.fit, own)[0]


def prepared(mechanism: Mechanism, known: Known) -> tuple[Mechanism, float]:
    """A mechanism with what an independent measurement says of it, and that one's log evidence.

    The measurement belongs to the data of every model: those without the mechanism must explain it
    as an error of its own.
    """
    if mechanism.measured_by not in known.splits:
        return mechanism, 0.0
    value, std = known.splits[mechanism.measured_by]
    first = mechanism.parameters[0]
    shown = max(value, std) if first.log else value
    at, scale = first.coordinate(shown), first.slope(shown)
    error = std / scale
    weight = 1.0 / (1.0 / first.std**2 + 1.0 / error**2)
    mean = first.value(weight * (first.start / first.std**2 + at / error**2))
    inside = float(np.clip(mean, first.low, first.high))
    parameter = replace(first, mean=inside, std=float(np.sqrt(weight)))
    wide = np.hypot(first.std, error)
    gain = -0.5 * ((at - first.start) / wide) ** 2 - np.log(wide * scale)
    gain += 0.5 * (value / std) ** 2 + np.log(std)
    changed = replace(mechanism, parameters=(parameter, *mechanism.parameters[1:]))
    return changed, float(gain)


def baseline(channel: Channel) -> Model:
    """The model without a cause, from several sizes of the scatter: far from its maximum, where
    data lie many of their errors away, the search sees no slope; and from softer and stiffer
    contacts, as normal and tangential stiffness may exchange what they explain.
    """
    problem = channel.problem((), ())
    usual, count = problem.scales, len(channel.stiffnesses)
    fits = [fit(problem, None, usual.mean + far * usual.std) for far in _SIZES]
    fits += [fit(problem, one) for one in about(problem.prior, count)]
    best, *others = maxima_of(fits, count)
    return Model((), best, 0.0, maxima=tuple(others))


def with_one_more(channel: Channel, model: Model, known: Known) -> dict[str, Model]:
    """The models with one cause more, by its id."""
    asks = any(_asks(model.fit, kernels) for kernels in channel.smooth(model.fit).values())
    return {
        one.id: _family(channel, model, one, known, asks)
        for one in channel.candidates
        if one.id not in model.ids
    }


def _family(channel: Channel, model: Model, family: Mechanism, known: Known, asks: bool) -> Model:
    """The model with one cause more, the best of its forms, of those within physical limits if any
    is; others than the first are tried where the data ask for something or the first explains
    something.
    """
    tried: list[tuple[Mechanism, Fit, float]] = []
    for form in family.every_form:
        if tried and not asks and tried[0][1].log_evidence <= model.fit.log_evidence:
            break
        changed, measured = prepared(form, known)
        like = max(tried, key=lambda one: one[2], default=None)
        fitted = _fitted(channel, model, changed, asks, like)
        tried.append((changed, fitted, fitted.log_evidence + measured))
    weights = np.array([evidence for *_, evidence in tried])
    may = [possible(channel, (*model.causes, form), fitted) for form, fitted, _ in tried]
    if any(may):  # a form at a shape that it cannot have says nothing of the mechanism
        weights[~np.array(may)] = -np.inf
    whole = np.logaddexp.reduce(weights) - np.log(len(family.every_form))
    if len(tried) < len(family.every_form):  # forms that were not tried count as the first
        whole = weights[0]
    changed, fitted, _ = tried[int(weights.argmax())]
    explained = model.log_evidence + float(whole) - model.fit.log_evidence
    own = slice(model.fit.parameters.size, None)
    likely = np.exp((weights - whole) / temperature(explained, known.replicates, channel.trust))
    size = mixed(likely.tolist(), [sizes(form, fitted, own)[0] for form, fitted, _ in tried])
    return Model((*model.causes, changed), fitted, explained, {family.id: size}, model.maxima)


def mixed(weights: Sequence[float], rows: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Mean and standard deviation over alternatives, by weights and each one's mean and std."""
    known = np.asarray(weights) > 0.0
    if not known.any():
        return rows[0]
    weights, (mean, std) = np.asarray(weights)[known], np.transpose(rows)[:, known]
    whole = float(np.average(mean, weights=weights))
    return whole, float(np.sqrt(np.average(std**2 + (mean - whole) ** 2, weights=weights)))


def _fitted(
    channel: Channel,
    model: Model,
    one: Mechanism,
    asks: bool,
    like: tuple[Mechanism, Fit, float] | None = None,
) -> Fit:
    """The model with one cause more, from the maxima of the model without it.

    like: another form that was fitted, from whose end to begin, and from its own parameters of the
    same names too.
    """
    current = model.fit
    problem = channel.problem([*model.causes, one], ())
    own = [one.start, *map(np.asarray, one.starts)]
    many, thorough = len(own) > _PLACES, channel.name == "curve" and asks
    if like is None:
        ends = (current.parameters, *(end.parameters for end in model.maxima))
        others = current.parameters[channel.base :]
        before = [np.append(end[: channel.base], others) for end in ends]
    else:
        # Over amplitude a start costs a whole fit, and forms differ little in what they share.
        kept = own[:1] if thorough and set(_names(like[0])) & set(_names(one)[2:]) else own
        own = [*kept, _alike(one, *like[:2])]
        end = like[1].parameters
        before = [end[: current.parameters.size].copy()]
        before[0][: channel.base] -= channel.undone(like[0], end[current.parameters.size :])
    if many and not thorough:
        own = _leading(problem, current, own)
    starts = [np.concatenate([base, start]) for base in before for start in own]
    for start in starts:
        start[: channel.base] += channel.undone(one, start[-len(one.parameters) :])
    if thorough:
        # As yet the curves are noise to the fit: a few steps from there tell no start's worth.
        ends = [fit(problem, start, current.scales, _ROUGH) for start in starts]
        return max(ends, key=lambda end: end.log_evidence)
    scales = [current.scales]
    if asks and (many or one.kind == "force-law"):
        # Beside the scatter that made up for a cause, the place of a step, or of a bend over the
        # load, shows no slope.
        scales.append(problem.scales.mean - problem.scales.std)
    ends = [best_fit(problem, starts, one) for one in scales]
    return max(ends, key=lambda end: end.log_evidence)


def _leading(problem: Problem, current: Fit, own: list[np.ndarray]) -> list[np.ndarray]:
    """Of many starts those that the misses ask for most."""
    states = [problem.predict(np.append(current.parameters, start)) for start in own]
    asked = [asked_along(current, one.slope[:, current.parameters.size :]) for one in states]
    return [own[k] for k in np.argsort(asked)[: -_PLACES - 1 : -1]]


def _names(one: Mechanism) -> list[str]:
    return [p.name for p in one.parameters]


def _alike(one: Mechanism, other: Mechanism, fitted: Fit) -> np.ndarray:
    """Coordinates of a form, those that another has too as they were fitted with it."""
    values, _ = other.values(fitted.parameters[-len(other.parameters) :])
    there = dict(zip(_names(other), values, strict=True))
    start = one.start
    for k, p in enumerate(one.parameters):
        if p.name in there:
            inside = (p.high - p.low) * _INSIDE if p.bounded else 0.0
            value = np.clip(there[p.name], p.low + inside, p.high - inside)
            start[k] = p.coordinate(float(value))
    return start


def without(channel: Channel, model: Model, gone: str) -> Model:
    """The model without one of its causes; its log evidence is by the forms that it has."""
    kept = [one for one in model.causes if one.id != gone]
    owns = zip(model.causes, places(model.causes, channel.base), strict=True)
    start = np.delete(model.fit.parameters, next(own for one, own in owns if one.id == gone))
    fitted = fit(channel.problem(kept, ()), start, model.fit.scales)
    change = fitted.log_evidence - model.fit.log_evidence
    return Model(tuple(kept), fitted, model.log_evidence + change, maxima=model.maxima)


def smooth(channel: Channel, model: Model) -> dict[str, float]:
    """Log evidence over the model of each smooth competitor beside its causes.

    Of curves it is at least what their errors are strained by, which whatever explains them saves.
    Fitted from two starts beside no cause, and where the data ask for it.
    """
    gains, current = {}, model.fit
    own, competitors, choices = current.scales.size, channel.smooth(current), 1
    if channel.spell is not None:
        competitors[SPELL], choices = channel.spell(current)
    for name, kernels in competitors.items():
        problem = channel.problem(model.causes, kernels)
        usual, wide = problem.scales.mean, problem.scales.std
        starts = [np.append(current.scales, usual[own:])]
        if not model.causes or _asks(current, kernels):
            # scatter that has made up for what is smooth hides it
            less = np.minimum(current.scales, usual[:own]) - 2.0 * wide[:own]
            starts.append(np.append(less, usual[own:] + wide[own:]))
        both = [fit(problem, current.parameters, scales) for scales in starts]
        gains[name] = max(one.log_evidence for one in both) - current.log_evidence
    if SPELL in gains:
        gains[SPELL] -= float(np.log(choices))
    if channel.name == "curve":  # what begins at once is not smooth, and strains the errors
        gains["amplitude"] = max(gains["amplitude"], strain(current))
    return gains


def _asks(current: Fit, kernels: Kernels) -> bool:
    """Whether a fit's misses ask for one of these covariances."""
    return any(asked_for(current, unit) > guards.ASKED for unit, _ in kernels)
