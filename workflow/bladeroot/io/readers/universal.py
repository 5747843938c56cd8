"""Universal file, data set 58 (function at nodal degree of freedom), as text or binary (58b).

The header is read by its columns and the numbers block by block; what the header claims must be
there. A data set 164 says the length unit where the ordinate has no label.
"""

import mmap
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bladeroot.io.channel import Channel, Entry, pick
from bladeroot.io.sampling import usual_rate
from bladeroot.io.units import seconds

SUFFIXES = (".uff", ".unv", ".u58")
QUANTITIES = {8: "displacement", 11: "velocity", 12: "acceleration"}
_RATE_OF = {8: "", 11: "/s", 12: "/s^2"}
_LENGTHS = {1.0: "m", 100.0: "cm", 1000.0: "mm", 39.37008: "in", 3.28084: "ft"}
_AXES = {0: "S", 1: "X", 2: "Y", 3: "Z", 4: "RX", 5: "RY", 6: "RZ"}
# A data set is a time response by the type of its abscissa or by the type of its function.
_TIME_ABSCISSA = 17
_TIME_RESPONSE = 1
_BLOCK_LINES = 20_000  # lines of text that are read at a time
# Relative error that an increment's digits leave open, above which it is a round step (0.01) rather
# than a rounded one.
_COARSEST_ROUNDING = 0.02
_NUMBER_BYTES = np.isin(np.arange(256), np.frombuffer(b"0123456789+-.eE ", np.uint8))


@dataclass(frozen=True)
class _Set:
    """Header of one data set 58 and where its numbers lie."""

    name: str
    code: int
    label: str | None
    count: int
    double: bool
    even: bool
    start_s: float
    increment: str
    time_unit: str
    order: str
    begin: int
    end: int


def read(path: str, channel: str | None = None, quantity: str | None = None) -> Channel:
    """Read one time response; its name is its response node and direction, such as `12:+Z`."""
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        sets, length = _sets(content, path)
        entries = [
            Entry(k + 1, one.name, one.label or _unit(one.code, length), QUANTITIES.get(one.code))
            for k, one in enumerate(sets)
        ]
        entry = pick(entries, channel, quantity, path)
        chosen = sets[entry.number - 1]
        values = _values(content, chosen, path)
    factor = seconds(chosen.time_unit)
    if factor is None:
        raise ValueError(f"expected times in s or ms, got {chosen.time_unit!r} ({path})")
    rate, error = _rate(chosen, factor, path) if chosen.even else (None, 0.0)
    return Channel(
        name=entry.name,
        samples=values if chosen.even else values[1::2],
        unit=entry.unit,
        quantity=entry.quantity,
        time=None if chosen.even else values[0::2] * factor,
        sampling_Hz=rate,
        sampling_error=error,
        start_s=chosen.start_s * factor if chosen.even else 0.0,
    )


def _rate(chosen: _Set, factor: float, path: str) -> tuple[float, float]:
    """Sampling frequency and, relative, what its increment's digits leave open.

    A usual frequency within that is meant.
    """
    step = _float(chosen.increment, path) * factor
    if not 0.0 < step < np.inf:
        return np.nan, 0.0
    digits = chosen.increment.upper().replace("D", "E").split("E")[0].lstrip("+-0.")
    error = 0.6 / float(digits.replace(".", ""))
    if error > _COARSEST_ROUNDING:
        return 1.0 / step, 0.0
    return usual_rate(1.0 / step, error) or 1.0 / step, error


def _unit(code: int, length: str | None) -> str | None:
    return f"{length}{_RATE_OF[code]}" if length and code in _RATE_OF else None


def _sets(content: mmap.mmap, path: str) -> tuple[list[_Set], str | None]:
    """All time responses, and the length unit that a data set 164 states."""
    found, length, at = [], None, 0
    while (marker := _marker(content, at)) is not None:
        kind, at = _line(content, marker[1])
        number = kind[:6].strip()
        if number == "58":
            one, at = _set(content, kind, at, path)
            if one is not None:
                found.append(one)
        elif number == "164":
            _, at = _line(content, at)
            factor = _float(_line(content, at)[0][:25], path)
            length = next((of for k, of in _LENGTHS.items() if abs(factor / k - 1) < 1e-4), None)
        marker = _marker(content, at)
        if marker is None:
            raise ValueError(f"a data set {number} has no end: cut off? ({path})")
        at = marker[1]
    return found, length


def _marker(content: mmap.mmap, at: int) -> tuple[int, int] | None:
    """Where the next marker (-1 alone in columns 1 to 6 of a line) and the line after it begin."""
    while (at := content.find(b"    -1", at)) >= 0:
        line, following = _line(content, at)
        if line.strip() == "-1":
            return at, following
        at += 1
    return None


def _line(content: mmap.mmap, at: int) -> tuple[str, int]:
    """A line without its end, and where the next one begins."""
    end = content.find(b"\n", at)
    end = len(content) if end < 0 else end
    return content[at : min(end, at + 200)].decode("latin-1").rstrip("\r"), end + 1


