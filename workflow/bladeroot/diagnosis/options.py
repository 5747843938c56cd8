"""Measurements that may come next: tests beside the campaign, and further records."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int
from numpy import ndarray

from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.stick_model import StickData
from bladeroot.mechanisms.mechanism import Records

# Hours of laboratory time: of a clamping, of a record in it, and of tests beside the campaign. A
# campaign's own stand in its `costs`.
COSTS = {
    "clamping": 0.5,
    "record": 0.1,
    "load cell": 3.0,
    "weighing": 1.0,
    "free-free": 2.0,
    "rig stiffness": 2.0,
}
SHARED = 0.5  # hours that two tests save which need the beam taken out once
# Tests beside the campaign: a phrase, and by the mechanism whose first parameter each measures how
# well.
FACTS = {
    "load cell": (
        "a load cell in the line of force, up and down (to 0.5 % and 50 N)",
        {"force-gain": 0.005, "force-offset": 50.0, "gauge-friction": 0.005},
    ),
    "rig stiffness": (
        "a tap test of the empty rig (slots' stiffness to 1 %)",
        {"rig-compliance": 0.01},
    ),
    "weighing": ("weighing the beam as tested (to 1 g)", {"added-mass": 1e-3}),
    "free-free": ("a free-free test of the beam (modulus to 0.2 %)", {"modulus-density": 2e-3}),
}
TOGETHER = (("load cell", "rig stiffness"), ("weighing", "free-free"))
CLAMPINGS = 2  # of a proposal, at each load and direction
_LONG, _STEPS = 3600.0, 6  # s that a clamping is kept, and records of each mode in that time


@dataclass(frozen=True)
class Option:
    """A measurement. records, hold: what it adds to the stick frequencies (hold: of the addition).

    facts: what it measures beside the records, by mechanism, to which standard deviation.
    """

    kind: str
    what: str
    hours: float
    records: Records | None = None
    hold: Int[ndarray, " record"] | None = None
    facts: Mapping[str, float] | None = None


def of_facts(made: Diagnosis) -> list[Option]:
    """Tests beside the campaign of mechanisms that are judged and not measured yet."""
    hours = COSTS | dict(made.settings.costs)
    open_ = {
        one.id
        for found in made.found
        for one in found.channel.candidates
        if one.measured_by not in made.known.splits
    }
    useful = {
        kind: {name: std for name, std in facts.items() if name in open_}
        for kind, (_, facts) in FACTS.items()
    }
    options = [
        Option(kind, FACTS[kind][0], hours[kind], facts=facts)
        for kind, facts in useful.items()
        if facts
    ]
    for one, other in TOGETHER:
        if useful[one] and useful[other]:
            what = f"{FACTS[one][0]}, and {FACTS[other][0]}"
            time = max(hours[one] + hours[other] - SHARED, hours[one], hours[other])
            both = useful[one] | useful[other]
            options.append(Option(f"{one} and {other}", what, time, facts=both))
    return options


def of_records(made: Diagnosis, told: Callable[[float], str]) -> list[Option]:
    """Further records: all again, other loads, both directions, a clamping that is kept."""
    data, hours = made.data, COSTS | dict(made.settings.costs)
    records, modes = data.records, len(data.modes)
    options = []

    def propose(kind: str, what: str, new: Records, hold: ndarray) -> None:
        time = np.unique(hold).size * hours["clamping"] + new.mode.size * hours["record"]
        options.append(Option(kind, what, time, new, hold))

    holds = np.unique(data.hold, return_inverse=True)[1]
    propose("all again", "the whole campaign once more", records, holds)
    top, bottom = float(records.force.max()), float(records.force.min())
    higher, lower = 2.0 * top, max(0.5 * bottom, made.settings.least_force)
    if made.simulated.kind == "structure":
        low, high = made.simulated.surface.low[2], made.simulated.surface.high[2]
        higher, lower = min(higher, high), max(lower, low)
    if top > bottom or made.simulated.kind == "structure":
        for force, worth in ((higher, higher > 1.05 * top), (lower, lower < 0.95 * bottom)):
            if worth:
                what = f"{CLAMPINGS} clampings at {told(force)}, every mode"
                propose("another load", what, *_clampings(data, force, [0.0] * CLAMPINGS))
    middle = float(np.unique(records.force)[np.unique(records.force).size // 2])
    if data.direction_known:
        what = f"{CLAMPINGS} clampings up and {CLAMPINGS} down at {told(middle)}, every mode"
        propose("both directions", what, *_clampings(data, middle, [1.0, -1.0] * CLAMPINGS))
    if data.time_known:
        late = np.repeat(np.linspace(0.0, _LONG, _STEPS), modes)
        new, hold = _clampings(data, middle, [0.0] * _STEPS)
        new = replace(new, since=late, time=new.time + late, hold_span=max(_LONG, new.hold_span))
        propose(
            "kept clamping",
            f"a clamping at {told(middle)} kept for an hour, {_STEPS} records of every mode",
            new, np.zeros_like(hold),
        )  # fmt: skip
    return options


def _clampings(data: StickData, force: float, signs: Sequence[float]) -> tuple[Records, ndarray]:
    """New holds at a force, each with every mode, at the end of the campaign."""
    modes, count = len(data.modes), len(signs)
    n = count * modes
    records = Records(
        np.tile(np.arange(modes), count), np.full(n, force), np.repeat(signs, modes),
        np.full(n, data.records.span), np.zeros(n), data.records.span, data.records.hold_span,
    )  # fmt: skip
    return records, np.repeat(np.arange(count), modes)
