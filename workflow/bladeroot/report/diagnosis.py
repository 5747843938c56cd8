"""The chapter on what the simulation gets wrong: verdict, evidence, gain, what next."""

from collections.abc import Mapping, Sequence

import xarray as xr

from bladeroot.report.diagnosis_tables import (
    candidates_table,
    gain_table,
    sizes_table,
    stiffness_tables,
    structures_table,
)
from bladeroot.report.next_measurement import next_parts
from bladeroot.report.page import Box, Picture, Section
from bladeroot.report.verdict import (
    REFUSED,
    against,
    cautions,
    disagreement,
    sentences_of,
    shortfall_table,
    with_open,
)
from bladeroot.report.words import judge_of, words_of


def diagnosis_section(
    found: Sequence[xr.Dataset],
    verdicts: Sequence[Mapping],
    drawn: Sequence[Picture],
    simulated: bool,
    remarks: Sequence[str] = (),
) -> Section:
    """Verdict, what stands against it, evidence, sizes, gain and the next measurement.

    found, verdicts: of each structure, the main one first. remarks: what the verdict means for this
    campaign in particular.
    """
    alone = judge_of(found[0]).plural
    title = (
        f"What {'linear modes do not explain' if alone else 'the simulation gets wrong'}, and why"
    )
    if found[0].attrs.get("refused"):
        head = f"{against(found[0], verdicts[0])}: {REFUSED}, nothing is inferred with it"
        return Section(title, [Box(head, [f"{said['reason']}." for said in verdicts])])
    verdicts = [
        {**with_open(said), "structure": against(one, said)}
        for one, said in zip(found, verdicts, strict=True)
    ]
    box = sentences_of(found[0], verdicts[0], simulated).box
    parts: list = [Box(box.head, [*box.lines, *disagreement(verdicts)])]
    parts += [shortfall_table(verdicts[0])] if verdicts[0]["shortfall"] else []
    parts += cautions(found, verdicts)
    parts += [structures_table(verdicts)] if len(found) > 1 else []
    parts += [*remarks, *drawn, candidates_table(found), *_not_tried(found[0])]
    parts += [sizes_table(verdicts)] if any(said["causes"] for said in verdicts) else []
    gain = gain_table(verdicts, words_of(found[0]))
    parts += [gain] if gain.rows else []
    return Section(title, [*parts, *stiffness_tables(found), *next_parts(found)])


def _not_tried(found: xr.Dataset) -> list[str]:
    """The user's own mechanisms that the ranking lacks, and why."""
    lines = found.attrs.get("mechanisms_not_tried", "")
    return [f"Not in the ranking, own mechanisms that failed: {lines}."] if lines else []
