"""A campaign's description and sheet from the files of a folder."""

import csv
import io
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import click

from bladeroot.io.channel import Entry, moving
from bladeroot.io.read import as_stated, channels, formats, stated_unit
from bladeroot.io.recording import recording
from bladeroot.io.units import RAW, normal_unit, quantity_of
from bladeroot.signal.spectral_peaks import common, peaks, spectrum

FILL = "FILL_IN"
# A line is a harmonic of another, or looks like one, where it is nearly a multiple of it.
HARMONIC_ORDERS = (2, 3, 4, 5)
HARMONIC_TOLERANCE = 0.002  # relative distance from the multiple
# A line is the mains' where it is nearly at one of these.
MAINS_HZ = (50.0, 60.0, 100.0, 120.0, 150.0, 180.0)
MAINS_TOLERANCE = 0.001  # relative distance
# Part of the time between the begins of two decays that goes to the second: it must begin at rest.
REST_BEFORE = 0.02
# The name of a MATLAB cell up to its row: rows are measured in turn, columns at once.
_CELL = re.compile(r".*\{\d+")
# Stand in for what a file does not say and the sheet has to, so that its numbers are checked.
_ANY_UNIT = "m/s"
_ANY_SAMPLING_HZ = 1.0
# What a row may lack, by the column that gives it.
LACKING = {
    "unit": "unit of the numbers",
    "sensitivity": "sensitivity of the sensor (125 mm/s/V, 2 g/FS)",
    "sampling_Hz": "sampling frequency",
}


@dataclass(frozen=True)
class Found:
    """One raw file: its channels of motion, the columns of the sheet that must give what it does
    not say, the lines in each channel whose frequencies it does, and when decays begin (s) in those
    that hold several, by the channel's number.
    """

    path: Path
    channels: tuple[Entry, ...]
    alone: bool
    lacks: frozenset[str]
    lines: tuple[tuple[tuple[float, float], ...], ...]
    starts: Mapping[int, Sequence[float]]


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
    timed = [one for one in found if "sampling_Hz" not in one.lacks]
    for one in [one for one in found if timed and one not in timed]:
        click.echo(f"left out: no times in it, as the others have ({one.path})", err=True)
    found = timed or found
    if not found:
        known = ", ".join(sorted(formats()))
        raise ValueError(
            f"expected readable raw files in the folder itself, ending in {known} ({folder})"
        )
    modes = common([lines for one in found for lines in one.lines])
    (folder / "campaign.yaml").write_text(
        description(folder.resolve().name, modes), encoding="utf-8"
    )
    (folder / "records.csv").write_text(sheet(found), encoding="utf-8", newline="")
    for line in summary(found, modes, folder):
        click.echo(line)


def looked_at(path: Path) -> Found:
    """What a file says of itself. ValueError, one line, if it cannot be read."""
    every = channels(path)
    chosen = moving(every)
    lacks: set[str] = set()
    from bladeroot.public.decay import starts

    lines, begins = [], {}
    for entry in chosen:
        found = as_stated(path, channel=str(entry.number))
        where = f"{path}, channel {found.name!r}"
        unit = stated_unit(found, where)
        signal = unit is not None and normal_unit(unit) in RAW
        if signal:
            lacks.add("sensitivity")
        elif unit is None or quantity_of("", unit) is None:
            unit = None
            lacks.add("unit")
        timed = found.sampling_Hz is not None or found.time is not None
        if not timed:
            lacks.add("sampling_Hz")
        record = recording(
            found.samples,
            _ANY_UNIT if signal or unit is None else unit,
            where,
            found.time,
            found.sampling_Hz if timed else _ANY_SAMPLING_HZ,
            start_s=found.start_s,
            scale=found.scale,
        )
        if timed:
            lines.append(tuple(peaks(*spectrum(record.samples, record.sampling_Hz))))
            begins[entry.number] = starts(record, lines[-1][0][0]) if lines[-1] else ()
    several = {number: begin for number, begin in begins.items() if len(begin) > 1}
    return Found(path, chosen, len(every) == 1, frozenset(lacks), tuple(lines), several)


