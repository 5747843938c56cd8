"""A channel: data of one kind, the models that may explain them, and how parts are held out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray

from bladeroot.diagnosis import curve_model, damping_model, stick_model
from bladeroot.diagnosis.curve_model import CurveData
from bladeroot.diagnosis.damping_model import DampingData
from bladeroot.diagnosis.guards import TRUST, TRUST_CURVE
from bladeroot.diagnosis.posterior import UNKNOWN
from bladeroot.diagnosis.simulation.interface import Simulation
from bladeroot.diagnosis.stick_model import StickData
from bladeroot.inference.gaussian import Fit
from bladeroot.inference.problem import Problem
from bladeroot.mechanisms.mechanism import Mechanism, Records

Kernels = Sequence[tuple[ndarray, float]]
# The smooth competitor is a rough course (Ornstein-Uhlenbeck, which finds steps) with a slow one
# beside it: for a rough one alone a plain trend is so unlikely that any law of that variable wins.
_FORCE_LENGTH = 1.0  # of ln F, over which the rough course forgets itself
_TIME_LENGTH = 0.5  # of the campaign, likewise
_SPELL_EDGES = 40  # clampings, at most, at which what lasts for a part of the campaign may begin
_SLOW = 1.5  # length of the slow course over the rough one's


@dataclass(frozen=True)
class Channel:
    """`stick`, `damping` or `curve`.

    problem: of mechanisms and of a smooth competitor's covariances. base: number of the baseline's
    parameters. smooth: competitors by what they are smooth in, about a fit. spell: one that lasts
    for a part of the campaign, and of how many it was chosen. part: by what may be left out, the
    number of the part that each datum belongs to. records: of stick frequencies. trust: the part of
    its own effect to which a law is exact. stiffnesses: which of `COORDINATES` each of the first
    parameters is, a stiffness of contacts, in which a posterior may have several maxima. unspoken:
    causes that want what the campaign does not say of its records, by id; `UNKNOWN` of data in
    which what is of no catalogue may leave no trace.
    """

    name: str
    problem: Callable[[Sequence[Mechanism], Kernels], Problem]
    base: int
    candidates: tuple[Mechanism, ...]
    smooth: Callable[[Fit], dict[str, Kernels]]
    part: dict[str, Int[ndarray, " datum"]]
    records: Records | None = None
    spell: Callable[[Fit], tuple[Kernels, int]] | None = None
    trust: float = TRUST
    stiffnesses: tuple[str, ...] = ()
    unspoken: tuple[str, ...] = ()

    def undone(self, one: Mechanism, own: Float[ndarray, " own"]) -> Float[ndarray, " base"]:
        """Shift of the baseline's parameters by which the contact stays as stiff as it was, on
        average over the records, where a mechanism with coordinates `own` changes it.
        """
        shift = np.zeros(self.base)
        if self.stiffnesses and one.stick is not None:
            changes = one.stick(self.records, one.values(own)[0]).changes
            means = [-np.mean(changes.get(name, 0.0)) for name in self.stiffnesses]
            shift[: len(means)] = means
        return shift


def stick_channel(
    data: StickData, simulated: Simulation, candidates: Sequence[Mechanism]
) -> Channel:
    """Stick frequencies; mechanisms that need times or directions stay only where these are."""
    judged, unspoken = _spoken([x for x in candidates if not simulated.silent(x)], "stick", data)
    return Channel(
        "stick",
        lambda mechanisms, extra: stick_model.problem(data, simulated, mechanisms, extra),
        simulated.of_records(data.records, data.hold, data.rounding).prior.mean.size,
        judged,
        lambda fitted: (
            _smooth(data, 3e-4) | (_contact(data, fitted) if simulated.knows_contact else {})
        ),
        _parts(data),
        data.records,
        (lambda fitted: _spell(data, fitted)) if _lasts(data, simulated) else None,
        stiffnesses=simulated.coordinates,
        unspoken=(*unspoken, UNKNOWN),  # as other operators that are not in the sheet
    )


def damping_channel(data: DampingData, candidates: Sequence[Mechanism]) -> Channel:
    """Loss factors of the stuck joint."""
    judged, unspoken = _spoken(candidates, "damping", data.stick)
    return Channel(
        "damping",
        lambda mechanisms, extra: damping_model.problem(data, mechanisms, extra),
        len(data.stick.modes),
        judged,
        lambda _: _smooth(data.stick, 0.03, together=True),
        _parts(data.stick),
        unspoken=unspoken,
    )


def curve_channel(data: CurveData, candidates: Sequence[Mechanism]) -> Channel:
    """Excess of frequency and loss factor over their plateaus."""
    force = np.unique(data.points.force, return_inverse=True)[1]
    return Channel(
        "curve",
        lambda mechanisms, extra: curve_model.problem(data, mechanisms, extra),
        0,
        tuple(one for one in candidates if one.channel == "curve"),
        lambda _: {"amplitude": curve_model.smooth_kernels(data)},
        {"force": np.tile(force, 2), "amplitude": np.tile(_quarters(data.points.amplitude), 2)},
        trust=TRUST_CURVE,
    )


def _spoken(
    candidates: Sequence[Mechanism], channel: str, data: StickData
) -> tuple[tuple[Mechanism, ...], tuple[str, ...]]:
    """Those whose variables the campaign knows and varies, and ids of those that want times or
    directions of records, and these are missing or alike.
    """
    known = _known(data)
    here = [one for one in candidates if one.channel == channel]
    judged = tuple(one for one in here if all(known[name] for name in one.over))
    said = {name for name in known if known[name]} | {"force", "temperature"}
    return judged, tuple(one.id for one in here if not said.issuperset(one.over))


def _known(data: StickData) -> dict[str, bool]:
    """Which variables of laws on records the campaign knows and varies."""
    return {
        "force": np.unique(data.records.force).size > 1,
        "time": data.time_known and data.records.span > 0.0,
        "clamping": data.time_known and data.records.span > data.records.hold_span,
        "since": data.time_known and data.records.hold_span > 0.0,
        # One way tells a law of the direction from nothing, too: friction of the gauge is a gain.
        "sign": bool(data.records.sign.any()),
        # Without a thermometer it is a drift.
        "temperature": data.records.temperature is not None
        and np.ptp(data.records.temperature) > 0,
    }


def not_judged(candidates: Sequence[Mechanism], data: StickData, simulated: Simulation) -> str:
    """A line on what the campaign, or the simulation, cannot speak of and what follows, or ""."""
    known = _known(data)
    silent: dict[str, list[str]] = {}
    for one in candidates:
        if one.channel == "stick" and (why := simulated.silent(one)):
            silent.setdefault(why, []).append(one.id)
    lines = [f"{', '.join(names)} not judged: {why}" for why, names in silent.items()]
    for names, lack in ((("time", "clamping", "since"), "times"), (("sign",), "directions")):
        missing = [
            one.id for one in candidates if any(n in one.over and not known[n] for n in names)
        ]
        if missing:
            lines.append(f"{', '.join(missing)} not judged: {lack} of records missing or alike")
    if data.untimed:
        lines.append(f"{data.untimed} records without a time left out")
    if data.thinned:
        fitted = data.ln_f.size
        lines.append(f"{data.thinned} records left out, as {fitted} of theirs say nearly as much")
    if data.unheld and data.time_known:
        lines.append(
            f"{data.unheld} records without a clamping: those one after another at one {{force}} "
            "and direction are taken for one clamping"
        )
    return ". ".join(lines)


def _smooth(data: StickData, size: float, together: bool = False) -> dict[str, Kernels]:
    """Smooth functions of force, of time and of the time in a clamping, and a step by direction.

    together: whether all modes may also have the rough course alike, as they scatter.
    """
    records, same = data.records, stick_model.same_mode(data).astype(float)

    def along(values: ndarray, length: float) -> Kernels:
        rough, slow = _courses(values, length)
        own = [(same * rough, size), (same * slow, size)]
        return [*own, (rough, size)] if together else own

    found = {"force": along(np.log(records.force), _FORCE_LENGTH)}
    if np.unique(records.force).size == 1 and data.group is not None:
        found = {}  # one condition: nothing runs with the load
    if data.time_known and records.span > 0.0:
        # Of the holds: what changes from hold to hold says nothing of records of one.
        found["time"] = along(records.time - records.since, _TIME_LENGTH * records.span)
    if data.time_known and records.hold_span > 0.0:
        share = records.since / records.hold_span
        found["time in a clamping"] = [(same * np.minimum(share[:, None], share), 0.1 * size)]
    if data.group is not None:
        alike = (data.group[:, None] == data.group).astype(float)
        found["group"] = [(same * alike, size)]
    if data.direction_known:
        found["direction"] = [(same * np.outer(records.sign, records.sign), size)]
    return found


def _contact(data: StickData, fitted: Fit) -> dict[str, Kernels]:
    """Contact stiffness, kn and kt alike, that is any function of the load, or wanders from hold to
    hold.
    """
    records, gradient = data.records, fitted.state.facts["gradient"][:, :2].sum(axis=1)
    both, found = np.outer(gradient, gradient), {}
    if np.unique(records.force).size > 1:
        found["force, through the contact"] = _courses(np.log(records.force), _FORCE_LENGTH)
    if data.time_known and records.span > 0.0:
        began = records.time - records.since
        found["time, through the contact"] = _courses(began, _TIME_LENGTH * records.span)
    return {name: [(both * one, 0.1) for one in courses] for name, courses in found.items()}


def _lasts(data: StickData, simulated: Simulation) -> bool:
    """Whether something may act through the contact for a while."""
    return simulated.knows_contact and np.unique(data.records.clamping).size > 2


def _spell(data: StickData, fitted: Fit) -> tuple[Kernels, int]:
    """Contact stiffness that differs from one clamping on until another: those two for which a
    fit's misses ask most; and of how many pairs they were chosen.

    Two laws that turn or give way just there explain it, too, and would be named.
    """
    records, gradient = data.records, fitted.state.facts["gradient"][:, :2]
    number = np.unique(records.clamping, return_inverse=True)[1]
    # what lasts from the first on, or to the last, is a step, which laws of the catalogue have
    edges = np.unique(np.linspace(1, number.max(), _SPELL_EDGES).astype(int))
    first, stop = (edges[k] for k in np.triu_indices(edges.size, 1))
    inside = (number[:, None] >= first) & (number[:, None] < stop)
    slopes = [own[:, None] * inside for own in gradient.T]
    seen = [fitted.precision @ one for one in slopes]
    (a, c), (_, d) = ([(one * other).sum(axis=0) for other in seen] for one in slopes)
    x, y = (fitted.residual @ one for one in seen)
    # Rao's score test of both slopes at once; of one mode they are one
    asked = (d * x**2 - 2.0 * c * x * y + a * y**2) / np.maximum(
        a * d - c**2, 1e-9 * a * d + 1e-300
    )
    best = gradient * inside[:, int(np.argmax(asked))][:, None]
    return [(np.outer(one, one), 0.1) for one in best.T], asked.size


def _courses(values: ndarray, length: float) -> tuple[ndarray, ndarray]:
    """Correlation of a rough course over values, and of a slow one."""
    rough = np.exp(-np.abs(values[:, None] - values) / length)
    return rough, stick_model.near(values, _SLOW * length)


def _parts(data: StickData) -> dict[str, Int[ndarray, " record"]]:
    """Parts to leave out: forces and holds, and of what else is known and varies quarters, or
    directions of a force, or groups.
    """
    records, known = data.records, _known(data)
    along = {
        "time": records.time - records.since,
        "clamping": records.clamping,
        "since": records.since,
        "temperature": records.temperature,
    }
    found = {name: _quarters(values) for name, values in along.items() if known[name]}
    found["force"] = np.unique(records.force, return_inverse=True)[1]
    found["hold"] = data.hold
    if data.direction_known:
        found["sign"] = np.unique(3 * found["force"] + records.sign, return_inverse=True)[1]
    return found if data.group is None else found | {"group": data.group}


def _quarters(values: ndarray) -> Int[ndarray, " datum"]:
    """Number of each value's quarter of all."""
    edges = np.quantile(values, (0.25, 0.5, 0.75))
    return np.unique(np.searchsorted(edges, values), return_inverse=True)[1]
