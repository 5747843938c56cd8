"""The report as a whole: which sections, in which order."""

from collections.abc import Mapping, Sequence

import pandas as pd
import xarray as xr

from bladeroot.report.diagnosis import diagnosis_section
from bladeroot.report.errata import errata_section
from bladeroot.report.extended import extended_parts
from bladeroot.report.groups import groups_section
from bladeroot.report.integrity import integrity_section
from bladeroot.report.joint import joint_parts
from bladeroot.report.ledger import ledger_section
from bladeroot.report.measurement import measurement_section, stick_section, table_5_1
from bladeroot.report.nonlinear import nonlinear_section
from bladeroot.report.page import Section, render
from bladeroot.report.stiffness import stiffness_section
from bladeroot.report.structure import structure_section
from bladeroot.report.summary import alone_section, summary_section, undecided_section
from bladeroot.report.table_5_2 import table_5_2_remarks
from bladeroot.report.theory import theory_section
from bladeroot.report.thesis_search import thesis_search_parts


def report(
    facts: Mapping,
    stages: Mapping[str, xr.Dataset],
    checks: Sequence[xr.Dataset],
    accuracies: Sequence[xr.Dataset],
    calibrations: Sequence[xr.Dataset],
    joints: Sequence[xr.Dataset],
    diagnoses: Sequence[xr.Dataset],
    verdicts: Sequence[Mapping],
    extended: Sequence[xr.Dataset],
    amplitudes: Sequence[xr.Dataset],
    shortfalls: Sequence[xr.Dataset],
    thesis_searches: Sequence[xr.Dataset],
    figures: Mapping[str, str],
    published_5_1: pd.DataFrame,
    errata: Sequence[dict],
    version: str,
) -> str:
    """A campaign's report as one HTML page.

    facts: campaign, description (campaign.yaml), structures, simulated, excluded, entry. stages:
    stick; with records, integrity and curves; for simulated ones, score; with a structure,
    fe_forces, stiffness, theory; for the thesis's tables, ledger. checks, accuracies, joints,
    diagnoses, verdicts, shortfalls: of each structure; extended: joints with the causes of a model
    file; calibrations: of those that have one; amplitudes: of each, with records; thesis_searches:
    of each structure of a campaign of the thesis. figures: SVG text by name. published_5_1 and
    errata: of the thesis, as shipped.
    Without a structure the page ends with the measurement.
    """
    score = stages.get("score")
    sticks = stick_section(stages["stick"], figures["stick"], score, stages.get("fe_forces"))
    of_the_thesis = facts["description"].get("published") == "thesis"
    if of_the_thesis:
        comparison = table_5_1(stages["fe_forces"], published_5_1)
        sticks = Section(sticks.title, [*sticks.parts, *comparison])
    measured = [
        measurement_section(facts, stages["stick"], figures),
        *([integrity_section(stages["integrity"])] if "integrity" in stages else []),
        sticks,
    ]
    differences = groups_section(stages["curves"]) if "curves" in stages else None
    measured[1:1] = [differences] if differences else []
    if not facts["structures"]:
        judged = diagnosis_section(diagnoses, verdicts, figures, facts["simulated"])
        sections = [alone_section(stages["stick"], verdicts[0]), judged, *measured]
        return _page(facts, "stick frequencies", sections, version)
    stiffness = stiffness_section(stages["stiffness"], figures["maps"], score)
    whole = joint_parts(joints, figures["joint"])
    if thesis_searches:
        whole += thesis_search_parts(
            thesis_searches, figures["solution_sets"], figures["thesis_search"]
        )
    remarks = (
        table_5_2_remarks(verdicts, stages["stiffness"], stages["theory"]) if of_the_thesis else []
    )
    what_is_wrong = diagnosis_section(diagnoses, verdicts, figures, facts["simulated"], remarks)
    held = {check.attrs["structure"]: check for check in checks}
    sections = [
        summary_section(
            stages["stick"],
            stages["stiffness"],
            stages["theory"],
            joints,
            amplitudes,
            of_the_thesis,
        ),
        Section(what_is_wrong.title, [*what_is_wrong.parts, *extended_parts(joints, extended)]),
        *measured,
        structure_section(held, accuracies, calibrations, figures),
        Section(stiffness.title, [*stiffness.parts, *whole]),
        nonlinear_section(amplitudes, shortfalls, figures, of_the_thesis),
        theory_section(stages["theory"], stages["stiffness"], figures),
        undecided_section(facts, stages["stick"], stages["stiffness"]),
    ]
    if of_the_thesis:
        sections += [
            ledger_section(stages["ledger"], errata, figures["slider"]),
            errata_section(errata),
        ]
    return _page(facts, "contact stiffness", sections, version)


def _page(facts: Mapping, aim: str, sections: Sequence[Section], version: str) -> str:
    return render(
        facts["description"]["title"],
        f"Campaign {facts['campaign']}: from ring-downs to {aim}",
        facts["simulated"],
        sections,
        f"bladeroot {version}",
    )
