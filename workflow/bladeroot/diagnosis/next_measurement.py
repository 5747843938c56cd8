"""Which further measurement decides most of what is open, for an hour of the laboratory's time.

Every possible set of causes, fitted to the campaign, predicts what a measurement will show, with
its uncertainty; a law's own error is part of that. The more the predictions differ, the more the
measurement decides: the expected fall of the entropy of the verdict's probabilities.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import accumulate

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray
from scipy.linalg import block_diag

from bladeroot.diagnosis import curve_model, stick_model
from bladeroot.diagnosis.curve_model import CurveData
from bladeroot.diagnosis.dataset import stiffness_law
from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.naming import Found
from bladeroot.diagnosis.options import Option, of_facts, of_records
from bladeroot.diagnosis.posterior import Sets, entropy, inclusion, temperature
from bladeroot.diagnosis.stick_model import StickData
from bladeroot.diagnosis.verdict import probabilities
from bladeroot.inference.gaussian import Fit, information
from bladeroot.inference.problem import Problem
from bladeroot.mechanisms.mechanism import Mechanism, Records, rows_of
from bladeroot.variables import dataset, names

_RIVALS = 5  # sets of causes, most probable first, whose predictions are compared
_NEAREST = 2  # mechanisms that are asked about where none explains the data
_DRAWS = 400
_LEAST = 0.04  # nats, and part of a question: what decides less decides nothing


@dataclass(frozen=True)
class Rival:
    """A possible set of causes of a channel: its model and its probability.

    heat: by which the channel's evidence is divided.
    """

    mechanisms: tuple[Mechanism, ...]
    fit: Fit
    probability: float
    heat: float


def next_measurements(
    made: Diagnosis,
    as_text: Callable[[float], str] = "{:.3g} N".format,
    as_size: Callable[[float], str] = "{:.3g} N".format,
) -> xr.Dataset:
    """What each possible measurement is expected to decide, the best for its hours first.

    as_text, as_size: a load, and a small difference of it, as text.

    dims option, stiffness; the first option is the campaign as it is. `decided`: the expected fall
    of the entropy of what is possible (`rivals`, in its attributes) over that entropy, NaN where
    nothing is open. `size_std`: of the first parameter of the most probable cause, over the present
    one. `expected_ln_std`: of ln kn and ln kt at 12 kN, NaN without a structure.
    """
    by_name = {found.channel.name: found for found in made.found}
    stick = by_name.get("stick")
    if stick is None:
        return xr.Dataset()
    for asked in _asked(made):
        found = _of_question(made, by_name, asked, as_text, as_size)
        if (found["decided"] > 0.0).any():
            break  # else no measurement that is known here speaks of it, but of the next perhaps
    return found


def _of_question(
    made: Diagnosis,
    by_name: Mapping[str, Found],
    asked: set[str],
    as_text: Callable[[float], str],
    as_size: Callable[[float], str],
) -> xr.Dataset:
    """Of the measurements where such mechanisms are in question."""
    whole = _open_nats(made, asked)
    rivals = {n: _rivals(by_name[n], asked) for n in ("stick", "curve") if n in by_name}

    def row(one: Option) -> dict:
        return _row(made, asked, rivals, one, whole)

    def rate(row: Mapping) -> float:
        return float(np.nan_to_num(row["decided"] / row["hours"]))

    tests = sorted(of_facts(made, as_size), key=lambda one: -rate(row(one)))
    together = accumulate(tests, lambda some, one: some.with_test(one, made))
    others = [*{one.what: row(one) for one in (*tests, *together)}.values()]
    others += [max(map(row, some), key=rate) for some in of_records(made, as_text)]
    rows = [row(Option("", "as measured", np.nan)), *sorted(others, key=rate, reverse=True)]
    values = {name: np.array([one[name] for one in rows]) for name in names("diagnosis/next")}
    values["option"] = [one["option"] for one in rows]
    values["stiffness"] = np.array(made.simulated.stiffnesses, dtype=str)
    found = dataset("diagnosis/next", values)
    found["decided"].attrs["rivals"] = ";".join(sorted(asked))
    return found


def following(found: xr.Dataset, made: Diagnosis) -> list[dict]:
    """`next` of the verdict: measurements that decide anything, the best for its hours first.

    Last, what tells a mechanism that may not be named yet from others: not weighed (None).
    """
    weighed = [
        {
            "measurement": str(one["kind"].item()),
            "what": str(one["option"].item()),
            "hours": round(float(one["hours"]), 3),
            "decides": round(float(one["decided"]), 4),
            "load": None if np.isnan(one["new_force"]) else float(one["new_force"]),
            "clampings": int(one["clampings"]),
        }
        for one in (found.isel(option=k) for k in range(1, found.sizes.get("option", 0)))
        if float(one["decided"]) > 0.0
    ]
    unknown = dict.fromkeys(("hours", "decides", "load"))
    return weighed + [
        {
            "measurement": "discriminating measurement",
            "what": made.terms.say(one.alone[one.insufficient].causes[0].splitter),
            **unknown,
            "clampings": 0,
        }
        for one in made.found
        if one.insufficient
    ]


def _asked(made: Diagnosis) -> list[set[str]]:
    """The mechanisms in question, first things first: those that may be what the data
    show to be missing, those that come nearest to it, those that the data would not show.
    """

    def nearest(found: Found) -> list[str]:
        return sorted(found.alone, key=lambda name: -found.alone[name].log_evidence)[:_NEAREST]

    shown = {
        name
        for found in made.found
        for cause in found.causes
        for name in cause.credible
        if len(cause.credible) > 1
    } | {found.insufficient for found in made.found if found.insufficient}
    known = {name for found in made.found for name in found.alone}
    asks = (
        shown,
        {name for found in made.found if found.unexplained for name in nearest(found)},
        {name for found in made.found for name in found.open},
    )
    return [some & known for some in asks if some & known] or [set()]


def _open_nats(made: Diagnosis, asked: set[str]) -> float:
    """Entropy of what is in question (nothing: 0); what is barred is as open as can be."""
    if not asked:
        return 0.0
    sets: Sets = {}
    for key, value in probabilities(made).items():
        sets[key & asked] = sets.get(key & asked, 0.0) + value
    # of a single set rounding may leave some
    there = entropy(sets) if len(sets) > 1 else 0.0
    return there + (np.log(2.0) if asked & set(made.known.barred) else 0.0)


def _rivals(found: Found, asked: set[str]) -> list[Rival]:
    """The most probable sets of a channel that were fitted, with what is in question.

    What is of no catalogue predicts nothing: sets with it are no rivals.
    """
    odds = {found.here: 0.0} | {
        key: value
        for key, value in found.probabilities.items()
        if key in found.models and key - found.here <= asked
    }
    order = sorted(odds, key=lambda key: (-odds[key], sorted(key)))[:_RIVALS]
    alone = [one.fit.log_evidence - found.baseline.log_evidence for one in found.alone.values()]
    heat = temperature(max(alone, default=0.0), found.known.replicates, found.channel.trust)
    models = [found.models[key] for key in order]
    return [Rival(one.causes, one.fit, odds[one.ids], heat) for one in models]


def _row(
    made: Diagnosis, asked: set[str], rivals: Mapping[str, list[Rival]], one: Option, whole: float
) -> dict:
    stick = rivals["stick"]
    base = next(found for found in made.found if found.channel.name == "stick").channel.base
    first = max((r for r in stick if r.mechanisms), key=lambda r: r.probability, default=stick[0])
    gained, covariance = 0.0, first.fit.covariance
    load = np.nan
    if one.facts:
        gained, covariance = _by_facts(made, asked, one.facts, first, base)
    elif one.records is not None:
        load = float(one.records.force.mean())
        data = _joined(made.data, one.records, made.data.hold.max() + 1 + one.hold)
        n, m = made.data.ln_f.size, data.ln_f.size
        problems = [stick_model.problem(data, made.simulated, r.mechanisms) for r in stick]
        old, new = np.arange(n), np.arange(n, m)
        gained += _gained(stick, problems, old, new)
        again, known = problems[stick.index(first)], first.fit
        covariance = np.linalg.inv(information(again, known.parameters, known.scales))
        if "curve" in rivals and not made.curve_lacks:
            curves, old, new = _more_curves(made.curves, load, one.times)
            models = [curve_model.problem(curves, r.mechanisms) for r in rivals["curve"]]
            gained += _gained(rivals["curve"], models, old, new)
    ratio = np.nan
    if first.mechanisms:
        ratio = float(np.sqrt(covariance[base, base]) / first.fit.std[base])
    ln_std = np.zeros(0)
    if made.simulated.stiffnesses:
        names, pivot = made.simulated.stiffnesses, made.simulated.pivot_of(made.data.records)
        at = np.array([pivot])
        rows = stiffness_law(first.fit.parameters, base, first.mechanisms, at, names, pivot)[1]
        ln_std = np.sqrt(np.diag(rows[:, 0] @ covariance @ rows[:, 0].T))
    part = min(gained / whole, 1.0) if whole > 0.0 else np.nan
    return {
        "option": one.what,
        "decided": 0.0 if whole > 0.0 and min(gained, part) < _LEAST else part,
        "hours": one.hours,
        "size_std": ratio,
        "expected_ln_std": ln_std,
        "kind": one.kind,
        "new_force": load,
        "clampings": 0 if one.hold is None else np.unique(one.hold).size,
    }


def _gained(
    rivals: Sequence[Rival], problems: Sequence[Problem], old: ndarray, new: ndarray
) -> float:
    """Nats that data at `new` decide between a channel's sets.

    Scatter and noise are the laboratory's, not a cause's: those of the most probable set. What a
    poor law counts as noise would come again.
    """
    if len(rivals) < 2:
        return 0.0
    fits = [replace(one.fit, scales=rivals[0].fit.scales) for one in rivals]
    predicted = [_predicted(p, one, old, new) for p, one in zip(problems, fits, strict=True)]
    return nats(predicted, np.array([one.probability for one in rivals]), rivals[0].heat)


def _predicted(problem: Problem, fitted: Fit, old: ndarray, new: ndarray) -> tuple[ndarray, ...]:
    """Mean and covariance of data at rows `new` of a problem, by a fit to those at `old`."""
    state = problem.predict(fitted.parameters)
    own, slope = problem.covariance(state, fitted.scales)[0], state.slope
    gain = np.linalg.solve(own[np.ix_(old, old)], own[np.ix_(old, new)]).T
    free = slope[new] - gain @ slope[old]
    spread = (
        own[np.ix_(new, new)] - gain @ own[np.ix_(old, new)] + free @ fitted.covariance @ free.T
    )
    # Where the scatter is large, rounding leaves it less symmetric than the noise is small.
    return state.mean[new] + gain @ (fitted.problem.data - state.mean[old]), 0.5 * (
        spread + spread.T
    )


def _by_facts(
    made: Diagnosis, asked: set[str], facts: Mapping[str, float], first: Rival, base: int
) -> tuple[float, ndarray]:
    """Nats that tests of mechanisms' first parameters decide, and the fit's covariance after.

    Where a mechanism is not the cause, its test shows none of it.
    """
    sets, gained = probabilities(made), 0.0
    for found in made.found:
        for name in sorted(facts.keys() & found.alone.keys() & asked):
            value, std = found.beside.get(name, found.alone[name]).size(name)
            odds = inclusion(sets, name)
            if name in made.known.barred:
                odds = min(odds, 0.5)
            there = (np.array([value]), np.array([[std**2 + facts[name] ** 2]]))
            absent = (np.zeros(1), np.array([[facts[name] ** 2]]))
            gained += nats([absent, there], np.array([1.0 - odds, odds]))
    covariance = first.fit.covariance
    if first.mechanisms and first.mechanisms[0].id in facts:
        size, column = first.mechanisms[0].parameters[0], covariance[:, base]
        slope = size.slope(size.value(float(first.fit.parameters[base])))
        error = facts[first.mechanisms[0].id] / slope
        covariance = covariance - np.outer(column, column) / (column[base] + error**2)
    return gained, covariance


def _joined(data: StickData, new: Records, hold: ndarray) -> StickData:
    """Data with further records behind; their frequencies are not known yet."""
    old, n = data.records, new.mode.size
    warm = data.temperature_covariance
    arrays = {
        f.name: np.concatenate([getattr(old, f.name), getattr(new, f.name)])
        for f in fields(Records)
        if isinstance(getattr(old, f.name), ndarray)
    }
    return replace(
        data,
        records=replace(old, **arrays),
        ln_f=np.concatenate([data.ln_f, np.zeros(n)]),
        std=np.concatenate([data.std, np.full(n, np.median(data.std))]),
        hold=np.concatenate([data.hold, hold]),
        row=np.concatenate([data.row, np.full(n, -1)]),
        group=None if data.group is None else np.concatenate([data.group, np.zeros(n, int)]),
        shared=None if data.shared is None else np.concatenate([data.shared, np.zeros(n)]),
        temperature_covariance=None
        if warm is None
        else block_diag(warm, np.median(np.diag(warm)) * np.eye(n)),
    )


def _more_curves(
    data: CurveData, force: float, times: float = 1.0
) -> tuple[CurveData, ndarray, ndarray]:
    """Curve data with the levels nearest to a force once more, there and at so many times their
    amplitudes; rows of old and new data.
    """
    points, count = data.points, data.points.mode.size
    off = np.abs(np.log(points.force / force))
    least = np.array(
        [off[points.mode == mode].min(initial=np.inf) for mode in range(len(data.modes))]
    )
    rows = np.concatenate([np.arange(count), np.flatnonzero(off <= least[points.mode])])
    new = np.arange(rows.size) >= count
    there = rows_of(points, rows)
    there.force[new] = force
    there.amplitude[new] *= times
    both, fresh = np.concatenate([rows, rows + count]), np.tile(new, 2)
    noise = data.noise[np.ix_(both, both)] * (fresh[:, None] == fresh)
    level = np.unique(data.level[rows] + new * (data.level.max() + 1), return_inverse=True)[1]
    made = CurveData(
        data.modes, there, data.value[both], noise, level, data.records[rows], data.stuck[rows]
    )
    return made, np.flatnonzero(~fresh), np.flatnonzero(fresh)


def nats(
    predicted: Sequence[tuple[ndarray, ndarray]], odds: Float[ndarray, " rival"], heat: float = 1.0
) -> float:
    """Nats that data are expected to decide between rivals of such odds, each with its Gaussian
    prediction of them (mean, covariance): the expected fall of the entropy, by draws.

    heat: by which the verdict will divide the evidence, as laws are not exact.
    """
    share = odds / odds.sum()
    if not share.min() > 0.0:
        return 0.0
    rng = np.random.default_rng(0)
    roots = [np.linalg.cholesky(covariance) for _, covariance in predicted]
    left = 0.0
    for p, (mean, _), root in zip(share, predicted, roots, strict=True):
        drawn = mean + rng.standard_normal((_DRAWS, mean.size)) @ root.T
        log = np.stack(
            [_log_density(drawn, m, r) for (m, _), r in zip(predicted, roots, strict=True)]
        )
        log = (log - log.max(axis=0)) / heat + np.log(share)[:, None]
        after = np.exp(log) / np.exp(log).sum(axis=0)
        left += -p * np.sum(after * np.log(np.maximum(after, 1e-300)), axis=0).mean()
    there = -(share @ np.log(share))
    return float(odds.sum() * np.clip(there - left, 0.0, there))


def _log_density(drawn: Float[ndarray, "draw datum"], mean: ndarray, root: ndarray) -> ndarray:
    scaled = np.linalg.solve(root, (drawn - mean).T)
    return -0.5 * (scaled**2).sum(axis=0) - np.log(np.diag(root)).sum()
