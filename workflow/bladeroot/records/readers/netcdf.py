"""NetCDF: `time` (s) and `velocity`, `displacement` or `acceleration`, packed or not."""

import numpy as np

from bladeroot.records.recording import SI, Recording, recording

SUFFIXES = (".nc", ".nc4", ".cdf")
TIME_UNITS = {"s": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6}


def read(
    path: str,
    quantity: str | None = None,
    unit: str | None = None,
    channel: str | None = None,
    sampling_Hz: float | None = None,
) -> Recording:
    """Read one motion variable; scale_factor and add_offset are applied, fill values refused.

    `channel` names the variable; without it the one called after its quantity is taken. The
    variable's own `units` hold unless `unit` is given.
    """
    import netCDF4

    try:
        file = netCDF4.Dataset(path)
    except OSError as error:
        raise ValueError(f"expected a NetCDF file, got: {error} ({path})") from error
    with file:
        names = list(file.variables)
        wanted = [channel] if channel else ([quantity] if quantity else list(SI))
        found = [name for name in wanted if name in names]
        if not found:
            raise ValueError(
                f"expected a variable {' or '.join(wanted)}, got {', '.join(names)} ({path})"
            )
        if len(found) > 1:
            raise ValueError(
                f"expected one of {', '.join(SI)}, got {', '.join(found)}: name one as channel "
                f"or quantity ({path})"
            )
        name = found[0]
        samples = _values(file.variables[name], path)
        own = getattr(file.variables[name], "units", None) or SI.get(name)
        time = None
        if "time" in names:
            time = _values(file.variables["time"], path) * _seconds(file.variables["time"], path)
            if samples.ndim == 1 and time.shape != samples.shape and sampling_Hz is not None:
                time = None
        if unit is None and own is None:
            raise ValueError(f"expected units on variable {name} or a unit given ({path})")
    return recording(
        samples.squeeze(), unit or own, f"{path}, variable {name}", time, sampling_Hz, quantity
    )


def _values(variable, path: str) -> np.ndarray:
    """All numbers of a variable, fill values as NaN."""
    try:
        return np.ma.filled(np.ma.asarray(variable[:], dtype=float), np.nan)
    except (OSError, RuntimeError) as error:
        raise ValueError(
            f"expected whole data in {variable.name}, got: {error} ({path})"
        ) from error


def _seconds(variable, path: str) -> float:
    unit = str(getattr(variable, "units", "s"))
    if unit not in TIME_UNITS:
        raise ValueError(f"units of time must be {', '.join(TIME_UNITS)}, got {unit!r} ({path})")
    return TIME_UNITS[unit]
