"""A campaign folder: its description and its sheet of records or stick frequencies, checked whole.

Everything that can be wrong with the sheets is found here, before any long work, and told as one
line a fault that names the file and the row (the line number an editor shows).
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from bladeroot.records.lone import lone
from bladeroot.records.read import formats
from bladeroot.records.sheet import read_sheet
from bladeroot.records.units import SI, USUAL, motion, sensitivity_of
from bladeroot.schema import read_yaml

RECORD_COLUMNS = (
    "record", "file", "mode", "force_N", "pressure_bar", "hold", "direction", "time_s", "drive_A",
    "quantity", "unit", "sensitivity", "sampling_Hz", "channel", "exclude",
)  # fmt: skip
STICK_COLUMNS = (
    "mode", "force_N", "frequency_Hz", "frequency_std_Hz", "loss_factor", "loss_factor_std",
)  # fmt: skip
NUMBERS = (
    "force_N", "pressure_bar", "time_s", "drive_A", "sampling_Hz", "sensitivity",
    *STICK_COLUMNS[2:],
)  # fmt: skip
# A stick frequency further than this from the mode's expected one belongs to another mode.
MODE_BAND = 0.25
# In the path of an input braces are Snakemake's wildcards, and angle brackets a page's tags.
_MEANT, _TOLD = frozenset("{}<>"), "{ } < >"
_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
# Signs of a name that becomes a file's, with a mode, a channel and an ending behind it: file
# systems allow 255 bytes.
LONGEST_NAME = 100
# A force this small on a gauge this large (N) is a slip of the unit.
SMALL_FORCE, LARGE_GAUGE = 100.0, 10_000.0
# Forces so much apart (relative) are rather readings of one force than two of a test's.
ALIKE = 0.01
# Folders of results/ that are no campaign's.
_RESERVED = ("structures", "bench", "logs", "benchmarks")


def stick_table(path: Path) -> pd.DataFrame:
    """The table of a checked `stick.csv`: text of its cells, a column each."""
    rows, _ = read_sheet(path, STICK_COLUMNS, NUMBERS)
    return pd.DataFrame([values for _, values in rows])


class CampaignError(ValueError):
    """All faults of a campaign's files, a line each."""


@dataclass(frozen=True)
class Campaign:
    """A checked campaign.

    `description` is campaign.yaml, its `structure` a list (empty: nothing to compare with).
    `records` (one dict a usable row, SI units) or `stick` (one dict a row) is filled, the other is
    empty. `excluded` holds the ids of the rows marked `exclude`, `warnings` a line for each
    suspicion that is no fault.
    """

    name: str
    folder: Path
    description: dict
    records: tuple[dict, ...]
    stick: tuple[dict, ...]
    excluded: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    @property
    def simulated(self) -> bool:
        """Whether the virtual test bench makes the raw records."""
        return "bench" in self.description

    @property
    def force_scale(self) -> float:
        """Newtons per unit of the gauge's reading (per bar, or per microstrain)."""
        return force_scale(self.description["force"])

    @property
    def force_full_scale(self) -> float:
        """The gauge's full scale in newtons."""
        gauge = self.description["force"]
        key = "full_scale_bar" if gauge["gauge"] == "pressure" else "full_scale_microstrain"
        return gauge[key] * self.force_scale


_ID_TOLD = f"letters, digits, - and _, {LONGEST_NAME} at most"


def _is_id(name: str) -> bool:
    return len(name) <= LONGEST_NAME and bool(_ID.fullmatch(name))


def _short(text: str) -> str:
    """As much of a text as a message can bear."""
    return text if len(text) <= 80 else f"{text[:80]}..."


def _is(asked: Callable[[], bool]) -> bool:
    """Whether a path is there; a name that is too long, or no right to look, is that it is not."""
    try:
        return asked()
    except (OSError, ValueError):
        return False


def force_scale(gauge: dict) -> float:
    """Newtons per bar (F = A p) or per microstrain (F = A E strain) of a gauge (section 2.1.6)."""
    if gauge["gauge"] == "pressure":
        return gauge["piston_area_cm2"] * 1e-4 * 1e5
    return gauge["section_mm2"] * 1e-6 * gauge["modulus_GPa"] * 1e9 * 1e-6


