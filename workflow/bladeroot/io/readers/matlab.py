"""MATLAB .mat of version 5 (scipy) and 7.3 (h5py). There is no convention, so names are looked for.

Time is a vector `time` or `t`, a rising first column or cell, or a number `fs` (`sampling_Hz`,
`dt`, ...) beside the samples or above them; likewise `unit`, `quantity`, `mode`, `force_N`. Siemens
Testlab's structs hold step and start in `x_values`, samples and unit in `y_values`.
"""

import struct
import zlib
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from bladeroot.hdf5_links import check_links
from bladeroot.io.channel import Channel, Entry, check_claim, pick, time_factor
from bladeroot.io.hdf5 import length_notes, try_first
from bladeroot.io.statements import one_time, statements
from bladeroot.io.units import seconds

SUFFIXES = (".mat",)
# What is larger or deeper than these is no record, and is passed over.
MOST_COLUMNS = 64  # of a matrix whose columns (or rows) are a channel each
_DEEPEST_NESTING = 8  # of structs and cells in each other
_MOST_ENTRIES = 20_000  # cells, structs or characters of an array
# The type with which a compressed variable of version 5 begins.
_COMPRESSED = 15


@dataclass(frozen=True)
class _Leaf:
    """A number, text or array: its name, and the struct, cell or array it stands in.

    The value is None for an object of a class, such as a timeseries: only MATLAB can read it.
    """

    name: str
    key: str
    group: str
    value: object


def read(path: str, channel: str | None = None, quantity: str | None = None) -> Channel:
    """Read one vector, column or cell: `v`, `run.laser`, `data(:,2)`, `xData{3,2}`, or a number."""
    with open(path, "rb") as file:
        head = file.read(520)
    new = head.startswith(b"\x89HDF") or head[512:516] == b"\x89HDF"
    if new:
        try_first(lambda: list(_version_73(path)), path)  # links, too
    leaves = list(_version_73(path) if new else _version_5(path))
    series = [leaf for leaf in leaves if isinstance(leaf.value, np.ndarray)]
    words = {leaf.name: leaf for leaf in leaves if isinstance(leaf.value, int | float | str)}
    objects = [leaf.name for leaf in leaves if leaf.value is None]
    if objects and (not series or channel in objects):
        raise ValueError(
            "expected vectors of numbers, got objects that only MATLAB reads: "
            f"{', '.join(objects)}; their times and data can be saved as variables ({path})"
        )
    entries = [
        Entry(k + 1, leaf.name, _unit(words, leaf), timelike=_timelike(leaf, path))
        for k, leaf in enumerate(series)
    ]
    entry = pick(entries, channel, quantity, path)
    leaf = series[entry.number - 1]
    times = {
        one.name: one.value * (time_factor(one.key, None, path) or 1.0)
        for one, other in zip(series, entries, strict=True)
        if other.timelike and _above(one.group, leaf.group) and one.value.size == leaf.value.size
    }
    above = [word for word in words.values() if _above(word.group, leaf.group)]
    above.sort(key=lambda word: len(word.group))
    step, start_s = _x_values(words, leaf)
    # ts is a step in MATLAB; elsewhere it may be a time of day
    steps = ("ts", "xvalues.increment")
    said = statements([*((word.key, word.value) for word in above), *step], path, steps)
    return Channel(
        name=entry.name,
        samples=leaf.value,
        unit=entry.unit,
        quantity=_near(words, leaf, ("quantity",)),
        time=one_time(times, path),
        sampling_Hz=said.sampling_Hz,
        sampling_error=said.sampling_error,
        start_s=start_s,
        facts=said.facts,
        notes=(*(length_notes(path) if new else ()), *said.notes),
    )


def _near(words: dict[str, _Leaf], leaf: _Leaf, keys: tuple[str, ...]) -> str | None:
    """The word of one of these names in the leaf's group, or else in the nearest above it."""
    found = [
        word
        for word in words.values()
        if word.key.lower() in keys and _above(word.group, leaf.group)
    ]
    return str(max(found, key=lambda word: len(word.group)).value) if found else None


def _unit(words: dict[str, _Leaf], leaf: _Leaf) -> str | None:
    """The unit of a series: its label in a struct `y_values`, or the nearest `unit`."""
    base, inside, _ = leaf.name.partition(".y_values.")
    label = words.get(f"{base}.y_values.quantity.label") if inside else None
    return str(label.value) if label else _near(words, leaf, ("unit", "units"))


def _x_values(words: dict[str, _Leaf], leaf: _Leaf) -> tuple[list[tuple[str, object]], float]:
    """The step, as the file states it, and the start (s) of the struct `x_values` beside a series.

    Neither where the series stands in no struct `y_values`.
    """
    base, inside, _ = leaf.name.partition(".y_values.")
    place = f"{base}.x_values"
    if not inside or f"{place}.increment" not in words:
        return [], 0.0
    label, start = words.get(f"{place}.quantity.label"), words.get(f"{place}.start_value")
    unit = str(label.value) if label else "s"
    start_s = float(start.value) * (seconds(unit) or 0.0) if start else 0.0
    return [(f"x_values.increment [{unit}]", words[f"{place}.increment"].value)], start_s


def _above(group: str, other: str) -> bool:
    """Whether a group is another one, or holds it."""
    inside = tuple(f"{group}{sign}" for sign in ".{(")
    return group in ("", other) or other.startswith(inside)


def _timelike(leaf: _Leaf, path: str) -> bool:
    """A vector called time; or a column or cell without a name that rises in equal steps."""
    if leaf.key[:1] not in "({":
        return time_factor(leaf.key, None, path) is not None
    steps = np.diff(leaf.value.astype(float))
    return bool((steps > 0.0).all() and steps.max() < 1.5 * steps.min())


