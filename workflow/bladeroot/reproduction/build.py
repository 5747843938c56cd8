"""The whole ledger as a Dataset: one row an entry, one value a printed or computed number."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.reproduction.entry import (
    Entry,
    Evidence,
    Values,
    best,
    compare,
    printed_values,
    verdict,
)
from bladeroot.reproduction.quantities import QUANTITIES
from bladeroot.variables import dataset

_NUMBERS = ("printed", "computed", "difference", "tolerance", "within")


def missing_rows(entries: Sequence[Mapping], contents: Mapping[str, Mapping]) -> list[str]:
    """Tables and figures of the contents that are results and have no row."""
    covered = {name for entry in entries for name in entry.get("covers", ())}
    listed = {name: part["kind"] for group in contents.values() for name, part in group.items()}
    unknown = sorted(covered - set(listed))
    if unknown:
        raise ValueError(f"not in the list of contents: {', '.join(unknown)}")
    return [name for name, kind in listed.items() if kind == "result" and name not in covered]


def ledger(
    entries: Sequence[Mapping],
    errata: Sequence[Mapping],
    contents: Mapping[str, Mapping],
    evidence: Evidence,
) -> xr.Dataset:
    """Compare every entry with the evidence.

    entries, errata, contents: the files of these names in resources/thesis/. Dims: row (an entry)
    and value (a number, `value_row` names its row). Attributes count the tables and figures that
    are results and those that are not. ValueError names a result without a row, or an entry with
    an unknown quantity or erratum.
    """
    missing = missing_rows(entries, contents)
    if missing:
        raise ValueError(f"the ledger has no row for {', '.join(missing)}")
    known = {erratum["id"] for erratum in errata}
    rows, numbers = [], []
    for given in entries:
        entry = Entry(**given)
        unknown = set(entry.errata) - known
        if unknown:
            raise ValueError(f"{entry.id}: no erratum {', '.join(sorted(unknown))}")
        row, values = _row(entry, evidence)
        numbers.append(values)
        rows.append(row)
    kinds = [part["kind"] for group in contents.values() for part in group.values()]
    counts = {"results": kinds.count("result"), "no_results": len(kinds) - kinds.count("result")}
    return _dataset([entry["id"] for entry in entries], rows, numbers).assign_attrs(counts)


def _row(entry: Entry, evidence: Evidence) -> tuple[dict, Values]:
    labels, printed = printed_values(entry, evidence.tables)
    variant, others = "", ""
    if entry.computed:
        if entry.computed not in QUANTITIES:
            raise ValueError(f"{entry.id}: no quantity {entry.computed!r}")
        computed = QUANTITIES[entry.computed](evidence)
        candidates = {
            name: compare(entry, labels, printed, values) for name, values in computed.items()
        }
        variant = best(candidates)
        values = candidates.pop(variant)
        others = "; ".join(f"{name}: {_share(other)}" for name, other in candidates.items())
    else:
        nothing = np.full(printed.size, np.nan)
        values = Values(labels, printed, nothing, nothing, np.zeros(printed.size, bool))
    texts = {
        "chapter": str(entry.chapter),
        "covers": ", ".join(entry.covers),
        "allowed": _allowed(entry),
        "variant": variant,
        "others": others,
        "verdict": verdict(entry, values),
        "errata": ", ".join(entry.errata),
    }
    plain = ("where", "what", "unit", "says", "reason", "ours")
    return texts | {name: getattr(entry, name).strip() for name in plain}, values


def _share(values: Values) -> str:
    if not values.known.any():
        return "no value"
    return f"{int(values.within.sum())} of {int(values.known.sum())} within"


def _allowed(entry: Entry) -> str:
    if entry.range:
        low, high = entry.range
        if low is None or high is None:
            return f"at most {high:g}" if low is None else f"at least {low:g}"
        return f"{low:g} to {high:g}"
    parts = []
    if "relative" in entry.tolerance:
        parts.append(f"{100 * entry.tolerance['relative']:g} %")
    if "absolute" in entry.tolerance:
        parts.append(f"{entry.tolerance['absolute']:g}" + (f" {entry.unit}" if entry.unit else ""))
    return " or ".join(parts)


def _dataset(ids: list[str], rows: list[dict], numbers: list[Values]) -> xr.Dataset:
    made = {name: np.array([row[name] for row in rows], str) for name in rows[0]}
    made["row"] = np.array(ids, str)
    made["value_row"] = np.concatenate([np.full(v.printed.size, i) for i, v in enumerate(numbers)])
    made["value_label"] = np.array([label for v in numbers for label in v.labels], str)
    for name in _NUMBERS:
        values = np.concatenate([getattr(v, name) for v in numbers])
        made[f"value_{name}"] = values.astype(np.int8) if name == "within" else values
    return dataset("reproduction/ledger", made)