def load_campaign(folder: str | Path) -> Campaign:
    """Load and check a campaign folder. Raises CampaignError with a line for every fault."""
    folder = Path(folder)
    if not _is(folder.is_dir):
        raise CampaignError(f"campaign folder not found: {_short(str(folder))}")
    if not _is_id(folder.name):
        raise CampaignError(
            f"a campaign folder's name must be {_ID_TOLD}, got {_short(folder.name)!r}"
        )
    if _MEANT & set(str(folder)):
        raise CampaignError(f"the path of a campaign folder must have none of {_TOLD}: {folder}")
    if folder.name in _RESERVED:
        raise CampaignError(
            f"a campaign must not be named {folder.name}: results/ has such a folder"
        )
    try:
        description = read_yaml(folder / "campaign.yaml", "campaign")
    except ValueError as error:
        raise CampaignError(str(error)) from error
    structures = description.get("structure", [])
    description["structure"] = [structures] if isinstance(structures, str) else structures

    sheets = [name for name in ("records.csv", "stick.csv") if (folder / name).is_file()]
    if len(sheets) != 1:
        found = " and ".join(sheets) or "neither"
        raise CampaignError(f"expected records.csv or stick.csv in {folder}, found {found}")
    columns = RECORD_COLUMNS if sheets == ["records.csv"] else STICK_COLUMNS
    try:
        rows, faults = read_sheet(folder / sheets[0], columns, NUMBERS)
    except ValueError as error:
        raise CampaignError(str(error)) from error
    sheet = _Sheet(folder, folder / sheets[0], description, faults, [])
    if sheets == ["records.csv"]:
        records = sheet.records(rows)
        excluded = tuple(row["record"] for row in records if row.pop("exclude"))
        records = tuple(row for row in records if row["record"] not in excluded)
        stick = ()
    else:
        records, excluded = (), ()
        stick = sheet.stick(rows)
    if not faults and not records and not stick:
        faults.append(f"no usable row ({sheet.path})")
    if faults:
        raise CampaignError("\n".join(faults))
    return Campaign(
        folder.name, folder, description, records, stick, excluded, tuple(sheet.warnings)
    )


