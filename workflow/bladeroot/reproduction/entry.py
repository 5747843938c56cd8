"""One line of the ledger: what is printed, how it is compared, and the verdict that follows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
import xarray as xr
from jaxtyping import Bool, Float
from numpy import ndarray

_ROUNDING = 1e-9  # so that a difference of just the tolerance is inside in spite of rounding

# Computed values in the order and the unit of the printed ones, by variant (which structure, which
# reading of the gauge); one variant is named "". NaN where this run has no value.
Computed = dict[str, Float[ndarray, " value"]]


@dataclass(frozen=True)
class Evidence:
    """Artifacts by name (stick, fe_forces, stiffness, theory), by structure, and tables.

    checks and reduced: by structure. maps: by structure and axial force in N. tables: by the
    number in their file's name, as printed. parameters: of the contact, SI, by name.
    """

    stages: Mapping[str, xr.Dataset]
    checks: Mapping[str, xr.Dataset]
    reduced: Mapping[str, xr.Dataset]
    maps: Mapping[str, Mapping[float, xr.Dataset]]
    tables: Mapping[str, pd.DataFrame]
    parameters: Mapping[str, float]


@dataclass(frozen=True)
class Entry:
    """An entry of resources/thesis/ledger.yaml; see the head of that file for the keys."""

    id: str
    chapter: str | int
    where: str
    what: str
    unit: str = ""
    covers: Sequence[str] = ()
    printed: float | int | list | Mapping | None = None
    says: str = ""
    computed: str = ""
    tolerance: Mapping[str, float | int] = field(default_factory=dict)
    range: Sequence[float | int | None] = ()
    errata: Sequence[str] = ()
    reason: str = ""
    ours: str = ""

    def __post_init__(self) -> None:
        """Refuse what cannot be compared, with the entry's name."""
        if self.computed and bool(self.tolerance) == bool(self.range):
            raise ValueError(f"{self.id}: a computed entry needs either tolerance or range")
        if self.tolerance and self.printed is None:
            raise ValueError(f"{self.id}: a tolerance needs printed values")
        if not self.computed and not self.reason:
            raise ValueError(f"{self.id}: without a computed quantity it must say what is missing")


@dataclass(frozen=True)
class Values:
    """The single numbers of an entry, with the labels that tell them apart."""

    labels: list[str]
    printed: Float[ndarray, " value"]
    computed: Float[ndarray, " value"]
    tolerance: Float[ndarray, " value"]
    within: Bool[ndarray, " value"]

    @property
    def difference(self) -> Float[ndarray, " value"]:
        """Computed less printed."""
        return self.computed - self.printed

    @property
    def known(self) -> Bool[ndarray, " value"]:
        """Where there is a computed value."""
        return np.isfinite(self.computed)


def printed_values(entry: Entry, tables: Mapping[str, pd.DataFrame]) -> tuple[list[str], ndarray]:
    """Labels and numbers as printed; one unlabelled NaN for a statement in words."""
    given = entry.printed
    if given is None:
        return [""], np.array([np.nan])
    if not isinstance(given, Mapping):
        values = np.atleast_1d(np.asarray(given, float))
        return [""] * values.size, values
    rows = tables[given["table"]]
    if "rows" in given:
        rows = rows.query(given["rows"])
    label = given["label"]
    return (
        [", ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in line)
         for line in rows[label].itertuples(index=False)],
        rows[given["column"]].to_numpy(float),
    )  # fmt: skip


def compare(
    entry: Entry, labels: list[str], printed: Float[ndarray, " n"], computed: Float[ndarray, " m"]
) -> Values:
    """Every number against the tolerance or the range; a statement may have several numbers.

    ValueError when printed and computed values do not match in number.
    """
    if entry.range:
        labels, printed = labels * computed.size, np.full(computed.size, np.nan)
        low, high = (
            side if end is None else float(end)
            for side, end in zip((-np.inf, np.inf), entry.range, strict=True)
        )
        tolerance = np.full(computed.size, np.nan)
        within = (computed >= low) & (computed <= high) & np.isfinite(computed)
        return Values(labels, printed, computed, tolerance, within)
    if printed.shape != computed.shape:
        raise ValueError(f"{entry.id}: {printed.size} values printed, {computed.size} computed")
    tolerance = np.maximum(
        entry.tolerance.get("absolute", 0.0),
        entry.tolerance.get("relative", 0.0) * np.abs(printed),
    )
    within = np.abs(computed - printed) <= tolerance + _ROUNDING * np.abs(printed)
    return Values(labels, printed, computed, tolerance, within)


def best(candidates: Mapping[str, Values]) -> str:
    """The variant with most values within; among equals the smallest of its largest differences."""

    def merit(name: str) -> tuple[int, float]:
        values = candidates[name]
        known = values.known
        if not known.any():
            return (-1, 0.0)
        worst = np.abs(values.difference)[known].max()
        return int(values.within.sum()), -float(np.nan_to_num(worst))

    return max(candidates, key=merit)


def verdict(entry: Entry, values: Values) -> str:
    """Reproduced, differs, erratum or, which alone rests on a text, not reproducible."""
    if not entry.computed:
        return "not reproducible"
    known = values.known
    if known.any() and values.within[known].all():
        return "reproduced"
    return "erratum" if entry.errata else "differs"