def description(title: str, modes: Sequence[float]) -> str:
    """The text of campaign.yaml."""
    overtones = harmonics(modes)
    mains = [f for f in modes if any(abs(f / one - 1.0) < MAINS_TOLERANCE for one in MAINS_HZ)]
    overtones = {f: of for f, of in overtones.items() if f not in mains}
    named = [f for f in modes if f not in overtones and f not in mains]
    lines = [f"  m{k}: {{expected_Hz: {f:.4g}}}" for k, f in enumerate(named, 1)]
    lines = lines or [f"  m1: {{expected_Hz: {FILL}}}"]
    lines += [f"  # {f:.4g} Hz is where the mains hum" for f in mains]
    lines += [f"  # {f:.4g} Hz is {n} times {base:.4g} Hz" for f, (n, base) in overtones.items()]
    listed = "\n".join(lines)
    return f"""title: {json.dumps(title)}
# The modes that are measured, by any name. These are the lines that stand out of most spectra:
# strike out what is no mode of the structure (suspension, mains), and name the others.
modes:
{listed}
# What is varied between records, if anything; records.csv then needs a column `load`.
# load: {{name: bolt torque, unit: Nm, accuracy: 0.2}}
# What the measurement is judged against: a table (CSV) or structures; without it, a linear mode.
# simulation: table.csv
"""


def harmonics(modes: Sequence[float]) -> dict[float, tuple[int, float]]:
    """The frequencies that are a whole multiple of a lower one's, with both."""
    return {
        f: (n, base)
        for f in modes
        for base in modes
        for n in HARMONIC_ORDERS
        if abs(f / (n * base) - 1.0) < HARMONIC_TOLERANCE
    }


def sheet(found: Sequence[Found]) -> str:
    """The text of records.csv: a row a decay of a file or cell, all modes, channels of motion."""
    columns = ["record", "file", "mode"]
    columns += ["channel"] if any(not one.alone for one in found) else []
    columns += [name for name in LACKING if any(name in one.lacks for one in found)]
    columns += ["from_s", "to_s"] if any(one.starts for one in found) else []
    columns += ["group", "note"]
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    taken: set[str] = set()
    for one in found:
        for together in at_once(one.channels):
            row = {
                "file": one.path.name,
                "mode": "all",
                "channel": "" if one.alone else ";".join(entry.name for entry in together),
                **dict.fromkeys(one.lacks, FILL),
            }
            for from_s, to_s in parts(one.starts.get(together[0].number, ())):
                row |= {"record": _identifier(one.path.stem, taken), "from_s": from_s, "to_s": to_s}
                writer.writerow({name: row.get(name, "") for name in columns})
    return text.getvalue()


def parts(starts: Sequence[float]) -> list[tuple[str, str]]:
    """Columns `from_s` and `to_s` that give each decay a record, a little before it begins."""
    edges = [f"{b - REST_BEFORE * (b - a):.6g}" for a, b in pairwise(starts)]
    return list(pairwise(["", *edges, ""]))


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


def summary(found: Sequence[Found], modes: Sequence[float], folder: Path) -> list[str]:
    """What was written and what is left to do."""
    count = sum(len(one.channels) for one in found)
    together = [(one, cell) for one in found for cell in at_once(one.channels)]
    rows = sum(len(parts(one.starts.get(cell[0].number, ()))) for one, cell in together)
    lines = [
        f"{_counted(len(found), 'file')}, {_counted(count, 'channel')} of motion, "
        f"{_counted(rows, 'row')}: {folder / 'records.csv'}"
    ]
    if any(len(cell) > 1 for _, cell in together):
        lines.append("the channels of a row are taken for sensors of one motion")
    if rows > len(together):
        lines.append("several decays in a file are a row each, from_s to to_s")
    if modes:
        suggested = [f"{f:.4g} Hz" for f in modes if f not in harmonics(modes)]
        lines.append(f"modes suggested: {', '.join(suggested)}")
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
