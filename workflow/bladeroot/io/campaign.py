"""A campaign folder: its description and its sheet of records or stick frequencies, checked whole.

Everything that can be wrong with the sheets is found here, before any long work, and told as one
line a fault that names the file and the row (the line number an editor shows).
"""

import re
from dataclasses import dataclass
from pathlib import Path

from bladeroot.io.expected import faults_of_expected
from bladeroot.io.load import COLUMNS, Load, load_of
from bladeroot.io.names import ID_RULE, SPECIAL, SPECIAL_TEXT, is_id, is_there, short
from bladeroot.io.rows import RECORD_COLUMNS, RecordRows
from bladeroot.io.sheet import read_sheet
from bladeroot.io.simulation import STRUCTURE, simulation_of
from bladeroot.io.stick_rows import STICK_COLUMNS, VALUES, StickRows
from bladeroot.schema import read_yaml

NUMBERS = (
    *COLUMNS, "time_s", "drive_A", "sampling_Hz", "sensitivity", "from_s", "to_s", "start_s",
    "end_s", *VALUES,
)  # fmt: skip
# The modes that a structure's stages know.
STRUCTURE_MODES = ("1B", "2B")
_ROW = re.compile(r"(?<=, row )\d+(?=\)$)")  # where a fault says it
# Folders of results/ that are no campaign's.
_RESERVED = ("structures", "bench", "logs", "benchmarks", "provenance")


class CampaignError(ValueError):
    """All faults of a campaign's files, a line each."""


@dataclass(frozen=True)
class Campaign:
    """A checked campaign.

    `description` is campaign.yaml, its `structure` a list of the structures to compare with and its
    `simulation` "structure", "assembly", "none" or a table's file name. `load` is None where
    records have none. `records` (one dict a record, SI units) or `stick` (one dict a row) is
    filled, the other is empty. `excluded` holds the ids of the records marked `exclude`,
    `warnings` a line for each suspicion that is no fault.
    """

    name: str
    folder: Path
    description: dict
    load: Load | None
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
        """The load per unit of the gauge's reading (newtons per bar, or per microstrain)."""
        return self.load.scale if self.load else 1.0

    @property
    def structure_lacks(self) -> str:
        """Why nothing can be inferred with the campaign's structures, a phrase, or ""."""
        if self.description["simulation"] != STRUCTURE:
            return ""
        if self.load is None:
            return "a structure is prestressed by a load, and the campaign states none"
        unknown = [mode for mode in self.description["modes"] if mode not in STRUCTURE_MODES]
        if unknown:
            known = " and ".join(STRUCTURE_MODES)
            return f"a structure knows modes {known}, not {', '.join(unknown)}"
        return ""

    def laser_x(self, mode: str) -> float | None:
        """Where along the specimen a mode is looked at, m: the mode's own, or the one sensor's."""
        here = self.description["modes"][mode]
        if "laser_x_mm" in here:
            return here["laser_x_mm"] / 1000
        placed = [one["x_mm"] for one in self.description.get("sensors", {}).values()
                  if "x_mm" in one]  # fmt: skip
        return placed[0] / 1000 if len(placed) == 1 else None


def load_campaign(folder: str | Path) -> Campaign:
    """Load and check a campaign folder. Raises CampaignError with a line for every fault."""
    folder = Path(folder)
    if not is_there(folder.is_dir):
        raise CampaignError(f"campaign folder not found: {short(str(folder), 400)}")
    if not is_id(folder.name):
        raise CampaignError(
            f"a campaign folder's name must be {ID_RULE}, got {short(folder.name)!r}"
        )
    if SPECIAL & set(str(folder)):
        raise CampaignError(
            f"the path of a campaign folder must have none of {SPECIAL_TEXT}: {folder}"
        )
    if folder.name.lower() in _RESERVED:  # some disks do not tell a from A
        raise CampaignError(
            f"a campaign must not be named {folder.name}: results/ has such a folder"
        )
    try:
        description = read_yaml(folder / "campaign.yaml", "campaign")
    except ValueError as error:
        raise CampaignError(str(error)) from error
    try:
        load = load_of(description)
        description |= simulation_of(description, load, folder)
    except ValueError as error:
        raise CampaignError(f"{error} ({folder / 'campaign.yaml'})") from error

    sheets = [name for name in ("records.csv", "stick.csv") if (folder / name).is_file()]
    if len(sheets) != 1:
        found = " and ".join(sheets) or "neither"
        raise CampaignError(f"expected records.csv or stick.csv in {folder}, found {found}")
    path = folder / sheets[0]
    of_records = path.name == "records.csv"
    columns = RECORD_COLUMNS if of_records else STICK_COLUMNS
    try:
        rows, faults = read_sheet(path, columns, NUMBERS)
    except ValueError as error:
        raise CampaignError(str(error)) from error
    warnings: list[str] = []
    faults += _unplaced(description, load, folder)
    expected = faults_of_expected(description["modes"], load)
    faults += [f"{fault} ({folder / 'campaign.yaml'})" for fault in expected]
    checks = (folder, path, description, load, faults, warnings)
    records: tuple[dict, ...] = ()
    stick: tuple[dict, ...] = ()
    excluded: tuple[str, ...] = ()
    if of_records:
        every = RecordRows(*checks).records(rows)
        excluded = tuple(row["record"] for row in every if row.pop("exclude"))
        records = tuple(row for row in every if row["record"] not in excluded)
    else:
        stick = StickRows(*checks).stick(rows)
    if not faults and description["simulation"].endswith(".csv"):
        faults += _beyond_table(folder / description["simulation"], description, load, path,
                                records or stick)  # fmt: skip
    if not faults and not records and not stick:
        faults.append(f"no usable row ({path})")
    if faults:
        raise CampaignError("\n".join(_once(faults)))
    return Campaign(
        folder.name, folder, description, load, records, stick, excluded, tuple(warnings)
    )


def _once(faults: list[str]) -> list[str]:
    """A fault that many rows of a sheet have is one line: of the first, with their number."""
    lines: dict[str, list[str]] = {}
    for fault in faults:
        lines.setdefault(_ROW.sub("", fault), []).append(fault)
    return [
        f"{first[:-1]} and {len(more)} more)" if more else first for first, *more in lines.values()
    ]


def _unplaced(description: dict, load: Load | None, folder: Path) -> list[str]:
    """Faults of modes of which a structure is not told where they are looked at."""
    campaign = Campaign("", folder, description, load, (), (), ())
    if description["simulation"] != STRUCTURE or campaign.structure_lacks:
        return []
    return [
        f"modes.{mode}.laser_x_mm is missing: a structure must know where the mode is looked at "
        f"({folder / 'campaign.yaml'})"
        for mode in description["modes"]
        if campaign.laser_x(mode) is None
    ]


def _beyond_table(
    table: Path, description: dict, load: Load | None, sheet: Path, rows: tuple[dict, ...]
) -> list[str]:
    """Faults of the table, and of records that it cannot speak of."""
    from bladeroot.io.table import outside, read_table  # late: pandas, for a table alone

    try:
        frame = read_table(table, description, load)
    except ValueError as error:
        return str(error).splitlines()
    modes, loads = [row["mode"] for row in rows], [row["load"] for row in rows]
    named: dict[str, list[str]] = {}
    for k, why in outside(frame, modes, loads, load):
        named.setdefault(why, []).append(rows[k].get("record", modes[k]))
    return [
        f"{first}{f' and {len(more)} more' if more else ''}: {why} ({sheet})"
        for why, (first, *more) in named.items()
    ]
