"""The report as a whole: the first page and its chapters, each a page of its own."""

import multiprocessing
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from multiprocessing.connection import Connection
from operator import itemgetter

import numpy as np
import pandas as pd
import xarray as xr

from bladeroot.figures import (
    curves,
    diagnosis,
    joint,
    nonlinear,
    records,
    residual_maps,
    spectra,
    stick,
    stiffness,
    structure,
    theory,
    thesis_search,
)
from bladeroot.figures.slider import slider
from bladeroot.report.diagnosis import diagnosis_section
from bladeroot.report.extended import extended_parts
from bladeroot.report.front import front_sections, provenance_section
from bladeroot.report.groups import groups_section
from bladeroot.report.integrity import integrity_section
from bladeroot.report.joint import joint_parts
from bladeroot.report.ledger import errata_section, ledger_section
from bladeroot.report.measurement import measurement_section, stick_section, table_5_1
from bladeroot.report.nonlinear import SLIP, nonlinear_section
from bladeroot.report.page import Picture, Place, Section, pictures, render
from bladeroot.report.stiffness import MAPS, stiffness_section
from bladeroot.report.structure import MODES, SIDE, structure_section
from bladeroot.report.table_5_2 import table_5_2_remarks
from bladeroot.report.theory import COMPARED, TRACTIONS, theory_section
from bladeroot.report.thesis_search import SETS, thesis_search_parts
from bladeroot.report.words import CUTS, SPECTRA

FRONT = "report.html"  # the first page, beside the chapters' folder
INDEX = "index.html"  # the same inside it
LIBRARY = "plotly.min.js"
_TITLES = {
    "measurement": "Measurement",
    "quality": "Quality",
    "stick": "Stick frequencies",
    "structure": "Structure",
    "stiffness": "Stiffness",
    "nonlinear": "Nonlinear joint",
    "diagnosis": "Diagnosis",
    "theory": "Theory",
    "comparison": "Comparison with the source",
}


@dataclass(frozen=True)
class Material:
    """All that a report is made of; what a campaign has not is empty.

    facts: campaign, description (campaign.yaml), modes in the order that it names them, structures,
    simulated, excluded, entry. stages: artifacts by name (stick; with records, integrity and
    curves; for simulated ones, score; with a structure, fe_forces, stiffness, theory; for the
    thesis's tables, ledger and slider). By structure, the main one first: checks, accuracies,
    calibrations, joints, diagnoses with their verdicts, extended (joints with the causes of a model
    file), amplitudes, shortfalls, thesis_searches, searches (and by force). of_records: reads
    decays, and shown and spectra, raw records as from `bladeroot.figures.records.worth_showing`;
    the process that draws them calls it. modes: SVG text. published: Tables 5.1 and 5.2 as shipped,
    for a campaign that states them. made: as `bladeroot.report.front.provenance_section`.
    """

    facts: Mapping
    stages: Mapping[str, xr.Dataset]
    diagnoses: Sequence[xr.Dataset]
    verdicts: Sequence[Mapping]
    made: Mapping
    of_records: Callable[[], Mapping[str, Sequence[xr.Dataset]]] | None = None
    mesh: xr.Dataset | None = None
    modes: str = ""
    checks: Sequence[xr.Dataset] = ()
    accuracies: Sequence[xr.Dataset] = ()
    calibrations: Sequence[xr.Dataset] = ()
    searches: Sequence[xr.Dataset] = ()
    joints: Sequence[xr.Dataset] = ()
    extended: Sequence[xr.Dataset] = ()
    amplitudes: Sequence[xr.Dataset] = ()
    shortfalls: Sequence[xr.Dataset] = ()
    thesis_searches: Sequence[xr.Dataset] = ()
    published: tuple[pd.DataFrame, xr.Dataset] | None = None
    errata: Sequence[dict] = field(default_factory=list)

    @property
    def simulated(self) -> bool:
        """Whether a virtual bench made the records."""
        return bool(self.facts["simulated"])

    @property
    def of_the_thesis(self) -> bool:
        """Whether its tables belong beside the results."""
        return self.facts["description"].get("published") == "thesis"


