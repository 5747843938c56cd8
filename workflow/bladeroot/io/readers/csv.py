"""Text tables: a time column and one of motion, units in the header, below it or given."""

import csv
import io
import re
from dataclasses import dataclass

import numpy as np

from bladeroot.io.channel import Channel, Entry, pick, split_name, time_factor
from bladeroot.io.sampling import uniform
from bladeroot.io.statements import one_time, statements
from bladeroot.io.text import (
    check_commas,
    check_thousands,
    encoding_of,
    no_number,
    numeric,
    separator_of,
)
from bladeroot.io.units import normal_unit, one_unit, quantity_of, seconds

SUFFIXES = (".csv", ".txt", ".tsv", ".asc", ".lvm")
_HEAD_BYTES = 1 << 16  # at the begin of a file, in which its header stands
_BLOCK_BYTES = 1 << 24  # that are read at a time

_COMMA = re.compile(r"[-+]?\d*,\d+(e[-+]?\d+)?", re.IGNORECASE)
_QUOTED = re.compile(r'^"([^"]*)"$')
_COMMENTS = ("#", "%", "//")  # what a line of comment begins with
# A word and what it is: a text, or a number with commas and its unit in a field of its own.
_WORD = re.compile(
    r"[#%/\s]*([\w .\[\]()]+?)\s*[:=;,\t]\s*"
    r"([^;,\t]+?|[-+]?\d[\d.,]*(?:e[-+]?\d+)?\s*[;,\t]?\s*[a-z/]*)[\s;,]*",
    re.IGNORECASE,
)
# LabVIEW says that there are no times, and leaves their column empty.
_NO_TIMES = re.compile(r"^X_Columns\tNo\b", re.MULTILINE | re.IGNORECASE)
# Words that say the unit of the motion, without blanks and underscores.
_UNIT_WORDS = ("unit", "units", "einheit", "yunit", "yunits", "yunitlabel")
# Units that channels beside motion and time have in the line below the names.
_OTHER_UNITS = ("V", "mV", "A", "mA", "N", "kN", "Nm", "Hz", "kHz", "Pa", "kPa", "MPa", "bar",
                "mbar", "°C", "degC", "K", "%", "-")  # fmt: skip


@dataclass(frozen=True)
class _Form:
    """How the table is written: encoding, first row of numbers, separator, decimal sign, names.

    quoted: whether the numbers stand in quotation marks. hollow: whether the first column is empty.
    """

    encoding: str
    first: int
    separator: str | None
    separators: int
    decimal: str
    quoted: bool
    names: tuple[str, ...]
    units: tuple[str | None, ...]
    words: dict[str, str]
    hollow: bool = False


def read(path: str, channel: str | None = None, quantity: str | None = None) -> Channel:
    """Read the time column, if there is one, and the column that is meant.

    The header is the line above the first row of numbers: `time_s` and, say, `velocity_m/s`,
    `velocity [mm/s]` or `velocity (mm/s)`; or names, and units in the line below them. Lines
    before it may say `sampling_Hz: 25600`, `fs: 25.6 kHz`, `unit: mm/s`, `mode: 1B`,
    `force_N: 12000`. Fields are split at commas, semicolons or tabs and may stand in
    quotation marks; a decimal comma may stand where commas do not split.
    Signs between thousands are refused, and commas that may be such. Cells of the motion without a
    number (NaN, ---, #N/A, empty) are lost samples, OVR and the like overloads.
    A last line without a line end counts as cut off.
    """
    form = _form(path)
    columns = list(zip(form.names, form.units, strict=True))
    factors = [time_factor(name, unit, path) for name, unit in columns]
    if form.hollow:
        factors[0] = None
    clock = _unnamed_clock(path, form)
    entries = [
        Entry(k + 1, name, unit or split_name(name)[1],
              timelike=factors[k] is not None or (k == 0 and clock != ""))
        for k, (name, unit) in enumerate(columns) if k or not form.hollow
    ]  # fmt: skip
    entry = pick(entries, channel, quantity, path)
    times = [k for k, factor in enumerate(factors) if factor is not None and k != entry.number - 1]
    values = _numbers(path, form, [entry.number - 1, *times])
    # LabVIEW's time step is Delta_X
    said = statements(form.words.items(), path, steps=("deltax",))
    clocks = {
        f"{k + 1}: {form.names[k]}": values[:, 1 + j] * factors[k] for j, k in enumerate(times)
    }
    units = {"in the column": entry.unit} | {
        f"above the table ({word})": text
        for word, text in form.words.items()
        # `Units: SI` says nothing
        if re.sub(r"[\s_]+", "", word) in _UNIT_WORDS and (word == "unit" or _unit(text))
    }
    return Channel(
        name=entry.name,
        samples=values[:, 0],
        unit=one_unit(units, path),
        quantity=form.words.get("quantity"),
        time=one_time(clocks, path),
        sampling_Hz=said.sampling_Hz,
        sampling_error=said.sampling_error,
        facts=said.facts,
        notes=said.notes,
        clock=clock,
    )