@dataclass(frozen=True)
class _Sheet:
    """Checks of one sheet; every check adds its line to `faults` and returns a value or None.

    Suspicions go to `warnings`.
    """

    folder: Path
    path: Path
    description: dict
    faults: list[str]
    warnings: list[str]

    def fault(self, text: str, row: int) -> None:
        self.faults.append(f"{text} ({self.path}, row {row})")

    def required(self, rows: list[tuple[int, dict]], columns: tuple[str, ...]) -> bool:
        """Whether the columns are there (told once, not once a row)."""
        present = rows[0][1] if rows else dict.fromkeys(columns)
        missing = [name for name in columns if name not in present]
        if missing:
            self.fault(f"missing column {', '.join(map(repr, missing))}", 1)
        return not missing

    def number(self, row: int, values: dict, name: str, *, positive: bool = False) -> float | None:
        text = values.get(name, "")
        try:
            value = float(text) if "_" not in text else math.nan
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            self.fault(f"{name} must be a finite number, got {_short(text)!r}", row)
            return None
        if positive and value <= 0:
            self.fault(f"{name} must be positive, got {text}", row)
            return None
        return value

    def mode(self, row: int, values: dict) -> str | None:
        mode = values.get("mode", "")
        modes = self.description["modes"]
        if mode in modes:
            return mode
        self.fault(f"mode must be one of {', '.join(modes)} (campaign.yaml), got {mode!r}", row)
        return None

    def force(self, row: int, values: dict) -> float | None:
        """The axial force in newtons, inside the gauge's range."""
        gauge = self.description["force"]
        given = [name for name in ("force_N", "pressure_bar") if values.get(name, "") != ""]
        if len(given) != 1:
            self.fault(
                f"expected force_N or pressure_bar, got {' and '.join(given) or 'neither'}", row
            )
            return None
        value = self.number(row, values, given[0], positive=True)
        if value is None:
            return None
        scale = force_scale(gauge)
        if given == ["pressure_bar"]:
            if gauge["gauge"] != "pressure":
                self.fault("pressure_bar needs a pressure gauge in campaign.yaml", row)
                return None
            value *= scale
        key = "full_scale_bar" if gauge["gauge"] == "pressure" else "full_scale_microstrain"
        full_scale = gauge[key] * scale
        if value > full_scale:
            top = f"{gauge[key]:g} bar" if given == ["pressure_bar"] else f"{full_scale:.0f} N"
            self.fault(
                f"{given[0]} {values[given[0]]} lies outside the gauge's range (0 to {top})", row
            )
            return None
        if value < SMALL_FORCE and full_scale > LARGE_GAUGE:
            self.warnings.append(
                f"{given[0]} {values[given[0]]} is {value:g} N on a gauge of {full_scale:.0f} N: "
                f"kN given as N? ({self.path}, row {row})"
            )
        value = round(value, 6)
        if value <= 0.0:
            self.fault(f"{given[0]} must be positive, got {values[given[0]]}", row)
            return None
        return value

    def records(self, rows: list[tuple[int, dict]]) -> tuple[dict, ...]:
        checked: list[dict] = []
        first_row: dict[str, int] = {}
        if not self.required(rows, ("record", "file", "mode")):
            return ()
        for row, values in rows:
            record = values["record"]
            if not _is_id(record):
                self.fault(f"record must be {_ID_TOLD}, got {_short(record)!r}", row)
            elif record in first_row:
                self.fault(f"record {record!r} stands in row {first_row[record]} already", row)
            first_row.setdefault(record, row)
            checked.append(
                {
                    "record": record,
                    "file": self.raw_file(row, record, values["file"]),
                    "mode": self.mode(row, values),
                    "force_N": self.force(row, values),
                    "hold": values.get("hold") or record,
                    "direction": self.choice(row, values, "direction", ("up", "down"), ""),
                    "time_s": self.optional_number(row, values, "time_s"),
                    "drive_A": self.optional_number(row, values, "drive_A"),
                    **self.quantity(row, values),
                    "sampling_Hz": self.optional_number(row, values, "sampling_Hz", positive=True),
                    "channel": values.get("channel") or None,
                    "exclude": self.exclude(row, values),
                }
            )
        self.one_use(rows)
        if not self.faults:
            self.near_forces([row for row, _ in rows], checked)
        return tuple(checked)

    def near_forces(self, rows: list[int], checked: list[dict]) -> None:
        """Warn where repeats are told apart by what a gauge read, for then they are not pooled."""
        for mode in self.description["modes"]:
            first: dict[float, int] = {}
            for row, line in zip(rows, checked, strict=True):
                if line["mode"] == mode and not line["exclude"]:
                    first.setdefault(line["force_N"], row)
            forces = sorted(first)
            near = [a for a, b in pairwise(forces) if b - a < ALIKE * b]
            if near:
                other = forces[forces.index(near[0]) + 1]
                self.warnings.append(
                    f"{mode}: {len(near) + 1} forces lie less than 1 % apart, as {near[0]:g} and "
                    f"{other:g} N: records are pooled, and their scatter is known, only where "
                    f"the force is the same; repeats of one force need its nominal value "
                    f"({self.path}, row {first[near[0]]})"
                )

    def one_use(self, rows: list[tuple[int, dict]]) -> None:
        """Warn of a raw file that stands for two records of one mode."""
        first_row: dict[tuple, int] = {}
        for row, values in rows:
            place = (values["file"], values.get("channel", ""), values["mode"])
            if values["file"] and place in first_row:
                self.warnings.append(
                    f"file {values['file']} stands in row {first_row[place]} already "
                    f"({self.path}, row {row})"
                )
            first_row.setdefault(place, row)

    def stick(self, rows: list[tuple[int, dict]]) -> tuple[dict, ...]:
        checked = []
        first_row: dict[tuple, int] = {}
        if not self.required(rows, STICK_COLUMNS):
            return ()
        for row, values in rows:
            mode = self.mode(row, values)
            line = {"mode": mode, "force_N": self.force(row, values)}
            for name in STICK_COLUMNS[2:]:
                line[name] = self.number(row, values, name, positive=True)
            if mode and line["frequency_Hz"]:
                expected = self.description["modes"][mode]["expected_Hz"]
                if abs(line["frequency_Hz"] / expected - 1) > MODE_BAND:
                    self.fault(
                        f"frequency_Hz {values['frequency_Hz']} is not in the band of mode {mode} "
                        f"({expected} Hz +- {MODE_BAND:.0%})",
                        row,
                    )
            place = (line["mode"], line["force_N"])
            if None not in place and place in first_row:
                where = f"row {first_row[place]} already"
                self.fault(f"mode {mode} at {line['force_N']:g} N stands in {where}", row)
            first_row.setdefault(place, row)
            checked.append(line)
        if not self.faults:
            self.lone_frequencies([row for row, _ in rows], checked)
        return tuple(checked)

    def lone_frequencies(self, rows: list[int], checked: list[dict]) -> None:
        """Warn of a frequency that lies far from what its neighbours in force say."""
        for mode in self.description["modes"]:
            mine = [k for k, line in enumerate(checked) if line["mode"] == mode]
            force, frequency = (
                np.array([checked[k][name] for k in mine]) for name in ("force_N", "frequency_Hz")
            )
            for k, expected in lone(force, frequency):
                self.warnings.append(
                    f"frequency_Hz {frequency[k]:g} of {mode} at {force[k]:g} N lies far from "
                    f"{expected:.5g}, which its neighbours in force say: a wrong digit? "
                    f"({self.path}, row {rows[mine[k]]})"
                )

    def raw_file(self, row: int, record: str, name: str) -> str:
        if not name:
            self.fault("file is missing", row)
        elif "bench" in self.description:
            if name != f"{record}.nc":
                self.fault(f"file of a simulated record must be {record}.nc, got {name!r}", row)
        elif Path(name).suffix.lower() not in formats():
            self.fault(
                f"file must end in {', '.join(sorted(formats()))}, got {_short(name)!r}", row
            )
        elif _MEANT & set(name):
            self.fault(f"file must have none of {_TOLD} in its name, got {_short(name)}", row)
        elif not _is((self.folder / name).is_file):
            self.fault(f"file not found: {_short(name)}", row)
        return name

    def choice(self, row: int, values: dict, name: str, choices: tuple[str, ...], default: str):
        value = values.get(name) or default
        if value and value not in choices:
            self.fault(f"{name} must be {' or '.join(choices)}, got {value!r}", row)
        return value

    def optional_number(
        self, row: int, values: dict, name: str, *, positive: bool = False
    ) -> float | None:
        given = values.get(name, "") != ""
        return self.number(row, values, name, positive=positive) if given else None

    def quantity(self, row: int, values: dict) -> dict:
        """Quantity, unit and sensitivity as far as the sheet gives them; the rest the file says."""
        quantity = self.choice(row, values, "quantity", tuple(SI), "") or None
        unit = values.get("unit") or None
        sensitivity = values.get("sensitivity") or None
        if unit:
            try:
                found = motion(unit, sensitivity)[0]
            except ValueError as error:
                self.fault(str(error), row)
            else:
                if quantity in SI and quantity != found:
                    fitting = [name for name, (of, _) in USUAL.items() if of == quantity]
                    self.fault(
                        f"unit of {quantity} must be one such as {', '.join(fitting)}, got "
                        f"{unit!r}, a {found}",
                        row,
                    )
        elif sensitivity:
            try:
                sensitivity_of(sensitivity)
            except ValueError as error:
                self.fault(str(error), row)
        return {"quantity": quantity, "unit": unit, "sensitivity": sensitivity}

    def exclude(self, row: int, values: dict) -> bool:
        text = values.get("exclude", "").lower()
        if text not in ("", "0", "1", "no", "yes", "false", "true"):
            self.fault(f"exclude must be yes or no, got {text!r}", row)
        return text in ("1", "yes", "true")