def report(given: Material, processes: int = 1) -> dict[str, str]:
    """The pages as HTML by their place below the campaign's results.

    processes: that draw side by side, one or two.
    """
    given = replace(given, stages={**given.stages, **_ordered(given.stages, given.facts["modes"])})
    with_structure = _WITH_STRUCTURE if given.facts["structures"] else {}
    judged, of_stick, of_records, *of_structures = _side_by_side(
        [_judged, _over_load, _of_records, *with_structure.values()], given, processes
    )
    chapters = {
        "measurement": _measurement(given, of_records),
        "quality": [integrity_section(given.stages["integrity"])]
        if "integrity" in given.stages
        else [],
        "stick": [_stick(given, of_stick)],
        **dict(zip(with_structure, of_structures, strict=True)),
        "diagnosis": [_diagnosis(given, judged)],
    }
    chapters = {name: chapters[name] for name in _TITLES if chapters.get(name)}
    pages = {
        f"report/{name}.html": _page(given, name, sections, chapters)
        for name, sections in chapters.items()
    }
    shows_it = _that_shows_it(given, judged)
    # the first page stands beside the chapters' folder, and once more inside it for an archive
    for place, where in ((f"report/{INDEX}", ""), (FRONT, "report/")):
        front = front_sections(
            given.facts,
            given.stages,
            given.joints,
            given.amplitudes,
            given.diagnoses,
            given.verdicts,
            of_records.get("means") or of_stick,
            shows_it,
            where,
        )
        front.append(provenance_section(given.made))
        pages[place] = _page(given, "", front, chapters, where)
    return pages


def _ordered(stages: Mapping[str, xr.Dataset], modes: Sequence[str]) -> dict[str, xr.Dataset]:
    """Stick frequencies and mean curves, the levels by mode in this order."""
    made = {}
    for name in {"stick", "curves"} & set(stages):
        places = [modes.index(mode) for mode in stages[name]["mode"].values.astype(str)]
        made[name] = stages[name].isel(level=np.argsort(places, kind="stable"))
    return made


def _page(
    given: Material, here: str, sections: Sequence[Section], chapters: Mapping, where: str = ""
) -> str:
    """A chapter, or without a name the first page; where: the way from it to the chapters."""
    links = [("In short", INDEX if here else "", not here)]
    links += [(_TITLES[name], f"{where}{name}.html", name == here) for name in chapters]
    return render(
        given.facts["description"]["title"],
        f"Campaign {given.facts['campaign']}{', ' + _TITLES[here].lower() if here else ''}",
        given.simulated,
        sections,
        f"bladeroot {given.made['version']}, {given.made['date']}",
        Place(links, f"{where}{LIBRARY}"),
    )


def _side_by_side(tasks: Sequence[Callable], given: object, processes: int) -> list:
    """What each task makes of what is given; with two processes the one that is free takes the
    next.
    """
    if processes < 2:
        return [task(given) for task in tasks]
    waiting, filled = os.pipe()
    os.write(filled, bytes(range(len(tasks))))
    os.close(filled)
    fork = multiprocessing.get_context("fork")
    receiver, sender = fork.Pipe(duplex=False)
    child = fork.Process(target=_send, args=(tasks, given, waiting, receiver, sender), daemon=True)
    child.start()
    sender.close()
    made = _taken(tasks, given, waiting)
    os.close(waiting)
    try:
        others = receiver.recv()
    except EOFError:
        raise RuntimeError("the second process that draws was ended") from None
    if isinstance(others, Exception):
        raise others
    return [task for _, task in sorted([*made, *others], key=itemgetter(0))]


def _taken(tasks: Sequence[Callable], given: object, waiting: int) -> list[tuple[int, object]]:
    """Numbers of tasks from the pipe, one at a time, and what these make, until it is empty."""
    made = []
    while number := os.read(waiting, 1):
        made.append((number[0], tasks[number[0]](given)))
    return made


def _send(
    tasks: Sequence[Callable],
    given: object,
    waiting: int,
    receiver: Connection,
    sender: Connection,
):
    receiver.close()  # the parent's alone: where it has ended, nothing can be sent
    try:
        sender.send(_taken(tasks, given, waiting))
    except Exception as error:
        sender.send(error)


def _of_records(given: Material) -> dict[str, list[Picture]]:
    """Figures of the records by what they show, in reading order."""
    if given.of_records is None:
        return {}
    read = given.of_records()
    modes = given.facts["modes"]
    decays = sorted(read["decays"], key=lambda decay: modes.index(decay.attrs["mode"]))
    return {
        "records": pictures(curves.records(decays)),
        "means": pictures(curves.means(given.stages["curves"])),
        "cuts": pictures(records.cuts(read["shown"]), CUTS),
        "spectra": pictures(spectra.spectra(read["spectra"]), SPECTRA),
    }


def _over_load(given: Material) -> list[Picture]:
    forces = given.stages.get("fe_forces")
    return pictures(stick.over_load(given.stages["stick"], forces, given.simulated))


def _measurement(given: Material, by_name: Mapping[str, list[Picture]]) -> list[Section]:
    found = given.stages.get("curves")
    groups = groups_section(found) if found is not None else None
    drawn = [picture for several in by_name.values() for picture in several]
    measured = measurement_section(given.facts, given.stages["stick"], drawn, found)
    return [measured, *([groups] if groups else [])]