def _arrays(name: str, key: str, group: str, value: np.ndarray) -> Iterator[_Leaf]:
    """A number, a vector, or the columns of a table of numbers."""
    if value.dtype.kind not in "iufb" or value.ndim > 2 or value.size == 0:
        return
    if value.size == 1:
        yield _Leaf(name, key, group, value.reshape(-1)[0].item())
    elif value.ndim == 1 or min(value.shape) == 1:
        yield _Leaf(name, key, group, value.reshape(-1))
    elif min(value.shape) <= MOST_COLUMNS:
        table = value if value.shape[0] >= value.shape[1] else value.T
        for k in range(table.shape[1]):
            place = f"(:,{k + 1})" if table is value else f"({k + 1},:)"
            yield _Leaf(f"{name}{place}", place, name, table[:, k])


def _rows(rows: Iterable[str]) -> str:
    """A matrix of characters as one text; several rows stay apart, so that they are no unit."""
    return "; ".join(filter(None, (row.strip() for row in rows)))


def _version_5(path: str) -> Iterator[_Leaf]:
    from scipy.io import loadmat

    check_claim(_unpacked(path), 1, path)
    variables = loadmat(path, simplify_cells=False, chars_as_strings=True)
    for name, value in variables.items():
        if not name.startswith("__"):
            yield from _walk(name, name, "", value, 0)


def _unpacked(path: str) -> int:
    """Bytes that the compressed variables of a version 5 file say that they hold."""
    claimed = 0
    with open(path, "rb") as file:
        head = file.read(128)
        order = ">" if head[126:128] == b"MI" else "<"
        while len(tag := file.read(8)) == 8:
            kind, size = struct.unpack(f"{order}II", tag)
            if kind == _COMPRESSED:
                with suppress(zlib.error, struct.error):
                    inner = zlib.decompressobj().decompress(file.read(min(size, 64)), 8)
                    claimed += struct.unpack(f"{order}II", inner)[1]
                    size -= min(size, 64)
            file.seek(size, 1)
    return claimed


def _walk(name: str, key: str, group: str, value: object, depth: int) -> Iterator[_Leaf]:
    """The leaves below a variable of a version 5 file."""
    from scipy.io.matlab import MatlabOpaque

    if depth > _DEEPEST_NESTING or not isinstance(value, np.ndarray):
        return
    if isinstance(value, MatlabOpaque):  # has the variable's name inside
        yield _Leaf(value["s0"].flat[0].decode(), key, group, None)
    elif value.dtype.names:
        for place in np.ndindex(value.shape):
            own = name if value.size == 1 else f"{name}({','.join(str(k + 1) for k in place)})"
            for field in value.dtype.names:
                yield from _walk(f"{own}.{field}", field, own, value[place][field], depth + 1)
    elif value.dtype.kind == "O":
        for place in np.ndindex(value.shape):
            cell = "{" + ",".join(str(k + 1) for k in place) + "}"
            row = f"{name}{{{place[0] + 1}" if len(place) > 1 else name
            yield from _walk(f"{name}{cell}", cell, row, value[place], depth + 1)
    elif value.dtype.kind == "U":
        yield _Leaf(name, key, group, _rows(map(str, value.reshape(-1))))
    else:
        yield from _arrays(name, key, group, value)


def _version_73(path: str) -> Iterator[_Leaf]:
    import h5py

    check_links(path)
    with h5py.File(path) as file:
        for name, item in file.items():
            if not name.startswith("#"):
                yield from _walk_73(name, name, "", item, 0, file, path)


def _walk_73(name, key, group, item, depth, file, path) -> Iterator[_Leaf]:
    """The leaves below a variable of a version 7.3 file: groups are structs, references cells."""
    import h5py

    if depth > _DEEPEST_NESTING:
        return
    if isinstance(item, h5py.Group):
        for field, part in item.items():
            for own, cell in _cells(name, part, file):
                yield from _walk_73(f"{own}.{field}", field, own, cell, depth + 1, file, path)
        return
    if not isinstance(item, h5py.Dataset) or item.shape is None:
        return
    if item.dtype.kind == "O":
        if item.size > _MOST_ENTRIES:
            return
        # the axes of a 7.3 file stand in the other order
        for place in np.ndindex(item.shape[::-1]):
            cell = "{" + ",".join(str(k + 1) for k in place) + "}"
            row = f"{name}{{{place[0] + 1}" if len(place) > 1 else name
            part = file[item[place[::-1]]]
            yield from _walk_73(f"{name}{cell}", cell, row, part, depth + 1, file, path)
        return
    if "MATLAB_object_decode" in item.attrs:
        yield _Leaf(name, key, group, None)
        return
    if item.attrs.get("MATLAB_empty", 0):  # what it holds are an empty array's dimensions
        return
    check_claim(item.size, item.dtype.itemsize, path)
    value = np.asarray(item[()]).T
    if item.attrs.get("MATLAB_class") == b"char":
        if value.size <= _MOST_ENTRIES:
            rows = np.atleast_2d(value)
            yield _Leaf(name, key, group, _rows("".join(map(chr, row)) for row in rows))
    else:
        yield from _arrays(name, key, group, value)


def _cells(name: str, part, file) -> Iterator[tuple[str, object]]:
    """Name of a struct and what one of its fields holds; each struct of an array of structs.

    The field of such an array refers to its values, and unlike a cell array has no class.
    """
    refers = getattr(part, "dtype", None) is not None and part.dtype.kind == "O" and part.shape
    if not refers or "MATLAB_class" in part.attrs or part.size > _MOST_ENTRIES:
        yield name, part
        return
    for place in np.ndindex(part.shape[::-1]):
        yield f"{name}({','.join(str(k + 1) for k in place)})", file[part[place[::-1]]]
