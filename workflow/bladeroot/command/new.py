"""A campaign's description and sheet from the files of a folder."""

import csv
import io
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from bladeroot.io.channel import Entry
from bladeroot.io.read import as_stated, channels, formats, stated_unit
from bladeroot.io.recording import recording
from bladeroot.io.units import RAW, SI, normal_unit, quantity_of
from bladeroot.signal.spectral_peaks import common, peaks, spectrum

FILL = "FILL_IN"
# The name of a MATLAB cell up to its row: rows are measured in turn, columns at once.
_CELL = re.compile(r".*\{\d+")
# Numbers are checked, and their lines found, whatever the sheet has to give.
_ANY_UNIT, _ANY_RATE = "m/s", 1.0
# What a row may lack, by the column that gives it.
LACKING = {
    "unit": "unit of the numbers",
    "sensitivity": "sensitivity of the sensor (125 mm/s/V, 2 g/FS)",
    "sampling_Hz": "sampling frequency",
}


@dataclass(frozen=True)
class Found:
    """One raw file: its channels of motion, the columns of the sheet that must give what it does
    not say, and the lines in each channel whose frequencies it does.
    """

    path: Path
    channels: tuple[Entry, ...]
    alone: bool
    lacks: frozenset[str]
    lines: tuple[tuple[tuple[float, float], ...], ...]


@click.command()
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
def command(folder: Path) -> None:
    """Write campaign.yaml and records.csv for the raw files in FOLDER; never over old ones."""
    for name in ("campaign.yaml", "records.csv", "stick.csv"):
        if (folder / name).exists():
            raise ValueError(f"{name} is there already; nothing is written ({folder})")
    files = sorted(p for p in folder.iterdir() if p.is_file() and p.suffix.lower() in formats())
    found = []
    for path in files:
        try:
            found.append(looked_at(path))
        except ValueError as error:
            click.echo(f"left out: {error}", err=True)
    if not found:
        known = ", ".join(sorted(formats()))
        raise ValueError(f"expected raw files ending in {known} that can be read ({folder})")
    modes = common([lines for one in found for lines in one.lines])
    (folder / "campaign.yaml").write_text(
        description(folder.resolve().name, modes), encoding="utf-8"
    )
    (folder / "records.csv").write_text(sheet(found), encoding="utf-8", newline="")
    for line in told(found, modes, folder):
        click.echo(line)


def looked_at(path: Path) -> Found:
    """What a file says of itself. ValueError, one line, if it cannot be read."""
    every = channels(path)
    moving = [e for e in every if (e.quantity or quantity_of(e.name, e.unit)) in SI]
    chosen = tuple(moving or every)
    lacks: set[str] = set()
    lines = []
    for entry in chosen:
        found = as_stated(path, channel=str(entry.number))
        where = f"{path}, channel {found.name!r}"
        unit = stated_unit(found, where)
        if unit is None:
            lacks.add("unit")
        elif normal_unit(unit) in RAW:
            lacks.add("sensitivity")
        timed = found.sampling_Hz is not None or found.time is not None
        if not timed:
            lacks.add("sampling_Hz")
        record = recording(
            found.samples,
            unit if unit and normal_unit(unit) not in RAW else _ANY_UNIT,
            where,
            found.time,
            found.sampling_Hz if timed else _ANY_RATE,
            start_s=found.start_s,
            scale=found.scale,
        )
        if timed:
            lines.append(tuple(peaks(*spectrum(record.samples, record.sampling_Hz))))
    return Found(path, chosen, len(every) == 1, frozenset(lacks), tuple(lines))


def description(title: str, modes: Sequence[float]) -> str:
    """The text of campaign.yaml."""
    listed = "\n".join(f"  m{k}: {{expected_Hz: {f:.4g}}}" for k, f in enumerate(modes, 1))
    return f"""title: {json.dumps(title)}
# The modes that are measured, by any name. These are the lines that stand out of most spectra:
# strike out what is no mode of the structure (suspension, mains), and name the others.
modes:
{listed or f"  m1: {{expected_Hz: {FILL}}}"}
# What is varied between records, if anything; records.csv then needs a column `load`.
# load: {{name: bolt torque, unit: Nm, accuracy: 0.2}}
# What the measurement is judged against: a table (CSV) or structures; without it, a linear mode.
# simulation: table.csv
"""


def sheet(found: Sequence[Found]) -> str:
    """The text of records.csv: a row a file or cell of one, all modes, every channel of motion."""
    columns = ["record", "file", "mode"]
    columns += ["channel"] if any(not one.alone for one in found) else []
    columns += [name for name in LACKING if any(name in one.lacks for one in found)]
    columns += ["group", "note"]
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    taken: set[str] = set()
    for one in found:
        for together in at_once(one.channels):
            row = {
                "record": _identifier(one.path.stem, taken),
                "file": one.path.name,
                "mode": "all",
                "channel": "" if one.alone else ";".join(entry.name for entry in together),
                **dict.fromkeys(one.lacks, FILL),
            }
            writer.writerow({name: row.get(name, "") for name in columns})
    return text.getvalue()


def at_once(channels: Sequence[Entry]) -> list[tuple[Entry, ...]]:
    """The channels that were measured at once, as one event of several sensors."""
    rows: dict[str, list[Entry]] = {}
    for entry in channels:
        cell = _CELL.match(entry.name)
        rows.setdefault(cell[0] if cell else "", []).append(entry)
    return [tuple(row) for row in rows.values()]


def _identifier(stem: str, taken: set[str]) -> str:
    """A record's id from a file's name: letters, digits, - and _, and no other's."""
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", stem).strip("_-") or "record"
    unique, k = name, 2
    while unique in taken:
        unique, k = f"{name}_{k}", k + 1
    taken.add(unique)
    return unique


def _counted(count: int, name: str) -> str:
    return f"{count} {name}{'' if count == 1 else 's'}"


def told(found: Sequence[Found], modes: Sequence[float], folder: Path) -> list[str]:
    """What was written and what is left to do."""
    count = sum(len(one.channels) for one in found)
    rows = sum(len(at_once(one.channels)) for one in found)
    lines = [
        f"{_counted(len(found), 'file')}, {_counted(count, 'channel')} of motion, "
        f"{_counted(rows, 'row')}: {folder / 'records.csv'}"
    ]
    if rows < count:
        lines.append("the channels of a row are taken for sensors of one motion")
    if modes:
        lines.append(f"modes suggested: {', '.join(f'{f:.4g} Hz' for f in modes)}")
    missing = [
        f"the {meaning} in column {column} ({FILL})"
        for column, meaning in LACKING.items()
        if any(column in one.lacks for one in found)
    ]
    missing += [] if modes else [f"the modes in campaign.yaml ({FILL})"]
    if missing:
        lines.append(f"to be filled in: {', '.join(missing)}")
    lines.append(f"then: bladeroot check {folder} && bladeroot run {folder}")
    return lines
