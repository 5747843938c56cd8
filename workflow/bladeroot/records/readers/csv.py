"""CSV with a header: a time column and one of motion, units in the header or given."""

import re

import numpy as np

from bladeroot.records.recording import SI, UNITS, Recording, normal_unit, recording

SUFFIXES = (".csv", ".txt", ".tsv")
TIMES = {"time_s": 1.0, "time": 1.0, "t": 1.0, "t_s": 1.0, "time_ms": 1e-3, "time_us": 1e-6}


def read(
    path: str,
    quantity: str | None = None,
    unit: str | None = None,
    channel: str | None = None,
    sampling_Hz: float | None = None,
) -> Recording:
    """Read the time column and one column of motion.

    Header: `time_s` (also time, t, time_ms, time_us) and, say, `velocity_m/s`, `velocity [mm/s]`
    or `velocity (mm/s)`; with `unit` given the header needs none. `channel` is a column's full
    header or its name without the unit. Fields are split at commas, semicolons or tabs.
    """
    try:
        with open(path, encoding="utf-8-sig") as file:
            lines = file.read().splitlines()
    except UnicodeDecodeError as error:
        raise ValueError(
            f"expected UTF-8 text, {error.reason} at byte {error.start} ({path})"
        ) from (error)
    except OSError as error:
        raise ValueError(f"expected a readable file, got: {error.strerror} ({path})") from error
    rows = [k for k, line in enumerate(lines) if line.strip() and not line.startswith("#")]
    if len(rows) < 2:
        raise ValueError(f"expected a header and rows of numbers, got {len(rows)} lines ({path})")
    header = lines[rows[0]]
    separator = max(",;\t", key=header.count)
    names = [name.strip().strip('"') for name in header.split(separator)]
    motion = _column(names, quantity, channel, path)
    times = [k for k, name in enumerate(names) if _plain(name) in TIMES]
    if not times and sampling_Hz is None:
        raise ValueError(
            f"expected a time column ({', '.join(TIMES)}), got columns {', '.join(names)} ({path})"
        )
    columns = [motion, *times[:1]]
    values = _numbers(lines, rows[1:], separator, columns, names, path)
    base, own = _split(names[motion])
    if unit is None and own is None:
        raise ValueError(
            f"expected a unit in the header, such as {base}_m/s, or a unit given, got column "
            f"{names[motion]!r} ({path}, row {rows[0] + 1})"
        )
    time = values[:, 1] * TIMES[_plain(names[times[0]])] if times else None
    where = f"{path}, column {names[motion]!r}, first sample in row {rows[1] + 1}"
    return recording(values[:, 0], unit or own, where, time, sampling_Hz, quantity)


def _split(name: str) -> tuple[str, str | None]:
    """A header's name and its unit: velocity_m/s, velocity [m/s], velocity (m/s)."""
    match = re.fullmatch(r"(.*?)\s*[\[(]\s*(.+?)\s*[\])]", name)
    if match:
        return match[1].strip(), match[2]
    base, _, tail = name.rpartition("_")
    return (base, tail) if base and normal_unit(tail) in UNITS else (name, None)


def _plain(name: str) -> str:
    match = re.fullmatch(r"(.*?)\s*[\[(]\s*(.+?)\s*[\])]", name)
    return (f"{match[1]}_{match[2]}" if match else name).strip().lower()


def _column(names: list[str], quantity: str | None, channel: str | None, path: str) -> int:
    if channel:
        fits = [k for k, name in enumerate(names) if channel in (name, _split(name)[0])]
        wanted = channel
    else:
        kinds = [quantity] if quantity else list(SI)
        fits = [k for k, name in enumerate(names) if _split(name)[0].lower() in kinds]
        wanted = " or ".join(kinds)
    if len(fits) != 1:
        problem = "none" if not fits else "several: " + ", ".join(names[k] for k in fits)
        raise ValueError(
            f"expected one column {wanted}, got {problem} of the columns {', '.join(names)}; "
            f"channel in records.csv can name it ({path})"
        )
    return fits[0]


def _numbers(
    lines: list[str],
    rows: list[int],
    separator: str,
    columns: list[int],
    names: list[str],
    path: str,
) -> np.ndarray:
    """The wanted columns as floats; a bad field is named by its row in the file."""
    try:
        values = np.loadtxt([lines[k] for k in rows], delimiter=separator, usecols=columns, ndmin=2)
        if np.isfinite(values).all():
            return values
    except (ValueError, IndexError):
        pass
    for k in rows:
        fields = lines[k].split(separator)
        for column in columns:
            field = fields[column].strip() if column < len(fields) else ""
            try:
                good = np.isfinite(float(field))
            except ValueError:
                good = False
            if not good:
                raise ValueError(
                    f"expected a finite number, got {field!r} ({path}, row {k + 1}, column "
                    f"{names[column]!r}){_comma(field)}"
                )
    raise ValueError(f"expected columns of numbers split by {separator!r} ({path})")


def _comma(field: str) -> str:
    return "; a decimal comma? write a point" if re.fullmatch(r"-?\d+,\d+", field) else ""
