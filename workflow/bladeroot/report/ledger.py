"""The section that goes through the thesis: as printed, as computed, difference, verdict."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import NONE, listed, significant
from bladeroot.report.page import Picture, Section, Table

_VERDICTS = ("reproduced", "differs", "erratum", "not reproducible")
_HEADER = ("what", "printed", "ours", "difference (allowed)", "verdict", "remark")
_VALUE_HEADER = ("where", "value", "printed", "ours", "difference", "allowed", "within")


def ledger_section(
    ledger: xr.Dataset, errata: Sequence[Mapping], slider: Sequence[Picture]
) -> Section:
    """Counts of the verdicts, then a table for each chapter with its numbers folded below it."""
    chapters = list(dict.fromkeys(ledger["chapter"].values))
    errors = {entry["id"]: entry["where"] for entry in errata}
    parts: list = [
        f"All {ledger.attrs['results']} tables and figures of the thesis that are results, and the "
        "numbers of its text, stand here with what this run gives; its other "
        f"{ledger.attrs['no_results']} are sketches, photographs, methods and inputs. "
        "“Reproduced” means that every number lies within the allowed difference, or that a "
        "statement holds; “erratum”, that the thesis contradicts itself there (next section has "
        "the arithmetic); “not reproducible”, that what it takes is not published. Where "
        "structures differ, the one that comes closest is shown and named. The structures were "
        "fitted to Tables 2.2, 4.1, 4.2 and 4.4 (dovetail-H), and with the joint to Table 5.2 "
        "(dovetail-HB): what agrees there shows that one geometry can do it, and is no prediction.",
        _counts(ledger, chapters),
    ]
    for chapter in chapters:
        rows = np.flatnonzero(ledger["chapter"].values == chapter).tolist()
        parts.append(Table(_title(chapter), _HEADER, [_row(ledger, i, errors) for i in rows]))
        values = [line for i in rows for line in _values(ledger, i)]
        if values:
            text = f"{_title(chapter)}, number by number ({len(values)} values)"
            parts.append(Table(text, _VALUE_HEADER, values, folded=True))
        if chapter == "3":
            parts += slider
    return Section("The thesis, number by number", parts)


def _title(chapter: str) -> str:
    return f"Chapter {chapter}" if chapter.isdigit() else f"Appendix {chapter}"


def _counts(ledger: xr.Dataset, chapters: list[str]) -> Table:
    rows = []
    for chapter in [*chapters, ""]:
        here = ledger["verdict"].values
        if chapter:
            here = here[ledger["chapter"].values == chapter]
        counts = [int(np.sum(here == verdict)) for verdict in _VERDICTS]
        rows.append((_title(chapter) if chapter else "all", *map(str, counts), str(len(here))))
    return Table("Rows by verdict", ("", *_VERDICTS, "rows"), rows)


def _of_row(ledger: xr.Dataset, index: int) -> xr.Dataset:
    return ledger.isel(value=np.flatnonzero(ledger["value_row"].values == index), row=index)


def _row(ledger: xr.Dataset, index: int, errata: Mapping[str, str]) -> tuple[str, ...]:
    one = _of_row(ledger, index)
    text = {name: str(one[name].values) for name in ledger.data_vars if one[name].ndim == 0}
    unit = text["unit"]
    printed, computed = one["value_printed"].values, one["value_computed"].values
    difference = np.abs(one["value_difference"].values)
    worst = float(difference[np.isfinite(difference)].max(initial=-np.inf))
    allowed = f"({text['allowed']})".replace(" ", "\u00a0") if text["allowed"] else NONE
    return (
        f"{text['where']}: {text['what']}",
        text["says"] or _spread(printed, unit, 6),
        _spread(computed, unit, 3 if text["says"] else 5),
        f"{significant(worst, 2, unit)} {allowed}" if np.isfinite(worst) else allowed,
        _verdict(text["verdict"], one),
        _remark(text, errata),
    )


def _verdict(verdict: str, one: xr.Dataset) -> str:
    """With the count of what holds, where there are several numbers and not all do."""
    known = int(np.isfinite(one["value_computed"].values).sum())
    within = int(one["value_within"].sum())
    return f"{verdict} ({within} of {known} agree)" if known > 1 and within < known else verdict


def _spread(values: np.ndarray, unit: str, digits: int) -> str:
    """Up to three numbers in a row, or the range and count of more."""
    known = [float(value) for value in values if np.isfinite(value)]
    if not known:
        return NONE
    if len(known) <= 3:
        text = ", ".join(_plain(value, digits) for value in known)
        return f"{text}\u00a0{unit}".strip()
    ends = dict.fromkeys(_plain(end, digits) for end in (min(known), max(known)))
    return f"{' to '.join(ends)}\u00a0{unit}".strip() + f" ({len(known)} values)"


def _plain(value: float, digits: int) -> str:
    """A number without zeros that say nothing."""
    if not np.isfinite(value):
        return NONE
    text = f"{value:,.{digits}g}" if abs(value) < 1e6 else f"{value:.{digits}g}"
    return text.replace(",", "\u202f")


def _remark(text: Mapping[str, str], errata: Mapping[str, str]) -> str:
    """Variant, reason where the verdict needs one, errata, and where the report shows it."""
    parts = []
    if text["variant"]:
        parts.append(text["variant"] + (f" ({text['others']})" if text["others"] else ""))
    if text["reason"]:
        parts.append(text["reason"])
    elif text["verdict"] == "differs":
        parts.append("no reason is known yet")
    if text["errata"]:
        places = [errata[name] for name in text["errata"].split(", ")]
        parts.append(f"erratum: {listed(list(dict.fromkeys(places)))}")
    if text["ours"]:
        parts.append(f"see {text['ours']}")
    return "; ".join(parts) or NONE


def _values(ledger: xr.Dataset, index: int) -> list[tuple[str, ...]]:
    """Single numbers of a row that has several."""
    one = _of_row(ledger, index)
    if one.sizes["value"] < 2:
        return []
    names = ("label", "printed", "computed", "difference", "tolerance", "within")
    columns = [one[f"value_{name}"].values.tolist() for name in names]
    lines = []
    for i, (label, printed, computed, difference, allowed, holds) in enumerate(
        zip(*columns, strict=True), 1
    ):
        within = ("no", "yes")[int(holds)] if np.isfinite(computed) else NONE
        lines.append(
            (str(one["where"].values), str(label) or str(i),
             _plain(printed, 6), _plain(computed, 5), significant(difference, 2),
             significant(allowed, 2), within)
        )  # fmt: skip
    return lines


def errata_section(errata: Sequence[Mapping]) -> Section:
    """Each erratum with the arithmetic that shows it."""
    rows = [
        (entry["where"], entry["printed"], entry["probably"], entry["arithmetic"].strip())
        for entry in errata
    ]
    return Section(
        "Errata of the source",
        [
            "The thesis's tables are used as printed. Where they or an equation contradict "
            "themselves, the arithmetic says so here; nothing is corrected silently.",
            Table("Errata", ("where", "printed", "probably", "arithmetic"), rows),
        ],
    )