def _unnamed_clock(path: str, form: _Form) -> str:
    """What to say of a first column without a name that rises in equal steps, as no motion does."""
    if len(form.names) < 2 or form.names[0] != _unnamed(0):
        return ""
    first = _numbers(path, form, [0])[:, 0]
    try:
        rate, _ = uniform(first, first.size, path)
    except ValueError:
        return ""
    return (
        f"column 1 rises in steps of {1.0 / rate:.6g}, as times do; sampling_Hz "
        f"says their unit: {rate:.9g} if they are in s, {1e3 * rate:.9g} in ms"
    )


def _unnamed(k: int) -> str:
    return f"column {k + 1}"


def _form(path: str) -> _Form:
    with open(path, "rb") as file:
        start = file.read(_HEAD_BYTES)
    encoding = encoding_of(start, path)
    text = start.decode(encoding, errors="replace")
    # the last line is cut off, here or in the file, or is empty
    lines = re.split(r"\r\n|\n|\r", text)[:-1]
    hollow = _NO_TIMES.search(text) is not None
    first = next((k for k, line in enumerate(lines) if _is_row(line, hollow)), None)
    rows = [
        [] if line.startswith(_COMMENTS) else _fields(line, separator_of(line)) for line in lines
    ]
    check_thousands(rows, path)
    if first is None:
        last = next((line for line in reversed(lines) if line.strip()), "")
        raise ValueError(
            "expected a header and rows of numbers, got no row of numbers but lines such as "
            f"{last[:60]!r} ({path})"
        )
    separator = separator_of(lines[first])
    fields = _fields(lines[first], separator)
    above = [k for k in range(first) if lines[k].strip() and not lines[k].startswith(_COMMENTS)]
    commas = separator != "," and any(
        _COMMA.fullmatch(field) for line in lines[first:] for field in _fields(line, separator)
    )
    if commas:
        check_commas([_fields(line, separator) for line in lines[first:]], first, path)
    heads = [_names(lines[k], separator) for k in above[-2:]]
    names = heads[-1] if heads else []
    if len(names) == len(fields) + 1 and names[-1].lower() == "comment":
        names = names[:-1]  # LabVIEW names a column of comments and leaves it out of the rows
    if separator and len(names) <= lines[first].count(separator) + 1:
        fields += [""] * (len(names) - len(fields))  # the last cells of the first row may be empty
    if len(fields) == 1 and names:
        names = [" ".join(names)]  # what stands above a single column is its name, blanks and all
    used = above[-1:] if len(fields) > 1 else []
    units: list[str | None] = [None] * len(fields)
    bare = [name.strip("[]() ") for name in names]
    if len(heads) > 1 and len(names) == len(fields) and all(map(_unit, bare)):
        units, names, used = list(bare), heads[0], above[-2:]
    if not above:
        names = _commented(lines[:first], separator, len(fields))
    if len(names) != len(fields):
        raise ValueError(
            f"expected a name for each of the {len(fields)} columns, got {', '.join(names)} "
            f"({path}, row {above[-1] + 1})"
        )
    # the names of columns are no words
    others = [line for k, line in enumerate(lines[:first]) if k not in used]
    words = _words(others)
    if not any(units):
        units = _units_above(others, separator, len(fields)) or units
    return _Form(
        encoding,
        first,
        separator,
        lines[first].count(separator) if separator else 0,
        "," if commas else ".",
        '"' in lines[first],
        tuple(names),
        tuple(units),
        words,
        hollow,
    )


def _names(line: str, separator: str | None) -> list[str]:
    """Fields of a header, in which quotation marks may hold what splits fields."""
    if not separator or '"' not in line:
        return _fields(line, separator)
    names = [name.strip() for name in next(csv.reader([line], delimiter=separator))]
    while names and not names[-1]:
        names.pop()
    return names


def _units_above(lines: list[str], separator: str | None, count: int) -> list[str | None]:
    """Units of the columns but the first, a time, from a line that begins with such a word."""
    for line in lines:
        word, *texts = _fields(line, separator) or [""]
        if re.sub(r"[\s_]+", "", word.lower()) in _UNIT_WORDS and len(texts) == count - 1 > 1:
            return [None, *(text if _unit(text) else None for text in texts)]
    return []


def _commented(lines: list[str], separator: str | None, count: int) -> list[str]:
    """Names of columns in the comment right above the numbers, as numpy writes them, or numbers."""
    last = lines[-1] if lines and lines[-1].startswith(_COMMENTS) else ""
    names = _fields(last.lstrip("".join(_COMMENTS)), separator)
    with_units = len(names) == count and any(_unit(split_name(name)[1] or "") for name in names)
    return names if with_units else [_unnamed(k) for k in range(count)]


def _fields(line: str, separator: str | None) -> list[str]:
    """Fields of a line without their quotation marks; empty ones at the end do not count."""
    fields = [_QUOTED.sub(r"\1", field.strip()) for field in line.split(separator)]
    while fields and not fields[-1]:
        fields.pop()
    return fields


