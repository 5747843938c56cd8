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
# Tests beside the campaign: a phrase, in which `{size}` is a load, and by the mechanism whose first
# parameter each measures how well.
FACTS = {
    "load cell": (
        "{second_measure}, up and down (to 0.5 % and {size})",
        {"force-gain": 0.005, "force-offset": 50.0, "gauge-friction": 0.005},
    ),
    "rig stiffness": (
        "a tap test of the empty rig (slots' stiffness to 1 %)",
        {"rig-compliance": 0.01},
    ),
    "weighing": ("weighing the {beam} as tested (to 1 g)", {"added-mass": 1e-3}),
    "free-free": ("a free-free test of the {beam} (modulus to 0.2 %)", {"modulus-density": 2e-3}),
    "pressure film": (
        "pressure-sensitive film in the contact (seating {force} to {size})",
        {"incomplete-contact": 500.0},
    ),
}
CLAMPINGS = (2, 4, 8)  # of a proposal, in each direction
HARDER = 2.0  # times the usual amplitude at release
# Times (s) in a clamping that is kept, of records of each mode.
KEPT = (0.0, 720.0, 1440.0, 2160.0, 2880.0, 3600.0)


@dataclass(frozen=True)
class Option:
    """A measurement. records, hold: what it adds to the stick frequencies (hold: of the addition).

    facts: what it measures beside the records, by mechanism, to which standard deviation. times:
    the amplitude of its curves over the campaign's.
    """

    kind: str
    what: str
    hours: float
    records: Records | None = None
    hold: Int[ndarray, " record"] | None = None
    facts: Mapping[str, float] = field(default_factory=dict)
    times: float = 1.0

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


def of_facts(made: Diagnosis, as_size: Callable[[float], str]) -> list[Option]:
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
            size = as_size(max(facts.values()))
            said = made.terms.say(what).replace("{size}", size)
            options.append(Option(kind, said, hours["visit"] + hours[kind], facts=useful))
    return options


def of_records(made: Diagnosis, as_text: Callable[[float], str]) -> list[list[Option]]:
    """Further records, of each kind in several sizes: all again, other loads, both directions,
    clampings that are kept, larger amplitudes.
    """
    data, hours = made.data, _hours(made)
    records = data.records

    def option(kind: str, what: str, new: Records, hold: ndarray) -> Option:
        time = np.unique(hold).size * hours["clamping"] + new.mode.size * hours["record"]
        return Option(kind, what, hours["visit"] + time, new, hold)

    def sized(kind: str, what: str, force: float, signs=(0.0,), since=(0.0,)) -> list[Option]:
        new = {n: _clampings(data, force, [*signs] * n, since) for n in CLAMPINGS}
        text = what.format(as_text(force))
        return [option(kind, f"{n} {text}", *new[n]) for n in CLAMPINGS]

    top, bottom = float(records.force.max()), float(records.force.min())
    higher, lower = 2.0 * top, max(0.5 * bottom, made.settings.least_force)
    middle = float(np.unique(records.force)[np.unique(records.force).size // 2])
    low, high = made.simulated.load_range
    higher, lower = min(higher, high), max(lower, low)
    if made.simulated.kind != "structure" and top == bottom:
        higher = lower = top
    holds = np.unique(data.hold, return_inverse=True)[1]
    options = [[option("all again", "the whole campaign once more", records, holds)]]
    if higher > 1.05 * top:
        options.append(sized("another load", "clampings at {}, every mode", higher))
    if lower < 0.95 * bottom:
        options.append(sized("another load", "clampings at {}, every mode", lower))
    if data.direction_known:
        what = "clampings up and as many down at {}, every mode"
        options.append(sized("both directions", what, middle, (1.0, -1.0)))
    if data.time_known:
        what = f"clampings at {{}} kept for an hour, {len(KEPT)} records of every mode"
        options.append(sized("kept clamping", what, middle, since=KEPT))
    if not made.curve_lacks:
        what = f"clampings at {{}}, every mode, released at {HARDER:g} times the amplitude"
        some = sized("larger amplitude", what, middle)
        options.append([replace(one, times=HARDER) for one in some])
    return options


def _clampings(
    data: StickData, force: float, signs: Sequence[float], since: Sequence[float]
) -> tuple[Records, ndarray]:
    """New holds at a force, one a sign, each with every mode at such times (s) in it, one after the
    other at the end of the campaign; the last temperature stays.
    """
    modes, old = len(data.modes), data.records
    hold, late, mode = (
        part.ravel()
        for part in np.meshgrid(np.arange(len(signs)), since, np.arange(modes), indexing="ij")
    )
    warm = old.temperature
    records = Records(
        mode, np.full(mode.size, force), np.array(signs)[hold], old.span + hold * late.max() + late,
        late, old.span, max(late.max(), old.hold_span),
        None if warm is None else np.full(mode.size, warm[np.argmax(old.time)]),
    )  # fmt: skip
    return records, hold
