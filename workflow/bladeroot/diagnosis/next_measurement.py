"""Which further measurement would tell the possible causes apart, or make them known better.

Every possible cause, fitted to the campaign, predicts what a measurement will show, with its
uncertainty. The more the predictions differ, the more the measurement decides: the expected fall of
the entropy between the causes, counted at equal odds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis import stick_model
from bladeroot.diagnosis.dataset import stiffness_law
from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.families import starts_of
from bladeroot.diagnosis.naming import Found
from bladeroot.diagnosis.stick_model import StickData
from bladeroot.inference.gaussian import Fit, best_fit
from bladeroot.mechanisms.mechanism import Mechanism, Records
from bladeroot.stiffness.priors import REFERENCE_FORCE

# Tests beside the campaign by the mechanism whose first parameter they measure, and how well.
FACTS = {
    "force-gain": ("a load cell in the line of force (to 0.5 %)", 0.005),
    "force-offset": ("a load cell in the line of force (zero to 50 N)", 50.0),
    "added-mass": ("weighing the beam as tested (to 1 g)", 1e-3),
    "modulus-density": ("a free-free test of the beam (modulus to 0.2 %)", 2e-3),
    "rig-compliance": ("a tap test of the empty rig (slots' stiffness to 1 %)", 0.01),
}
CLAMPINGS = 2  # at a new force
_DRAWS = 400


@dataclass(frozen=True)
class Rival:
    """A possible cause of what the stick frequencies miss, fitted in place of the first one."""

    mechanisms: tuple[Mechanism, ...]
    fit: Fit


def next_measurements(made: Diagnosis) -> xr.Dataset:
    """What each possible measurement is expected to decide; empty where there is no stick law.

    dims option, stiffness. `decided`: the expected fall of the entropy between the `rivals` (ids in
    its attributes) over the entropy at equal odds, NaN where there is one rival. `size_std`: of the
    first parameter of the first rival. `expected_ln_std`: of ln kn and ln kt at 12 kN. The first
    option is the campaign as it is.
    """
    stick = next((one for one in made.found if one.channel.name == "stick"), None)
    if stick is None or made.simulated.kind != "structure":
        return xr.Dataset()  # without kn and kt there is no law to be known better
    rivals = _rivals(made, stick)
    rows = []
    for name, data in _records(made).items():
        rows.append((name, *_of_records(made, rivals, data, stick.channel.base)))
    for one in [r.mechanisms[0] for r in rivals if r.mechanisms]:
        if one.id in FACTS and one.measured_by not in made.known.splits:
            rows.append((FACTS[one.id][0], *_of_fact(rivals, one.id, stick.channel.base)))
    names, decided, size, ln_std = zip(*rows, strict=True)

    def var(dims, values, text: str) -> tuple:
        return (dims, np.array(values), {"units": "1", "long_name": text})

    found = xr.Dataset(
        {
            "decided": var("option", decided, "expected part of the question between the rivals "
                           "that the measurement decides"),
            "size_std": var("option", size, "expected standard deviation of the cause's size over "
                            "the present one"),
            "expected_ln_std": var(("option", "stiffness"), ln_std, "expected standard deviation "
                                   "of ln k at 12 kN"),
        },
        coords={"option": list(names), "stiffness": ["kn", "kt"]},
    )  # fmt: skip
    found["decided"].attrs["rivals"] = ";".join(r.mechanisms[0].id for r in rivals if r.mechanisms)
    return found


def _rivals(made: Diagnosis, found: Found) -> list[Rival]:
    """The named cause first, then what explains the data about as well, or else the next best if
    that explains half as much.

    A mechanism that may not be named for want of data is a rival all the same. Without a cause the
    baseline stands alone.
    """
    if not found.causes:
        return [Rival((), found.final)]
    first, gains = found.causes[0], found.steps[0].mechanisms
    named = tuple(cause.mechanism for cause in found.causes)
    order = sorted(gains, key=gains.get, reverse=True)
    others = [n for n in order if n != first.mechanism.id]
    near = [n for n in others if n in first.credible]
    by_id = found.forms
    taken = {one.id for one in named}
    serious = [name for name in others[:1] if gains[name] > 0.5 * first.gain]
    chosen = [by_id[name] for name in (near or serious) if name not in taken]
    rest = named[1:]
    rivals = [Rival(named, found.final)]
    for one in chosen:
        mine = (one, *rest)
        problem, starts = found.channel.problem(mine, ()), starts_of(found.channel, mine)
        rivals.append(Rival(mine, best_fit(problem, starts, found.final.scales)))
    return rivals


def _records(made: Diagnosis) -> dict[str, StickData | None]:
    """The campaign with further records; None: nothing new."""
    data, records = made.data, made.data.records
    options: dict[str, StickData | None] = {"as measured": None}
    options["the whole campaign once more"] = _joined(
        data, records, data.hold + data.hold.max() + 1
    )
    low, high = made.simulated.surface.low[2], made.simulated.surface.high[2]
    top, bottom = float(records.force.max()), float(records.force.min())
    higher = min(2.0 * top, high)
    lower = max(0.5 * bottom, made.settings.least_force, low)
    for force, worth in ((higher, higher > 1.05 * top), (lower, lower < 0.95 * bottom)):
        if worth:
            name = f"{CLAMPINGS} clampings at {force / 1e3:.3g} kN, every mode"
            options[name] = _joined(data, *_clampings(data, force))
    return options


def _clampings(data: StickData, force: float) -> tuple[Records, ndarray]:
    """New holds at a force, each with every mode, at the end of the campaign."""
    modes = len(data.modes)
    n = CLAMPINGS * modes
    none = np.zeros(n)
    records = Records(
        np.tile(np.arange(modes), CLAMPINGS), np.full(n, force), none,
        np.full(n, data.records.span), none, data.records.span, data.records.hold_span,
    )  # fmt: skip
    return records, data.hold.max() + 1 + np.repeat(np.arange(CLAMPINGS), modes)


def _joined(data: StickData, new: Records, hold: ndarray) -> StickData:
    """Data with further records behind; their frequencies are not known yet."""
    old, n = data.records, new.mode.size
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
    )


def _of_records(
    made: Diagnosis, rivals: Sequence[Rival], data: StickData | None, base: int
) -> tuple[float, float, ndarray]:
    """Expected part decided, ratio of the size's standard deviation, and std of ln kn, ln kt."""
    first = rivals[0]
    if data is None:
        nothing = 0.0 if len(rivals) > 1 else np.nan
        return nothing, 1.0 if first.mechanisms else np.nan, _ln_std(first, base, None)
    predicted, covariance = [], first.fit.covariance
    for number, rival in enumerate(rivals):
        fitted = rival.fit
        problem = stick_model.problem(data, made.simulated, rival.mechanisms)
        state = problem.predict(fitted.parameters)
        own = problem.covariance(state, fitted.scales)[0]
        n, slope = fitted.residual.size, state.slope
        gain = np.linalg.solve(own[:n, :n], own[:n, n:]).T
        miss = fitted.problem.data - state.mean[:n]
        free = slope[n:] - gain @ slope[:n]
        spread = own[n:, n:] - gain @ own[:n, n:] + free @ fitted.covariance @ free.T
        # Where the scatter is large, rounding leaves it less symmetric than the noise is small.
        predicted.append((state.mean[n:] + gain @ miss, 0.5 * (spread + spread.T)))
        if number == 0:
            weight = np.diag(1.0 / fitted.problem.prior.std**2)
            covariance = np.linalg.inv(slope.T @ np.linalg.solve(own, slope) + weight)
    ratio = _ratio(first, covariance, base)
    return decided(predicted), ratio, _ln_std(first, base, covariance)


