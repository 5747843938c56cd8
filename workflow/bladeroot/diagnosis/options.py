"""Measurements that may come next: tests beside the campaign, and further records."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Int
from numpy import ndarray

from bladeroot.diagnosis.diagnose import Diagnosis
from bladeroot.diagnosis.stick_model import StickData
from bladeroot.mechanisms.mechanism import Records

# Hours of laboratory time: of going to the rig at all (half a day to find, set up, analyse), of a
# clamping, of a record in it, and of tests beside the campaign. A campaign's own: its `costs`.
COSTS = {
    "visit": 4.0,
    "clamping": 0.5,
    "record": 0.1,
    "load cell": 3.0,
    "weighing": 1.0,
    "free-free": 2.0,
    "rig stiffness": 2.0,
    "pressure film": 3.0,
}
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
    "pressure film": (
        "pressure-sensitive film between the flanks (seating force to 500 N)",
        {"incomplete-contact": 500.0},
    ),
}
CLAMPINGS = (2, 4, 8)  # of a proposal, at each load and direction
LOUDER = 2.0  # times the amplitudes of the campaign
_LONG, _STEPS = 3600.0, 6  # s that a clamping is kept, and records of each mode in that time


@dataclass(frozen=True)
class Option:
    """A measurement. records, hold: what it adds to the stick frequencies (hold: of the addition).

    facts: what it measures beside the records, by mechanism, to which standard deviation. louder:
    times the amplitudes of the campaign.
    """

    kind: str
    what: str
    hours: float
    records: Records | None = None
    hold: Int[ndarray, " record"] | None = None
    facts: Mapping[str, float] = field(default_factory=dict)
    louder: float = 1.0

    def with_test(self, other: "Option", made: Diagnosis) -> "Option":
        """This test and another one in one visit."""
        return Option(
            f"{self.kind} and {other.kind}",
            f"{self.what}, and {other.what}",
            self.hours + other.hours - _hours(made)["visit"],
            facts={**self.facts, **other.facts},
        )


def _hours(made: Diagnosis) -> dict[str, float]:
    return COSTS | dict(made.settings.costs)


def of_facts(made: Diagnosis) -> list[Option]:
    """Tests beside the campaign of mechanisms that are judged and not measured yet."""
    hours = _hours(made)
    open_ = {
        one.id
        for found in made.found
        for one in found.channel.candidates
        if one.measured_by not in made.known.splits
    }
    options = []
    for kind, (what, facts) in FACTS.items():
        useful = {name: std for name, std in facts.items() if name in open_}
        if useful:
            options.append(Option(kind, what, hours["visit"] + hours[kind], facts=useful))
    return options


def of_records(made: Diagnosis, told: Callable[[float], str]) -> list[list[Option]]:
    """Further records, of each kind in several sizes: all again, other loads, larger amplitudes,
    both directions, clampings that are kept.
    """
    data, hours = made.data, _hours(made)
    records, modes = data.records, len(data.modes)
    options = []

    def option(kind: str, what: str, new: Records, hold: ndarray, louder: float = 1.0) -> Option:
        time = np.unique(hold).size * hours["clamping"] + new.mode.size * hours["record"]
        return Option(kind, what, hours["visit"] + time, new, hold, louder=louder)

    def propose(kind: str, what: str, force: float, signs: Sequence[float], louder: float = 1.0):
        options.append(
            [
                option(kind, what.format(n), *_clampings(data, force, [*signs] * n), louder)
                for n in CLAMPINGS
            ]
        )

    holds = np.unique(data.hold, return_inverse=True)[1]
    options.append([option("all again", "the whole campaign once more", records, holds)])
    top, bottom = float(records.force.max()), float(records.force.min())
    higher, lower = 2.0 * top, max(0.5 * bottom, made.settings.least_force)
    if made.simulated.kind == "structure":
        low, high = made.simulated.surface.low[2], made.simulated.surface.high[2]
        higher, lower = min(higher, high), max(lower, low)
    if top > bottom or made.simulated.kind == "structure":
        for force, worth in ((higher, higher > 1.05 * top), (lower, lower < 0.95 * bottom)):
            if worth:
                propose(
                    "another load", f"{{}} clampings at {told(force)}, every mode", force, [0.0]
                )
    if made.curves is not None and not made.curve_lacks:
        for force in {bottom, top}:
            what = f"{{}} clampings at {told(force)} with amplitudes {LOUDER:g} times as large"
            propose("larger amplitude", what, force, [0.0], LOUDER)
    middle = float(np.unique(records.force)[np.unique(records.force).size // 2])
    if data.direction_known:
        what = f"{{0}} clampings up and {{0}} down at {told(middle)}, every mode"
        propose("both directions", what, middle, [1.0, -1.0])
    if data.time_known:
        what = f"{{}} clampings at {told(middle)} kept for an hour, {_STEPS} records of every mode"
        kept = []
        for n in CLAMPINGS:
            new, hold = _clampings(data, middle, [0.0] * (n * _STEPS))
            since = np.tile(np.repeat(np.linspace(0.0, _LONG, _STEPS), modes), n)
            time = new.time + since + (hold // _STEPS) * _LONG
            span = max(_LONG, new.hold_span)
            new = replace(new, since=since, time=time, hold_span=span)
            kept.append(option("kept clamping", what.format(n), new, hold // _STEPS))
        options.append(kept)
    return options


def _clampings(data: StickData, force: float, signs: Sequence[float]) -> tuple[Records, ndarray]:
    """New holds at a force, each with every mode, at the end of the campaign."""
    modes, count = len(data.modes), len(signs)
    n = count * modes
    last = None if data.records.temperature is None else np.zeros(n)
    records = Records(
        np.tile(np.arange(modes), count), np.full(n, force), np.repeat(signs, modes),
        np.full(n, data.records.span), np.zeros(n), data.records.span, data.records.hold_span, last,
    )  # fmt: skip
    return records, np.repeat(np.arange(count), modes)
