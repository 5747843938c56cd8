"""The report as a whole: the first page and its chapters, each a page of its own."""

import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection

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

FRONT, INDEX = "report.html", "index.html"
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

    facts: campaign, description (campaign.yaml), structures, simulated, excluded, entry. stages:
    artifacts by name (stick; with records, integrity and curves; for simulated ones, score; with a
    structure, fe_forces, stiffness, theory; for the thesis's tables, ledger and slider). By
    structure, the main one first: checks, accuracies, calibrations, joints, diagnoses with their
    verdicts, extended (joints with the causes of a model file), amplitudes, shortfalls,
    thesis_searches, searches (and by force). shown, spectra: raw records as from
    `bladeroot.figures.records.worth_showing`. modes: SVG text. published: Tables 5.1 and 5.2 as
    shipped, for a campaign that states them. made: as `bladeroot.report.front.provenance_section`.
    """

    facts: Mapping
    stages: Mapping[str, xr.Dataset]
    diagnoses: Sequence[xr.Dataset]
    verdicts: Sequence[Mapping]
    made: Mapping
    decays: Sequence[xr.Dataset] = ()
    shown: Sequence[xr.Dataset] = ()
    spectra: Sequence[xr.Dataset] = ()
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
    judged, of_stick, of_structures, of_records = _side_by_side(
        [_judged, _over_load, _of_structures, _of_records], given, processes
    )
    every = of_records.get("means", [])
    chapters = {
        "measurement": _measurement(given, of_records),
        "quality": [integrity_section(given.stages["integrity"])]
        if "integrity" in given.stages
        else [],
        "stick": [_stick(given, of_stick)],
        **of_structures,
        "diagnosis": [_diagnosis(given, judged)],
    }
    chapters = {name: chapters[name] for name in _TITLES if chapters.get(name)}
    pages = {
        f"report/{name}.html": _page(given, name, sections, chapters)
        for name, sections in chapters.items()
    }
    # the first page stands beside the chapters' folder, and once more inside it for an archive
    for place, where in ((f"report/{INDEX}", ""), (FRONT, "report/")):
        front = front_sections(
            given.facts,
            given.stages,
            given.joints,
            given.amplitudes,
            given.diagnoses,
            given.verdicts,
            every or of_stick,
            _that_shows_it(given, judged),
            where,
        )
        front.append(provenance_section(given.made))
        pages[place] = _page(given, "", front, chapters, where)
    return pages


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
    """What each task makes of what is given; with two processes the second half in a child."""
    if processes < 2:
        return [task(given) for task in tasks]
    here = len(tasks) // 2
    fork = multiprocessing.get_context("fork")
    receiver, sender = fork.Pipe(duplex=False)
    child = fork.Process(target=_send, args=(tasks[here:], given, receiver, sender), daemon=True)
    child.start()
    sender.close()
    made = [task(given) for task in tasks[:here]]
    try:
        others = receiver.recv()
    except EOFError:
        raise RuntimeError("the second process that draws was ended") from None
    if isinstance(others, Exception):
        raise others
    return made + others


def _send(tasks: Sequence[Callable], given: object, receiver: Connection, sender: Connection):
    receiver.close()  # the parent's alone: where it has ended, nothing can be sent
    try:
        sender.send([task(given) for task in tasks])
    except Exception as error:
        sender.send(error)


def _of_records(given: Material) -> dict[str, list[Picture]]:
    """Figures of the records by what they show, in reading order."""
    if "curves" not in given.stages:
        return {}
    return {
        "records": pictures(curves.records(given.decays)),
        "means": pictures(curves.means(given.stages["curves"])),
        "cuts": pictures(records.cuts(given.shown), CUTS),
        "spectra": pictures(spectra.spectra(given.spectra), SPECTRA),
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
    if channels.get(named[0]) == "stick" if named else judged.get("stick"):
        # the front page is about the main structure alone
        return pictures(diagnosis.frequencies(given.diagnoses[:1], given.simulated))
    return judged.get("curve", [])


def _diagnosis(given: Material, judged: Mapping[str, list[Picture]]) -> Section:
    remarks = (
        table_5_2_remarks(given.verdicts, given.stages["stiffness"], given.stages["theory"])
        if given.of_the_thesis
        else []
    )
    drawn = [picture for several in judged.values() for picture in several]
    section = diagnosis_section(given.diagnoses, given.verdicts, drawn, given.simulated, remarks)
    return Section(section.title, [*section.parts, *extended_parts(given.joints, given.extended)])


def _of_structures(given: Material) -> dict[str, list[Section]]:
    """The chapters that need a structure."""
    if not given.facts["structures"]:
        return {}
    stages, simulated = given.stages, given.simulated
    main = given.facts["structures"][0]
    side = pictures(structure.side_view(given.mesh), SIDE.format(main))
    side += [Picture(given.modes, MODES)] if given.modes else []
    printed = given.published[1] if given.published else None
    maps = pictures(stiffness.maps(given.searches, printed, simulated), MAPS)
    posterior = pictures(joint.joint(given.joints, stages["stiffness"], simulated))
    whole = stiffness_section(stages["stiffness"], maps, stages.get("score"))
    parts = [*whole.parts, *joint_parts(given.joints, posterior), *_thesis_search(given)]
    profiles = TRACTIONS.format(stages["theory"].attrs["profile_axial_force"] / 1e3)
    drawn = {
        "tractions": pictures(theory.tractions(stages["theory"]), profiles),
        "compared": pictures(
            theory.compared(stages["theory"], stages["stiffness"], simulated),
            COMPARED.format("Table 5.2 times 33 (6.16), " if given.published else ""),
        ),
    }
    checks = {check.attrs["structure"]: check for check in given.checks}
    return {
        "structure": [structure_section(checks, given.accuracies, given.calibrations, side)],
        "stiffness": [Section(whole.title, parts)],
        "nonlinear": [
            nonlinear_section(given.amplitudes, given.shortfalls, _slip(given), given.of_the_thesis)
        ],
        "theory": [theory_section(stages["theory"], drawn)],
        "comparison": [
            ledger_section(stages["ledger"], given.errata, pictures(slider(stages["slider"]))),
            errata_section(given.errata),
        ]
        if given.of_the_thesis
        else [],
    }


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