def _is_row(line: str, hollow: bool) -> bool:
    """Whether a line is a row of numbers, and of marks of lost ones; it begins with a number or an
    overload, as headers and lines that are drawn below them do not.
    """
    fields = _fields(line, separator_of(line))
    fields = fields[1:] if hollow and len(fields) > 1 and not fields[0] else fields
    if not fields or line.startswith(_COMMENTS):
        return False
    begins = numeric(fields[0]) or no_number(fields[0]) == np.inf
    return begins and all(numeric(field) or no_number(field) is not None for field in fields)


def _unit(text: str) -> bool:
    return bool(seconds(text) or normal_unit(text) in _OTHER_UNITS or quantity_of("", text))


def _words(lines: list[str]) -> dict[str, str]:
    """What the lines above the table say as `name: value` or `name = value`, or for each column."""
    words = {}
    for line in lines:
        line = line.replace('"', "")
        name, *values = (field.strip() for field in re.split(r"[;\t]", line))
        if len(set(filter(None, values))) == 1:
            line = f"{name}: {next(filter(None, values))}"
        if match := _WORD.fullmatch(line):
            words[match[1].strip().lower()] = match[2].strip()
    return words


def _numbers(path: str, form: _Form, columns: list[int]) -> np.ndarray:
    """The wanted columns as floats, block by block; in the first of them samples may be lost."""
    parts = []
    row = form.first + 1
    # UTF-8 and cp1252 are one byte a digit: only UTF-16 and a mark at the start must be known
    encoding = "latin-1" if form.encoding in ("utf-8", "cp1252") else form.encoding
    with open(path, encoding=encoding, errors="replace") as file:
        for _ in range(form.first):
            file.readline()
        while block := file.read(_BLOCK_BYTES):
            block += file.readline()
            if not block.endswith("\n"):
                block = block[: block.rfind("\n") + 1]
            if block:
                if form.quoted:
                    block = block.replace('"', "")
                parts.append(_block(block, row, form, columns, path))
                row += block.count("\n")
    return np.concatenate(parts) if parts else np.zeros((0, len(columns)))


def _block(block: str, row: int, form: _Form, columns: list[int], path: str) -> np.ndarray:
    """Numbers of some whole lines, the first of which is `row`."""
    import pandas

    content = block.encode()
    try:
        if form.separator and not _even(content, form):
            raise ValueError
        values = pandas.read_csv(
            io.BytesIO(content),
            sep=form.separator or r"\s+",
            header=None,
            names=range(len(form.names)),
            usecols=columns if form.separator else None,
            index_col=False,
            dtype=float,
            decimal=form.decimal,
            quoting=csv.QUOTE_NONE,
            na_filter=False,
        )[columns].to_numpy()
        if np.isfinite(values).all():
            return values
    except (ValueError, OverflowError):
        pass
    return _by_cells(block, row, form, columns, path)


def _even(content: bytes, form: _Form) -> bool:
    """Whether every line has as many separators as the first one of the table."""
    signs = np.frombuffer(content, np.uint8)
    ends = np.flatnonzero(signs == ord("\n"))
    starts = np.concatenate([[0], ends[:-1] + 1])
    counts = np.add.reduceat(signs == ord(form.separator), starts, dtype=np.int64)
    return bool(((counts == form.separators) | (starts == ends)).all())


def _by_cells(block: str, row: int, form: _Form, columns: list[int], path: str) -> np.ndarray:
    """The same cell by cell: NaN for a lost sample, infinity for one over the range.

    Raises:
        ValueError: the first line that is not as it should be.
    """
    rows = []
    expected = form.separators + 1 if form.separator else len(form.names)
    for number, line in enumerate(block.split("\n"), row):
        if not line.strip():
            continue
        fields = line.split(form.separator)
        if len(fields) != expected:
            raise ValueError(
                f"expected {expected} fields, got {len(fields)} ({path}, row {number})"
            )
        cells = [fields[k].strip() for k in columns]
        values = [_number(cell, form.decimal) for cell in cells]
        lost = no_number(cells[0].strip('"'))
        values[0] = values[0] if lost is None else lost
        bad = next((k for k, value in enumerate(values) if value is None), None)
        if bad is not None:
            marks = "" if bad else " or the mark of a lost sample (NaN, ---, OVR, an empty cell)"
            raise ValueError(
                f"expected a finite number{marks}, got {cells[bad][:40]!r} ({path}, row "
                f"{number}, column {form.names[columns[bad]]!r})"
            )
        rows.append(values)
    return np.array(rows, float).reshape(-1, len(columns))


def _number(cell: str, decimal: str) -> float | None:
    """A finite number, None where the cell is none."""
    try:
        value = float(cell.replace(decimal, "."))
    except ValueError:
        return None
    return value if np.isfinite(value) and "_" not in cell else None