def _stick(given: Material, drawn: Sequence[Picture]) -> Section:
    found, forces = given.stages["stick"], given.stages.get("fe_forces")
    section = stick_section(found, drawn, given.stages.get("score"), forces)
    if not given.of_the_thesis:
        return section
    return Section(section.title, [*section.parts, *table_5_1(forces, given.published[0])])


def _judged(given: Material) -> dict[str, list[Picture]]:
    """Figures of the diagnosis by what they show."""
    found, simulated = given.diagnoses, given.simulated
    if found[0].attrs.get("refused"):
        return {}
    return {
        "stick": pictures(diagnosis.frequencies(found, simulated)),
        "curve": pictures(diagnosis.curves(found, simulated)),
        "residuals": pictures(residual_maps.records(found, simulated)),
        "maps": pictures(residual_maps.curves(found, simulated)),
    }


def _that_shows_it(given: Material, judged: Mapping[str, list[Picture]]) -> list[Picture]:
    """The one figure of the verdict: that of the data in which the first cause is seen."""
    one, named = given.diagnoses[0], [c["mechanism"] for c in given.verdicts[0]["causes"]]
    channels = dict(zip(one["candidate"].values, one["channel"].values, strict=True))
    in_stick = channels.get(named[0]) == "stick" if named else bool(judged.get("stick"))
    if not in_stick:
        return judged.get("curve", [])
    if len(given.diagnoses) == 1:
        return judged["stick"]
    # the front page is about the main structure alone
    return pictures(diagnosis.frequencies(given.diagnoses[:1], given.simulated))


def _diagnosis(given: Material, judged: Mapping[str, list[Picture]]) -> Section:
    remarks = (
        table_5_2_remarks(given.verdicts, given.stages["stiffness"], given.stages["theory"])
        if given.of_the_thesis
        else []
    )
    drawn = [picture for several in judged.values() for picture in several]
    section = diagnosis_section(given.diagnoses, given.verdicts, drawn, given.simulated, remarks)
    return Section(section.title, [*section.parts, *extended_parts(given.joints, given.extended)])


def _of_structure(given: Material) -> list[Section]:
    checks = {check.attrs["structure"]: check for check in given.checks}
    side = pictures(structure.side_view(given.mesh), SIDE.format(given.facts["structures"][0]))
    side += [Picture(given.modes, MODES)] if given.modes else []
    return [structure_section(checks, given.accuracies, given.calibrations, side)]


def _of_stiffness(given: Material) -> list[Section]:
    found = given.stages["stiffness"]
    printed = given.published[1] if given.published else None
    maps = pictures(stiffness.maps(given.searches, printed, given.simulated), MAPS)
    posterior = pictures(joint.joint(given.joints, found, given.simulated))
    whole = stiffness_section(found, maps, given.stages.get("score"))
    parts = [*whole.parts, *joint_parts(given.joints, posterior), *_thesis_search(given)]
    return [Section(whole.title, parts)]


def _of_friction(given: Material) -> list[Section]:
    drawn = _slip(given)
    return [nonlinear_section(given.amplitudes, given.shortfalls, drawn, given.of_the_thesis)]


def _of_theory(given: Material) -> list[Section]:
    found = given.stages["theory"]
    profiles = TRACTIONS.format(found.attrs["profile_axial_force"] / 1e3)
    drawn = {
        "tractions": pictures(theory.tractions(found), profiles),
        "compared": pictures(
            theory.compared(found, given.stages["stiffness"], given.simulated),
            COMPARED.format("Table 5.2 times 33 (6.16), " if given.published else ""),
        ),
    }
    return [theory_section(found, drawn)]


def _comparison(given: Material) -> list[Section]:
    if not given.of_the_thesis:
        return []
    drawn = pictures(slider(given.stages["slider"]))
    return [
        ledger_section(given.stages["ledger"], given.errata, drawn),
        errata_section(given.errata),
    ]


def _thesis_search(given: Material) -> list:
    if not given.thesis_searches:
        return []
    found, table_5_2 = given.thesis_searches, given.published[1]
    return thesis_search_parts(
        found,
        pictures(
            thesis_search.solution_sets(found[0], table_5_2),
            SETS.format(found[0].attrs["structure"]),
        ),
    )


def _slip(given: Material) -> list[Picture]:
    one = next((one for one in given.amplitudes if one.attrs["law"]), None)
    if one is None:
        return []
    return [
        *pictures(nonlinear.curves(one, given.simulated)),
        *pictures(nonlinear.slip(one, given.simulated), SLIP),
    ]


# The chapters that need a structure.
_WITH_STRUCTURE = {
    "structure": _of_structure,
    "stiffness": _of_stiffness,
    "nonlinear": _of_friction,
    "theory": _of_theory,
    "comparison": _comparison,
}
