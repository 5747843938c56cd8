"""Cells of a sheet, checked one by one: a fault or a suspicion is a line with file and row."""

import math
from dataclasses import dataclass
from pathlib import Path

from bladeroot.io.load import COLUMNS, Load, factor_of
from bladeroot.io.names import short

# A small force on a large gauge is a slip of the unit: kN given as N.
SMALL_FORCE = 100.0  # N, below which a force is small
LARGE_GAUGE = 10_000.0  # N, of full scale, above which a gauge is large
_YES, _NO = ("1", "yes", "true"), ("", "0", "no", "false")


@dataclass(frozen=True)
class Cells:
    """Checks of one sheet; every check adds its line to `faults` and returns a value or None.

    Suspicions go to `warnings`.
    """

    folder: Path
    path: Path
    description: dict
    load: Load | None
    faults: list[str]
    warnings: list[str]

    def fault(self, text: str, row: int) -> None:
        """Note a fault of a row."""
        self.faults.append(f"{text} ({self.path}, row {row})")

    def warn(self, text: str, row: int) -> None:
        """Note a suspicion."""
        self.warnings.append(f"{text} ({self.path}, row {row})")

    def required(self, rows: list[tuple[int, dict]], columns: tuple[str, ...]) -> bool:
        """Whether the columns are there (told once, not once a row)."""
        present = rows[0][1] if rows else dict.fromkeys(columns)
        missing = [name for name in columns if name not in present]
        if missing:
            self.fault(f"missing column {', '.join(map(repr, missing))}", 1)
        return not missing

    def number(self, row: int, values: dict, name: str, *, positive: bool = False) -> float | None:
        """A finite number."""
        text = values.get(name, "")
        try:
            value = float(text) if "_" not in text else math.nan
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            self.fault(f"{name} must be a finite number, got {short(text)!r}", row)
            return None
        if positive and value <= 0:
            self.fault(f"{name} must be positive, got {text}", row)
            return None
        return value

    def optional_number(
        self, row: int, values: dict, name: str, *, positive: bool = False
    ) -> float | None:
        """A finite number where the cell is not empty."""
        given = values.get(name, "") != ""
        return self.number(row, values, name, positive=positive) if given else None

    def once(self, row: int, place: object, first: dict, what: str) -> None:
        """Whether a place stands in no row before; first: the row of each place, added to."""
        if place in first:  # in this row, too: channels whose names differ by signs alone
            self.fault(f"{what} stands in row {first[place]} already", row)
        first.setdefault(place, row)

    def choice(self, row: int, values: dict, name: str, choices: tuple[str, ...], default: str):
        """One of some words."""
        value = values.get(name) or default
        if value and value not in choices:
            self.fault(f"{name} must be {' or '.join(choices)}, got {value!r}", row)
        return value

    def yes(self, row: int, values: dict, name: str) -> bool:
        """Whether a cell says yes."""
        text = values.get(name, "").lower()
        if text not in (*_YES, *_NO):
            self.fault(f"{name} must be yes or no, got {text!r}", row)
        return text in _YES

    def mode(self, row: int, values: dict) -> str | None:
        """The one mode of a row."""
        found = self.modes(row, values)
        if len(found) > 1:
            self.fault(f"expected one mode, got {values['mode']!r}", row)
        return found[0] if len(found) == 1 else None

    def modes(self, row: int, values: dict) -> list[str]:
        """The modes of a row: one, several split by blanks or commas, or `all`."""
        text = values.get("mode", "")
        known = self.description["modes"]
        if text in known:
            return [text]
        if text == "all":
            return list(known)
        named = text.replace(",", " ").split()
        unknown = [name for name in named if name not in known]
        if not named or len(named) == 1 or (unknown and len(unknown) == len(named)):
            self.fault(f"mode must be one of {', '.join(known)} (campaign.yaml), got {text!r}", row)
            return []
        for name in dict.fromkeys(unknown):
            self.fault(
                f"mode must be of {', '.join(known)} (campaign.yaml), got {name!r} in {text!r}", row
            )
        twice = sorted({name for name in named if named.count(name) > 1})
        if twice:
            self.fault(f"mode names {', '.join(twice)} twice, in {text!r}", row)
        return [] if unknown or twice else named

    def load_value(self, row: int, values: dict, read: bool = True) -> float | None:
        """The load in its unit; 0 where the campaign has none. read: by the gauge, in whose range
        it lies.
        """
        columns = [name for name in COLUMNS if name != "temperature_C"]
        given = [name for name in columns if values.get(name, "") != ""]
        if self.load is None:
            if given:
                self.fault(f"{given[0]} needs a load in campaign.yaml", row)
                return None
            return 0.0
        if not given and self.load.unit == "C" and values.get("temperature_C", ""):
            given = ["temperature_C"]
        if len(given) != 1:
            self.fault(f"expected {self._asked()}, got {' and '.join(given) or 'neither'}", row)
            return None
        try:
            factor = factor_of(given[0], self.load)
        except ValueError as error:
            self.fault(str(error), row)
            return None
        value = self.number(row, values, given[0], positive=not self.load.signed)
        if value is None:
            return None
        value *= factor
        if read and abs(value) > self.load.full_scale:
            top = f"{self.load.full_scale / factor:.10g} {_unit_of(given[0], self.load)}"
            self.fault(
                f"{given[0]} {values[given[0]]} lies outside the gauge's range (0 to {top})", row
            )
            return None
        large = LARGE_GAUGE < self.load.full_scale < math.inf
        if self.load.is_force and large and value < SMALL_FORCE:
            self.warn(
                f"{given[0]} {values[given[0]]} is {value:g} N on a gauge of "
                f"{self.load.full_scale:.0f} N: kN given as N?",
                row,
            )
        value = round(value, 6)
        if value <= 0.0 and not self.load.signed:
            self.fault(f"{given[0]} must be positive, got {values[given[0]]}", row)
            return None
        return value

    def _asked(self) -> str:
        """The columns that may hold the load."""
        if self.load.is_force and self.load.name == "axial force":
            return "force_N or pressure_bar" if self.load.gauge == "pressure" else "force_N or load"
        same = [name for name, (unit, _) in COLUMNS.items() if unit == self.load.unit]
        return " or ".join(["load", *same])


def _unit_of(column: str, load: Load) -> str:
    """The unit of a column's numbers."""
    if column == "load":
        return "kN" if load.given == 1e3 else load.unit
    return column.rpartition("_")[2]
