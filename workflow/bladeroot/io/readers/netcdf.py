"""NetCDF: `time` (s) and `velocity`, `displacement` or `acceleration`, packed or not."""

from collections.abc import Iterator

import numpy as np

from bladeroot.hdf5_links import check_links
from bladeroot.io.channel import Channel, Entry, check_claim, pick, time_factor
from bladeroot.io.hdf5 import length_notes, try_first
from bladeroot.io.statements import one_time, statements
from bladeroot.io.units import quantity_of

SUFFIXES = (".nc", ".nc4", ".cdf")
_INVALID = {"_FillValue", "missing_value", "valid_range", "valid_min", "valid_max"}
# Attributes that the library leaves out without a word where they are no numbers.
_NUMBERS = ("scale_factor", "add_offset", *sorted(_INVALID))


def read(path: str, channel: str | None = None, quantity: str | None = None) -> Channel:
    """Read one variable; scale_factor and add_offset are applied, fill values refused.

    `channel` names the variable, in a group `group/variable`. Time is a variable `time` of the
    same length in its group or above it, or an attribute such as `sampling_Hz`.
    """
    with open(path, "rb") as raw:
        classic = raw.read(3) == b"CDF"
    if classic:
        _check_whole(path)
    else:
        try_first(lambda: _checked(path, channel, quantity), path)
        return _checked(path, channel, quantity)
    return _read(path, channel, quantity)


def _checked(path: str, channel: str | None, quantity: str | None) -> Channel:
    check_links(path)
    return _read(path, channel, quantity)


def _read(path: str, channel: str | None, quantity: str | None) -> Channel:
    import netCDF4

    try:
        file = netCDF4.Dataset(path)
    except OSError as error:
        raise ValueError(f"expected a NetCDF file, got: {error} ({path})") from error
    with file:
        series = [one for group in _groups(file) for one in group.variables.values()]
        series = [one for one in series if _is_series(one)]
        factors = [time_factor(one.name, _unit(one), path) for one in series]
        entries = [
            Entry(
                k + 1,
                _name(one),
                _unit(one),
                quantity_of(one.name, _unit(one)),
                factors[k] is not None,
            )
            for k, one in enumerate(series)
        ]
        entry = pick(entries, channel, quantity, path)
        wanted = series[entry.number - 1]
        above = [wanted.group()]
        while above[0].parent is not None:
            above.insert(0, above[0].parent)
        words = [(name, one.getncattr(name)) for one in (*above, wanted) for name in one.ncattrs()]
        said = statements(words, path)
        times = {
            _name(one): _values(one, path) * factor
            for one, factor in zip(series, factors, strict=True)
            if factor is not None and one.size == wanted.size and one.group() in above
        }
        return Channel(
            name=entry.name,
            samples=_values(wanted, path),
            unit=entry.unit,
            time=one_time(times, path),
            sampling_Hz=said.sampling_Hz,
            sampling_error=said.sampling_error,
            facts=said.facts,
            notes=(*length_notes(path), *said.notes),
        )


def _groups(group) -> Iterator:
    """A group and all below it."""
    yield group
    for part in group.groups.values():
        yield from _groups(part)


def _name(variable) -> str:
    """`velocity`, or in a group `run/velocity`."""
    return f"{variable.group().path}/{variable.name}".lstrip("/")


def _is_series(variable) -> bool:
    """Numbers along one dimension; lengths of one beside it do not matter."""
    kind = getattr(variable.dtype, "kind", "")
    return kind in "iuf" and variable.size > 1 and variable.size == max(variable.shape, default=0)


def _unit(variable) -> str | None:
    """Units of a variable; of a time only the unit itself (`seconds since ...`)."""
    return str(variable.units).split(" since")[0] if "units" in variable.ncattrs() else None


def _values(variable, path: str) -> np.ndarray:
    """All numbers of a variable, fill values as NaN.

    The library takes -32767 for one where a file of whole numbers declares none, but there it is a
    clipped sample.
    """
    check_claim(variable.size, variable.dtype.itemsize, path)
    _check_attributes(variable, path)
    declared = not _INVALID.isdisjoint(variable.ncattrs())
    variable.set_auto_mask(declared or variable.dtype.kind == "f")
    try:
        values = np.ma.asarray(variable[:])
    except (OSError, RuntimeError) as error:
        raise ValueError(
            f"expected whole data in {variable.name}, got: {error} ({path})"
        ) from error
    if np.ma.is_masked(values):
        values = np.ma.filled(values.astype(float), np.nan)
    return np.ma.getdata(values).ravel()


def _check_attributes(variable, path: str) -> None:
    """Refuse a scale, offset or fill value that is no number: it would not be applied.

    Raises:
        ValueError: names the attribute.
    """
    for name in _NUMBERS:
        if name not in variable.ncattrs():
            continue
        given = variable.getncattr(name)
        values = np.asarray(given)
        numbers = values.dtype.kind in "iuf"
        if numbers and name in ("scale_factor", "add_offset"):
            numbers = values.size == 1 and bool(np.isfinite(values).all())
        if not numbers:
            raise ValueError(
                f"expected {name} of {variable.name} to be a number, got {str(given)[:60]!r} "
                f"({path})"
            )


def _check_whole(path: str) -> None:
    """Refuse a classic file that is cut off: the library would read zeros for what is missing."""
    from scipy.io import netcdf_file

    try:
        netcdf_file(path, mmap=False).close()
    except Exception as error:
        text = " ".join(str(error).split())
        raise ValueError(f"expected a whole NetCDF file, got: {text} ({path})") from error
