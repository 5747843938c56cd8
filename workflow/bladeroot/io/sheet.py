"""The form of a campaign's sheet: encoding, separator, header and cells, all as text."""

import csv
from pathlib import Path

from bladeroot.io.text import check_commas, decode, numeric, separator_of, unsure

# Bytes of a sheet at most; one of ten thousand records has two million.
LARGEST_BYTES = 50_000_000
# Columns that begin with it are a person's remarks, which justify what a row overrules.
REMARK = "note"


def read_sheet(
    path: Path, columns: tuple[str, ...], numbers: tuple[str, ...]
) -> tuple[list[tuple[int, dict]], list[str]]:
    """Rows of a sheet as text with their line numbers, and the faults of its form.

    Commas, semicolons or tabs split its cells; the `numbers` among the columns may have decimal
    commas where semicolons do.

    Raises:
        ValueError: not a sheet, columns other than `columns` and remarks, or commas whose meaning
            is open; a line a fault.
    """
    try:
        size = path.stat().st_size
        content = path.read_bytes() if size <= LARGEST_BYTES else b""
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror} ({path})") from error
    if size > LARGEST_BYTES:
        raise ValueError(f"expected a sheet of {LARGEST_BYTES} bytes at most, got {size} ({path})")
    lines = decode(content, str(path)).splitlines()
    separator = separator_of(lines[0] if lines else "") or ","
    reader = csv.reader(lines, delimiter=separator)
    try:
        header = [name.strip() for name in next(reader, [])]
        table = [(reader.line_num, cells) for cells in reader]
    except csv.Error as error:
        raise ValueError(f"not a CSV sheet: {error} ({path}, row {reader.line_num})") from error
    while header and not header[-1]:  # spreadsheets leave empty columns at the right
        header.pop()
    if not header:
        raise ValueError(f"the sheet is empty; expected a header row ({path})")
    faults = [
        f"unknown column {name!r}; expected some of {', '.join(columns)}, or {REMARK}... for "
        f"remarks ({path}, row 1)"
        for name in header
        if name not in columns and not name.lower().startswith(REMARK)
    ]
    faults += [
        f"column {name!r} stands twice ({path}, row 1)"
        for name in sorted(set(header))
        if header.count(name) > 1
    ]
    if faults:
        raise ValueError("\n".join(faults))
    rows = []
    for row, cells in table:
        if not any(cell.strip() for cell in cells):
            continue
        while len(cells) > len(header) and not cells[-1].strip():
            cells.pop()
        if len(cells) != len(header):
            faults.append(f"expected {len(header)} cells, got {len(cells)} ({path}, row {row})")
            continue
        rows.append((row, {name: cell.strip() for name, cell in zip(header, cells, strict=True)}))
    if separator == ";":
        rows = _decimal(rows, numbers, str(path))
    return rows, faults


def _decimal(
    rows: list[tuple[int, dict]], numbers: tuple[str, ...], path: str
) -> list[tuple[int, dict]]:
    """Rows with the decimal commas of their numbers as points.

    Raises:
        ValueError: no comma is a decimal one for certain, or a point beside them may stand between
            thousands.
    """
    found = {
        row: {name: values[name] for name in values if name in numbers and numeric(values[name])}
        for row, values in rows
    }
    doubtful: list[list[str]] = [[] for _ in range(max(found, default=0))]  # by line
    for row, given in found.items():
        doubtful[row - 1] = [cell for cell in given.values() if "," in cell or unsure(cell)]
    if any("," in cell for line in doubtful for cell in line):
        check_commas(doubtful, 0, path)
    return [
        (row, values | {name: cell.replace(",", ".") for name, cell in found[row].items()})
        for row, values in rows
    ]
