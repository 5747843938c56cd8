"""MATLAB .mat of version 5 (scipy) and 7.3 (h5py). There is no convention, so names are looked for.

Time is a vector `time` or `t`, a rising first column or cell, or a number `fs` (`sampling_Hz`,
`dt`, ...) beside the samples or above them; likewise `unit`, `quantity`, `mode`, `force_N`.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bladeroot.records.channel import Channel, Entry, check_claim, pick, stated, time_factor
from bladeroot.records.hdf5 import length_notes, try_first

SUFFIXES = (".mat",)
RATES = ("sampling_hz", "fs", "fsample", "samplerate", "sample_rate", "samplingrate",
         "sampling_rate", "f_s", "sampling_frequency")  # fmt: skip
STEPS = ("dt", "ts", "delta_t", "t_s", "time_step")
MOST_COLUMNS = 64
# Variables nested deeper, or more of them, are no record.
_DEEPEST, _MOST = 8, 20_000


@dataclass(frozen=True)
class _Leaf:
    """A number, text or array: its name, and the struct, cell or array it stands in."""

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
        try_first(lambda: list(_version_73(path)), path)
    leaves = list(_version_73(path) if new else _version_5(path))
    series = [leaf for leaf in leaves if isinstance(leaf.value, np.ndarray)]
    words = {leaf.name: leaf for leaf in leaves if not isinstance(leaf.value, np.ndarray)}
    entries = [
        Entry(k + 1, leaf.name, _near(words, leaf, ("unit", "units")), timelike=_timelike(leaf))
        for k, leaf in enumerate(series)
    ]
    entry = pick(entries, channel, quantity, path)
    leaf = series[entry.number - 1]
    times = [
        one
        for one, other in zip(series, entries, strict=True)
        if other.timelike and _above(one.group, leaf.group) and one.value.size == leaf.value.size
    ]
    time, rate = None, _number(_near(words, leaf, RATES), path)
    if times:
        nearest = max(times, key=lambda one: len(one.group))
        time = nearest.value * (time_factor(nearest.key) or 1.0)
    elif rate is None and (step := _number(_near(words, leaf, STEPS), path)):
        rate = 1.0 / step
    near = {key: _near(words, leaf, (key,)) for key in ("mode", "force_n", "axial_force_n")}
    return Channel(
        name=entry.name,
        samples=leaf.value,
        unit=entry.unit,
        quantity=_near(words, leaf, ("quantity",)),
        time=time,
        sampling_Hz=rate,
        facts=stated({key: value for key, value in near.items() if value is not None}),
        notes=length_notes(path) if new else (),
    )


def _near(words: dict[str, _Leaf], leaf: _Leaf, keys: tuple[str, ...]) -> str | None:
    """The word of one of these names in the leaf's group, or else in the nearest above it."""
    found = [
        word
        for word in words.values()
        if word.key.lower() in keys and _above(word.group, leaf.group)
    ]
    return str(max(found, key=lambda word: len(word.group)).value) if found else None


def _number(text: str | None, path: str) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError as error:
        raise ValueError(f"expected a sampling frequency, got {text!r} ({path})") from error


def _above(group: str, other: str) -> bool:
    """Whether a group is another one, or holds it."""
    inside = tuple(f"{group}{sign}" for sign in ".{(")
    return group in ("", other) or other.startswith(inside)


def _timelike(leaf: _Leaf) -> bool:
    """A vector called time; or a column or cell without a name that rises in equal steps."""
    if leaf.key[:1] not in "({":
        return time_factor(leaf.key) is not None
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


def _version_5(path: str) -> Iterator[_Leaf]:
    from scipy.io import loadmat

    variables = loadmat(path, simplify_cells=False, chars_as_strings=True)
    for name, value in variables.items():
        if not name.startswith("__"):
            yield from _walk(name, name, "", value, 0)


def _walk(name: str, key: str, group: str, value: object, depth: int) -> Iterator[_Leaf]:
    """The leaves below a variable of a version 5 file."""
    if depth > _DEEPEST or not isinstance(value, np.ndarray):
        return
    if value.dtype.names:
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
        yield _Leaf(name, key, group, "".join(map(str, value.reshape(-1))).strip())
    else:
        yield from _arrays(name, key, group, value)


def _version_73(path: str) -> Iterator[_Leaf]:
    import h5py

    with h5py.File(path) as file:
        for name, item in file.items():
            if not name.startswith("#"):
                yield from _walk_73(name, name, "", item, 0, file, path)


def _walk_73(name, key, group, item, depth, file, path) -> Iterator[_Leaf]:
    """The leaves below a variable of a version 7.3 file: groups are structs, references cells."""
    import h5py

    if depth > _DEEPEST:
        return
    if isinstance(item, h5py.Group):
        for field, part in item.items():
            yield from _walk_73(f"{name}.{field}", field, name, part, depth + 1, file, path)
        return
    if not isinstance(item, h5py.Dataset) or item.shape is None:
        return
    if item.dtype.kind == "O":
        if item.size > _MOST:
            return
        # the axes of a 7.3 file stand in the other order
        for place in np.ndindex(item.shape[::-1]):
            cell = "{" + ",".join(str(k + 1) for k in place) + "}"
            row = f"{name}{{{place[0] + 1}" if len(place) > 1 else name
            part = file[item[place[::-1]]]
            yield from _walk_73(f"{name}{cell}", cell, row, part, depth + 1, file, path)
        return
    check_claim(item.size, item.dtype.itemsize, path)
    value = np.asarray(item[()]).T
    if item.attrs.get("MATLAB_class") == b"char":
        if value.size <= _MOST:
            yield _Leaf(name, key, group, "".join(map(chr, value.T.reshape(-1))).strip())
    else:
        yield from _arrays(name, key, group, value)
