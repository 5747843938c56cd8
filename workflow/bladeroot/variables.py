"""Output variables: dims, unit, meaning and source of each stand in its room's `variables.csv`.

A table of that file is what one function makes, named `room/table`; rows without a table are
coordinates that several tables share.
"""

import csv
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import xarray as xr

_LIBRARY = Path(__file__).parent


@cache
def registered(table: str) -> dict[str, tuple[tuple[str, ...], dict[str, str]]]:
    """Dims and attributes of the variables of a table, by name."""
    room, _, name = table.partition("/")
    with (_LIBRARY / room / "variables.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["table"] in (name, "")]
    made = {}
    for row in rows:
        attrs = {key: row[key] for key in ("units", "long_name", "source")}
        attrs = {key: text for key, text in attrs.items() if text or key != "source"}
        made[row["variable"]] = (tuple(row["dims"].split()), attrs)
    return made


@cache
def names(table: str) -> tuple[str, ...]:
    """Names of a table's own variables, in their order."""
    room, _, name = table.partition("/")
    with (_LIBRARY / room / "variables.csv").open(encoding="utf-8", newline="") as file:
        return tuple(row["variable"] for row in csv.DictReader(file) if row["table"] == name)


def dataset(table: str, values: Mapping[str, object]) -> xr.Dataset:
    """Values by name as a Dataset; a KeyError names what the table has no row for."""
    known = registered(table)
    missing = sorted(set(values) - set(known))
    if missing:
        raise KeyError(f"no row for {', '.join(missing)} in table {table} of variables.csv")
    made = {name: (known[name][0], value, dict(known[name][1])) for name, value in values.items()}
    return xr.Dataset(made)