def _of_fact(rivals: Sequence[Rival], name: str, base: int) -> tuple[float, float, ndarray]:
    """The same for an independent measurement of a mechanism's first parameter.

    Where the mechanism is not the cause, the measurement shows none of it.
    """
    std, predicted = FACTS[name][1], []
    for rival in rivals:
        has = rival.mechanisms[0].id == name
        mean, spread = (rival.fit.parameters[base], rival.fit.std[base]) if has else (0.0, 0.0)
        predicted.append((np.array([mean]), np.array([[spread**2 + std**2]])))
    first, covariance = rivals[0], rivals[0].fit.covariance
    if first.mechanisms[0].id == name:
        column = covariance[:, base]
        covariance = covariance - np.outer(column, column) / (column[base] + std**2)
    return decided(predicted), _ratio(first, covariance, base), _ln_std(first, base, covariance)


def decided(predicted: Sequence[tuple[ndarray, ndarray]]) -> float:
    """Expected fall of the entropy between Gaussian predictions (mean, covariance) of the same
    data, over ln of their number; at equal odds, by draws. NaN for one.
    """
    count = len(predicted)
    if count < 2:
        return np.nan
    rng = np.random.default_rng(0)
    roots = [np.linalg.cholesky(covariance) for _, covariance in predicted]
    left = 0.0
    for (mean, _), root in zip(predicted, roots, strict=True):
        drawn = mean + rng.standard_normal((_DRAWS, mean.size)) @ root.T
        log = np.stack(
            [_log_density(drawn, m, r) for (m, _), r in zip(predicted, roots, strict=True)]
        )
        log -= log.max(axis=0)
        odds = np.exp(log) / np.exp(log).sum(axis=0)
        left += -np.sum(odds * np.log(np.maximum(odds, 1e-300)), axis=0).mean() / count
    return float(1.0 - left / np.log(count))


def _log_density(drawn: Float[ndarray, "draw datum"], mean: ndarray, root: ndarray) -> ndarray:
    scaled = np.linalg.solve(root, (drawn - mean).T)
    return -0.5 * (scaled**2).sum(axis=0) - np.log(np.diag(root)).sum()


def _ratio(rival: Rival, covariance: ndarray, base: int) -> float:
    """Standard deviation of the first cause's size over the present one."""
    if not rival.mechanisms:
        return np.nan
    return float(np.sqrt(covariance[base, base]) / rival.fit.std[base])


def _ln_std(rival: Rival, base: int, covariance: ndarray | None) -> Float[ndarray, " 2"]:
    """Of ln kn and ln kt at 12 kN."""
    at = np.array([REFERENCE_FORCE])
    rows = stiffness_law(rival.fit, base, rival.mechanisms, at)[1][:, 0]
    of_k = rows @ (rival.fit.covariance if covariance is None else covariance) @ rows.T
    return np.sqrt(np.diag(of_k))
