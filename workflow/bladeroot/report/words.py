"""What a report calls the load, and what it compares with."""

from collections.abc import Mapping
from dataclasses import dataclass

import xarray as xr

from bladeroot.loads import AXIAL_FORCE, shown
from bladeroot.report.numbers import NONE, fixed


@dataclass(frozen=True)
class Words:
    """The load's full and short name and unit, and the factor to it; empty without a load."""

    load: str
    short: str
    unit: str
    factor: float

    @property
    def header(self) -> str:
        """Head of a table's column."""
        return f"{self.short} / {self.unit}" if self.load else "load"

    def value(self, load: float) -> str:
        """A load as a number in a column, a dash without one."""
        return fixed(self.factor * load, 2) if self.load else NONE

    @property
    def at_one(self) -> str:
        """` at one force`, or nothing."""
        return f" at one {self.short}" if self.load else ""


def words_of(artifact: xr.Dataset) -> Words:
    """From an artifact's attributes."""
    factor, unit, name = shown(artifact.attrs)
    return Words(name, "force" if name == AXIAL_FORCE else name, unit, factor)


def gauge_sentence(description: Mapping) -> list[str]:
    """How the load was read, a sentence; none where there is none."""
    gauge = description.get("load") or description.get("force")
    if not gauge:
        return []
    kind = gauge.get("gauge", "")
    name, unit = gauge.get("name", AXIAL_FORCE), gauge.get("unit", "N")
    what = {
        "pressure": "read from the actuator's pressure on {piston_area_cm2:g} cm², full scale "
        "{full_scale_bar:g} bar",
        "strain": "read from strain gauges, full scale {full_scale_microstrain:g} microstrain",
        "": "stated",
    }.get(kind, f"read with a {kind}").format(**gauge)
    if "full_scale" in gauge:
        what += f", full scale {gauge['full_scale']:g} {unit}"
    if "accuracy_percent" in gauge:
        of = gauge.get("accuracy_of", "reading").replace("-", " ")
        what += f", accurate to {gauge['accuracy_percent']:g} % of the {of}"
    elif "accuracy" in gauge:
        what += f", accurate to {gauge['accuracy']:g} {unit}"
    return [f"The {name} is {what}."]


@dataclass(frozen=True)
class Judge:
    """What the measurement is compared with, as the subject of a sentence: a simulation that there
    is, or linear modes.
    """

    subject: str
    plural: bool

    def does(self, one: str, many: str) -> str:
        """`The simulation explains`, `Linear modes explain`."""
        return f"{self.subject} {many if self.plural else one}"


def judge_of(diagnosis: xr.Dataset) -> Judge:
    """From a diagnosis's artifact."""
    alone = diagnosis.attrs.get("kind") == "none"
    return Judge("Linear modes", True) if alone else Judge("The simulation", False)


CUTS = (
    "Raw records and the free decay that was cut out by itself: for each mode the lowest and the "
    "highest load, where there is one, then a few that are rejected (one for each kind of fault) "
    "and those of which most is masked, with the reason. Dashed: release, or start of the decay, "
    "and its end."
)
SPECTRA = (
    "Amplitude spectra of the same free decays before and after the mode was separated, all three "
    "of the longest part that is not masked and where the mode was followed (its times after "
    "the start of the cut in the title; the whole decay where none was). What is left over should "
    "contain the other modes and the noise, and nothing of the mode: where it stands above the "
    "free decay the separation failed."
)
