"""The part of the report on what the simulation gets wrong: verdict, evidence, gain, what next."""

from collections.abc import Mapping, Sequence

import xarray as xr

from bladeroot.loads import AXIAL_FORCE, shown
from bladeroot.plain_words import plainly
from bladeroot.report.diagnosis_tables import (
    candidates_table,
    gain_table,
    sizes_table,
    stiffness_tables,
    structures_table,
)
from bladeroot.report.next_measurement import next_parts
from bladeroot.report.page import Box, Picture, Section, Table
from bladeroot.report.verdict import cautions, disagreement, verdict_box, with_open

TITLE = "What the simulation gets wrong, and why"
_CAPTIONS = {
    "frequencies": "Stick frequency over the axial force, measured and simulated, before and after "
    "the cause is part of the simulation; below, what is left. Before: contact stiffness as smooth "
    "contact has it.",
    "curves": "Frequency and loss factor over amplitude at some of the forces, as change from the "
    "stuck joint: measured (dots) and simulated.",
    "residuals": "What the simulation leaves of each record's stick frequency, in standard "
    "deviations of what clamping, gauge and noise scatter (after the cause, both columns), over "
    "what the campaign varied. Grey: two standard deviations.",
    "residual_maps": "The same of the curves, over amplitude and force: blue where the measurement "
    "lies below the simulation, red above.",
    "law": "Contact stiffness over the force as the simulation has it before and after, each with "
    "one standard deviation. A band before the cause is that of a simulation that does not fit.",
}


def diagnosis_section(
    found: Sequence[xr.Dataset],
    verdicts: Sequence[Mapping],
    figures: Mapping[str, str],
    simulated: bool,
    remarks: Sequence[str] = (),
) -> Section:
    """The section that an engineer reads first.

    found, verdicts: of each structure, the main one first. figures: SVG text by name. remarks: what
    the verdict means for this campaign in particular.
    """
    verdicts = [
        {**with_open(said), "structure": said["structure"] or one.attrs["structure"]}
        for one, said in zip(found, verdicts, strict=True)
    ]
    if found[0].attrs.get("refused"):
        head = f"{verdicts[0]['structure']}: not this specimen, nothing is inferred with it"
        return Section(TITLE, [Box(head, [f"{said['reason']}." for said in verdicts])])
    whole = Section(TITLE, _parts(found, verdicts, figures, simulated, remarks))
    kind, load = found[0].attrs.get("kind"), shown(found[0].attrs)[2]
    if kind == "none" or (kind == "table" and load != AXIAL_FORCE):
        return _in_own_words(whole, load, kind == "table")
    return whole


def _parts(
    found: Sequence[xr.Dataset],
    verdicts: Sequence[Mapping],
    figures: Mapping[str, str],
    simulated: bool,
    remarks: Sequence[str],
) -> list:
    box = verdict_box(found[0], verdicts[0], simulated)
    parts: list = [Box(box.head, [*box.lines, *disagreement(verdicts)])]
    parts += cautions(found, verdicts)
    if len(found) > 1:
        parts.append(structures_table(found, verdicts))
    parts += [
        *remarks,
        Picture(
            figures["diagnosis_ranking"],
            "Possible causes by their evidence: how much more probable each makes the measurement "
            "than the simulation as it is (natural logarithm; 3 is 20 to 1). Named: dark; as good "
            "as it: light; not judged: the campaign cannot speak of it, or says itself that it is "
            "not so. Hatched: a curve of any shape, which names nothing; what it explains and "
            "no cause does would be unexplained.",
        ),
        candidates_table(found),
        *_not_tried(found[0]),
        *([sizes_table(found, verdicts)] if any(said["causes"] for said in verdicts) else []),
    ]
    law = any("stick_residual" in one for one in found)
    over_amplitude = any("curve_mode" in one for one in found)
    loaded = bool(shown(found[0].attrs)[2])
    drawn = {"frequencies": law and loaded, "curves": over_amplitude, "residuals": law,
             "residual_maps": over_amplitude}  # fmt: skip
    parts += [
        Picture(figures[f"diagnosis_{name}"], _CAPTIONS[name]) for name in drawn if drawn[name]
    ]
    gain = gain_table(verdicts)
    parts += [gain] if gain.rows else []
    stiffness = any("law_k" in one for one in found)
    parts += [Picture(figures["diagnosis_law"], _CAPTIONS["law"])] if stiffness else []
    return [*parts, *stiffness_tables(found), *next_parts(found)]


def _in_own_words(section: Section, load: str, simulated: bool) -> Section:
    """The section as of a specimen with another load, or of which nothing is simulated."""
    parts: list = []
    for part in section.parts:
        if isinstance(part, str):
            parts.append(plainly(part, load, simulated))
        elif isinstance(part, Box):
            parts.append(
                Box(
                    plainly(part.head, load, simulated),
                    [plainly(one, load, simulated) for one in part.lines],
                )
            )
        elif isinstance(part, Picture):
            parts.append(Picture(part.svg, plainly(part.caption, load, simulated)))
        else:
            header = ["against" if name == "structure" else name for name in part.header]
            rows = [[plainly(cell, load, simulated) for cell in row] for row in part.rows]
            parts.append(Table(plainly(part.caption, load, simulated), header, rows, part.folded))
    title = section.title if simulated else "What linear modes do not explain, and why"
    return Section(title, parts)


def _not_tried(found: xr.Dataset) -> list[str]:
    """The user's own mechanisms that the ranking lacks, and why."""
    lines = found.attrs.get("mechanisms_not_tried", "")
    return [f"Not in the ranking, own mechanisms that failed: {lines}."] if lines else []
