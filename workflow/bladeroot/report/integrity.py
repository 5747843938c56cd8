"""The section on the records themselves: what was found in them, and a second opinion on each."""

import numpy as np
import xarray as xr

from bladeroot.report.bad_records import unlike_repeats
from bladeroot.report.numbers import listed, significant
from bladeroot.report.page import Box, Section, Table
from bladeroot.report.words import words_of


def integrity_section(judged: xr.Dataset) -> Section:
    """Findings by kind and by record, and how peak fitting agrees with FREEVIB."""
    count = judged.sizes["record"]
    told = np.unique(judged["finding_record"].values).size
    parts: list = [
        f"Every record is judged before any physics. {told} of {count} records have a finding. "
        "A finding warns, or takes a steady disturbance off the samples, or takes the weight of "
        "the samples concerned, or drops the record; docs/findings.md has each statistic, its "
        "threshold and its rate of false alarms."
    ]
    unlike = unlike_repeats(judged)
    if unlike:
        lines = [f"{name} {text}." for name, text in unlike]
        parts.append(Box("Not like the other records", lines))
    if judged.sizes["finding"]:
        parts += [_kinds(judged), _findings(judged)]
    return Section("Integrity of the records", [*parts, *_second_opinion(judged)])


def _kinds(judged: xr.Dataset) -> Table:
    rows = []
    for kind in np.unique(judged["finding_id"].values):
        here = judged["finding_id"].values == kind
        what = judged["finding_consequence"].values[here]
        counted = [f"{word} {int((what == word).sum())}" for word in dict.fromkeys(what)]
        rows.append((str(kind), str(int(here.sum())), listed(counted)))
    return Table("Findings by kind", ("finding", "records", "consequence"), rows)


def _findings(judged: xr.Dataset) -> Table:
    records: dict[tuple[str, ...], list[str]] = {}
    for k in range(judged.sizes["finding"]):
        said = (
            str(judged["finding_id"].values[k]),
            str(judged["finding_consequence"].values[k]),
            _span(judged["finding_from_s"].values[k], judged["finding_to_s"].values[k]),
            str(judged["finding_text"].values[k]),
        )
        records.setdefault(said, []).append(str(judged["finding_record"].values[k]))
    rows = [
        (names[0] + (f" and {len(names) - 1} more" if len(names) > 1 else ""), *said)
        for said, names in records.items()
    ]
    header = ("record", "finding", "consequence", "time in the decay / s", "what was found")
    return Table("Findings; what is said alike of several records stands once", header, rows)


def _span(first: float, last: float) -> str:
    return f"{first:.3f} to {last:.3f}" if np.isfinite([first, last]).all() else "whole"


def _second_opinion(judged: xr.Dataset) -> list:
    agrees = judged["pff_agrees"].values
    if not (agrees >= 0).any():
        return []
    frequency = judged["pff_frequency_difference"].values
    loss = judged["pff_loss_factor_difference"].values
    parts: list = [
        "Peak finding and fitting, which shares nothing with the estimator, reads each record "
        f"again: of {int((agrees >= 0).sum())} records it agrees on {int((agrees == 1).sum())}. "
        "Its median difference from FREEVIB over a record is "
        f"{significant(1e6 * float(np.nanmedian(np.abs(frequency))), 2)} ppm in frequency "
        f"(largest {significant(1e6 * float(np.nanmax(np.abs(frequency))), 2)}) and "
        f"{significant(100 * float(np.nanmedian(np.abs(loss))), 2)} % in damping "
        f"(largest {significant(100 * float(np.nanmax(np.abs(loss))), 2)})."
    ]
    apart = np.flatnonzero(agrees == 0)
    if apart.size:
        rows = [
            (
                str(judged["record"].values[k]),
                str(judged["mode"].values[k]),
                words_of(judged).value(float(judged["force"].values[k])),
                str(judged["pff_finding"].values[k]),
            )
            for k in apart
        ]
        header = ("record", "mode", words_of(judged).header, "difference")
        parts.append(Table("Records on which the two methods differ", header, rows))
    return parts
