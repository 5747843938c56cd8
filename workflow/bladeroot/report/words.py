"""What a report calls the load, and the captions that depend on it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
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

    def value(self, load: float, digits: int = 2) -> str:
        """A load as a number in a column, a dash without one."""
        return fixed(self.factor * load, digits) if self.load else NONE

    def at(self, load: float) -> str:
        """` at 12 kN`, or nothing."""
        return f" at {self.factor * load:.4g} {self.unit}" if self.load else ""

    @property
    def at_one(self) -> str:
        """` at one force`, or nothing."""
        return f" at one {self.short}" if self.load else ""


def words_of(artifact: xr.Dataset) -> Words:
    """From an artifact's attributes."""
    factor, unit, name = shown(artifact.attrs)
    return Words(name, "force" if name == AXIAL_FORCE else name, unit, factor)


def several_groups(stick: xr.Dataset) -> bool:
    """Whether records belong to more than one group."""
    return "record_group" in stick and np.unique(stick["record_group"].values).size > 1


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


def pictures(words: Words) -> dict[str, str]:
    """Captions of the figures of records by name."""
    load = words.short
    ends = f" at the lowest and the highest {load}" if load else ""
    colour = (
        f"coloured by {load} (by hold or record where there is one {load} only)"
        if load
        else "coloured by group and sensor, hold or record"
    )
    where = (
        f"at each {load}, over the base line of its {load}"
        if load
        else "of each group and sensor, each over a base line of its own"
    )
    return {
        "cuts": f"Raw records and the free decay that was cut out by itself: for each mode{ends}, "
        "then a few that are rejected (one for each kind of fault) and those of which most is "
        "masked, with the reason. Dashed: release, or start of the decay, and its end.",
        "spectra": "Amplitude spectra of the same free decays before and after the mode was "
        "separated, all three of the longest stretch that is not masked and where the mode was "
        "followed (its times after the start of the cut in the title; the whole decay where none "
        "was). What is left over should hold the other modes and the noise, and nothing of the "
        "mode: where it stands above the free decay the separation failed.",
        "backbones": "Natural frequency and loss factor against displacement amplitude (FREEVIB, "
        f"3.11), a curve for each usable record (at most 100 a mode), {colour}; bands are one "
        "standard error, and points are drawn where it is below 0.1 % of the frequency and 20 % of "
        "the loss factor.",
        "waterfall": f"Mean curve of all records {where}; the base lines are evenly spaced, the "
        "bar at the right is the curves' scale. Softening: how far the frequency lies below its "
        "value at the smallest amplitudes. The records' own levels are taken off before the mean "
        "and their mean is put back. Bands: plus and minus one standard error of the change with "
        "amplitude, of one record alone where the line is thin; ±: standard deviation between the "
        "records, levels included (median over amplitude).",
        "amplitude_force": f"Natural frequency and loss factor over amplitude and {words.load}: "
        f"interpolated linearly between the {load}s that were measured (triangles). Blank where "
        f"one of the two {load}s beside has no record of that amplitude, or where the standard "
        "error of the change with amplitude exceeds 0.1 % of the frequency or 20 % of the loss "
        f"factor. At each {load} it is the mean of the records; how far they lie apart is beside "
        "the curves above.",
    }
