"""NetCDF: `time` (s) and `velocity`, `displacement` or `acceleration`, packed or not."""

import numpy as np

from bladeroot.records.channel import Channel, Entry, check_claim, pick, stated, time_factor
from bladeroot.records.hdf5 import length_notes, try_first
from bladeroot.records.units import SI

SUFFIXES = (".nc", ".nc4", ".cdf")


def read(path: str, channel: str | None = None, quantity: str | None = None) -> Channel:
    """Read one variable; scale_factor and add_offset are applied, fill values refused.

    `channel` names the variable; its `units` hold, SI where it is called after its quantity and
    has none. Time is a variable `time` of the same length, or the attribute `sampling_Hz`.
    """
    with open(path, "rb") as raw:
        classic = raw.read(3) == b"CDF"
    if classic:
        _check_whole(path)
    else:
        try_first(lambda: _read(path, channel, quantity), path)
    return _read(path, channel, quantity)


def _read(path: str, channel: str | None, quantity: str | None) -> Channel:
    import netCDF4

    try:
        file = netCDF4.Dataset(path)
    except OSError as error:
        raise ValueError(f"expected a NetCDF file, got: {error} ({path})") from error
    with file:
        series = [one for one in file.variables.values() if _is_series(one)]
        factors = [time_factor(one.name, _unit(one)) for one in series]
        entries = [
            Entry(k + 1, one.name, _unit(one), timelike=factors[k] is not None)
            for k, one in enumerate(series)
        ]
        entry = pick(entries, channel, quantity, path)
        wanted = series[entry.number - 1]
        words = {name: file.getncattr(name) for name in file.ncattrs()}
        words |= {name: wanted.getncattr(name) for name in wanted.ncattrs()}
        samples = _values(wanted, path)
        time = None
        for one, factor in zip(series, factors, strict=True):
            if factor is not None and one.size == wanted.size and time is None:
                time = _values(one, path) * factor
        rate = words.get("sampling_Hz")
        return Channel(
            name=entry.name,
            samples=samples,
            unit=entry.unit or SI.get(entry.name),
            time=time,
            sampling_Hz=None if rate is None else float(rate),
            facts=stated(words),
            notes=length_notes(path),
        )


def _is_series(variable) -> bool:
    """Numbers along one dimension; lengths of one beside it do not matter."""
    kind = getattr(variable.dtype, "kind", "")
    return kind in "iuf" and variable.size > 1 and variable.size == max(variable.shape, default=0)


def _unit(variable) -> str | None:
    """Units of a variable; of a time only the unit itself (`seconds since ...`)."""
    return str(variable.units).split(" since")[0] if "units" in variable.ncattrs() else None


def _values(variable, path: str) -> np.ndarray:
    """All numbers of a variable, fill values as NaN."""
    check_claim(variable.size, variable.dtype.itemsize, path)
    try:
        values = np.ma.asarray(variable[:])
    except (OSError, RuntimeError) as error:
        raise ValueError(
            f"expected whole data in {variable.name}, got: {error} ({path})"
        ) from error
    if np.ma.is_masked(values):
        values = np.ma.filled(values.astype(float), np.nan)
    return np.ma.getdata(values).ravel()


def _check_whole(path: str) -> None:
    """Refuse a classic file that is cut off: the library would read zeros for what is missing."""
    from scipy.io import netcdf_file

    try:
        netcdf_file(path, mmap=False).close()
    except Exception as error:
        text = " ".join(str(error).split())
        raise ValueError(f"expected a whole NetCDF file, got: {text} ({path})") from error
