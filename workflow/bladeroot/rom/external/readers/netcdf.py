"""NetCDF: a variable `K` of two dimensions, or triplets `K_row`, `K_column`, `K_value`."""

import numpy as np
import scipy.sparse as sp

from bladeroot.hdf5_links import check_links
from bladeroot.rom.external.reading import choose

SUFFIXES = (".nc", ".nc4", ".cdf")


def read(path: str, variable: str | None = None) -> sp.coo_array:
    """One matrix of the file, which may be left out where there is only one.

    Indices count from 0, or from the attribute `start_index` of `K_row` and `K_column`. The
    attribute `size` of `K_value` may give the number of rows where the last ones are empty.
    """
    import netCDF4

    check_links(path)
    with netCDF4.Dataset(path) as file:
        full = [name for name, item in file.variables.items() if item.ndim == 2]
        triplets = [
            name.removesuffix("_value")
            for name in file.variables
            if name.endswith("_value") and _third(name, "row") in file.variables
        ]
        name = choose([*full, *triplets], variable, path)
        for part in [name] if name in full else [f"{name}_value"]:
            _check_attributes(file[part], path)
        if name in full:
            return sp.coo_array(np.ma.filled(file[name][:].astype(float), np.nan))
        values = np.ma.filled(file[f"{name}_value"][:].astype(float), np.nan)
        index = []
        for part in ("row", "column"):
            item = file[f"{name}_{part}"]
            first = int(item.start_index) if "start_index" in item.ncattrs() else 0
            index.append(np.asarray(item[:]).astype(np.int64) - first)
        size = int(max(part.max(initial=-1) for part in index)) + 1
        if "size" in file[f"{name}_value"].ncattrs():
            size = int(file[f"{name}_value"].getncattr("size"))
    return sp.coo_array((values, tuple(index)), shape=(size, size))


def _check_attributes(item, path: str) -> None:
    """Refuse a scale or offset that is not a number: the library would leave it out."""
    for name in ("scale_factor", "add_offset"):
        if name in item.ncattrs() and np.asarray(item.getncattr(name)).dtype.kind not in "iuf":
            raise ValueError(
                f"expected {name} of {item.name} to be a number, got "
                f"{str(item.getncattr(name))[:60]!r} ({path})"
            )


def _third(name: str, part: str) -> str:
    return f"{name.removesuffix('_value')}_{part}"