def _set(content: mmap.mmap, kind: str, at: int, path: str) -> tuple[_Set | None, int]:
    """Header of a data set 58, None if it is no real time response; and where its end is near."""
    lines = []
    for _ in range(11):
        line, at = _line(content, at)
        lines.append(line.ljust(80))
    dof, form, abscissa, ordinate = lines[5], lines[6], lines[7], lines[8]
    data_type, count, spacing = (_int(form[k : k + 10], path) for k in (0, 10, 20))
    binary = kind[6:7].lower() == "b"
    size = _int(kind[31:43], path) if binary else 0
    marker = _marker(content, at + size)
    if size < 0 or marker is None:
        raise ValueError(f"a data set 58 has no end: cut off? ({path})")
    end = at + size if binary else marker[0]
    if binary and content[end : marker[0]].strip():
        raise ValueError(f"a data set 58 does not end after its {size} bytes ({path})")
    time = _int(abscissa[:10], path) == _TIME_ABSCISSA or _int(dof[:5], path) == _TIME_RESPONSE
    if data_type not in (2, 4) or not time:
        return None, end
    if spacing not in (0, 1) or (binary and kind[7:13].strip() not in ("1", "2")):
        raise ValueError(f"expected spacing 0 or 1 and byte order 1 or 2, got {kind!r} ({path})")
    double = data_type == 4
    numbers = count if spacing == 1 else 2 * count
    if count < 0 or (binary and size != numbers * (8 if double else 4)):
        raise ValueError(f"{count} values do not fit the {size} bytes of the data set ({path})")
    direction = _int(dof[51:55], path)
    axis = f"{'-' if direction < 0 else '+'}{_AXES.get(abs(direction), abs(direction))}"
    label = ordinate[47:67].strip()
    order = ("<" if kind[7:13].strip() == "1" else ">") if binary else ""
    return _Set(
        name=f"{_int(dof[41:51], path)}:{axis}",
        code=_int(ordinate[:10], path),
        label=None if label.upper() in ("", "NONE") else label,
        count=count,
        double=double,
        even=spacing == 1,
        start_s=_float(form[30:43], path),
        increment=form[43:56].strip(),
        time_unit=(abscissa[47:67].strip().lower() or "none").replace("none", "s"),
        order=order,
        begin=at,
        end=end,
    ), end


def _values(content: mmap.mmap, one: _Set, path: str) -> np.ndarray:
    """Ordinates; or abscissas and ordinates by turns."""
    wanted = one.count if one.even else 2 * one.count
    if one.order:
        kind = f"{one.order}f{8 if one.double else 4}"
        return np.frombuffer(content[one.begin : one.end], kind)
    widths = ((20,) * 4 if one.even else (13, 20, 13, 20)) if one.double else (13,) * 6
    parts, at = [np.zeros(0)], one.begin
    full = content.find(b"\n", at) + 1 - at
    while at < one.end:
        stop = content.rfind(b"\n", at, min(at + _BLOCK_LINES * full, one.end)) + 1
        if stop <= at:
            raise ValueError(f"expected lines of {full} characters, got another ({path})")
        parts.append(_block(content[at:stop], full, widths, path))
        at = stop
    values = np.concatenate(parts)
    if values.size != wanted:
        raise ValueError(f"the header claims {wanted} numbers, got {values.size} ({path})")
    return values


def _block(text: bytes, full: int, widths: tuple[int, ...], path: str) -> np.ndarray:
    """Numbers of whole lines of equal length; the last one may be shorter."""
    text = text.replace(b"D", b"E")
    rows = len(text) // full
    rest = text[rows * full :].rstrip(b"\r\n")
    table = np.frombuffer(text[: rows * full], np.uint8).reshape(rows, full)
    ends = b"\r\n" if text[full - 2 : full] == b"\r\n" else b"\n"
    edges = np.concatenate([[0], np.cumsum(widths)])
    use = min(edges[-1], full - len(ends))
    good = (table[:, full - len(ends) :] == np.frombuffer(ends, np.uint8)).all()
    if not good or not _NUMBER_BYTES[table[:, : full - len(ends)]].all() or use not in edges:
        raise ValueError(f"expected lines of {len(widths)} numbers of equal width ({path})")
    try:
        columns = [
            np.ascontiguousarray(table[:, a:b]).view(f"S{b - a}")[:, 0].astype(float)
            for a, b in pairwise(edges)
            if b <= use
        ]
        last = [float(rest[a:b]) for a, b in pairwise(edges) if rest[a:b].strip()]
    except ValueError as error:
        raise ValueError(f"expected numbers, got: {error} ({path})") from error
    return np.concatenate([np.stack(columns, axis=1).reshape(-1), last])


def _int(text: str, path: str) -> int:
    try:
        return int(text.strip() or 0)
    except ValueError as error:
        raise ValueError(f"expected a whole number in a header, got {text!r} ({path})") from error


def _float(text: str, path: str) -> float:
    try:
        return float(text.strip().upper().replace("D", "E") or 0.0)
    except ValueError as error:
        raise ValueError(f"expected a number in a header, got {text!r} ({path})") from error
