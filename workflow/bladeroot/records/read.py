"""Read a raw record: the reader is chosen by the file's suffix."""

import importlib
import pkgutil
from functools import cache
from pathlib import Path

from bladeroot.records import readers
from bladeroot.records.recording import Recording


@cache
def formats() -> dict[str, str]:
    """Module of every known suffix; a new file in `readers` is found by itself."""
    known = {}
    for module in pkgutil.iter_modules(readers.__path__):
        name = f"{readers.__name__}.{module.name}"
        known.update(dict.fromkeys(importlib.import_module(name).SUFFIXES, name))
    return known


def read(
    path: str | Path,
    quantity: str | None = None,
    unit: str | None = None,
    channel: str | None = None,
    sampling_Hz: float | None = None,
) -> Recording:
    """One record in SI units.

    Args:
        path: the raw file.
        quantity: velocity, displacement or acceleration; by default what the file says.
        unit: unit of the file's numbers; by default what the file says.
        channel: column or variable, where the file holds several.
        sampling_Hz: for files without a time column.

    Raises:
        ValueError: no such file, an unknown suffix, or anything wrong in the file, in one line.
    """
    path = Path(path)
    known = formats()
    if path.suffix.lower() not in known:
        raise ValueError(
            f"expected a file ending in {', '.join(sorted(known))}, got {path.suffix!r} ({path})"
        )
    if not path.is_file():
        raise ValueError(f"expected a record file, got none at {path}")
    reader = importlib.import_module(known[path.suffix.lower()])
    return reader.read(str(path), quantity, unit, channel, sampling_Hz)
