"""Opening and saving the artifacts of the stages: the one place that touches result files.

An artifact is one xarray Dataset in one NetCDF file, written whole or not at all
(`bladeroot/files.py`). At its end stands a checksum, which `load` checks. A verdict (JSON) carries
its own as `checksum`.
"""

import hashlib
import json
import shlex
from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

import netCDF4
import numpy as np
import xarray as xr

from bladeroot import __version__, checksum
from bladeroot.files import reason, save_text, whole_file
from bladeroot.provenance import environment

# Of names, units and dimensions of all artifacts (docs/artifacts.md); the number rises with a
# change that a reader of an older one would stumble over.
SCHEMA = "bladeroot-artifact-1"


def load(path: str | Path, without: Sequence[str] = ()) -> xr.Dataset:
    """Read an artifact into memory, whole or without some variables, and close its file.

    without: names of variables that are left out, or patterns of them as `pff_*`.

    Raises ValueError, one line that names the file and the command that makes it again, when it is
    missing, empty, cut off or altered.
    """
    try:
        fault = checksum.fault(path)
    except OSError as error:
        raise ValueError(f"{path}: {reason(error)}; {_again(path)}") from error
    if fault:
        raise ValueError(f"{path} {fault}; {_again(path)}")
    return _read(path, tuple(without))


def _read(path: str | Path, without: tuple[str, ...]) -> xr.Dataset:
    """What `open_dataset` reads, without its machinery for parts of files."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)  # `decode_cf_variables` does that
        raw = {
            name: _variable(one)
            for name, one in file.variables.items()
            if not any(fnmatchcase(name, left_out) for left_out in without)
        }
        attrs = {name: file.getncattr(name) for name in file.ncattrs()}
    # artifacts hold no dates, and their texts are whole
    variables, attrs, coordinates = xr.conventions.decode_cf_variables(
        raw, attrs, concat_characters=False, decode_times=False, decode_timedelta=False
    )
    return xr.Dataset(variables, attrs=attrs).set_coords(coordinates & variables.keys())


def _variable(stored: netCDF4.Variable) -> xr.Variable:
    values = stored[...]
    if stored.dtype is str:
        values = np.asarray(values).astype(str)
    return xr.Variable(
        stored.dimensions, values, {a: stored.getncattr(a) for a in stored.ncattrs()}
    )


def _again(path: str | Path) -> str:
    return (
        f"`snakemake -j2 --force {shlex.quote(str(path))}` (with the run's --config) makes it again"
    )


def load_records(
    batches: Iterable[str | Path], stage: str, without: Sequence[str] = ()
) -> list[xr.Dataset]:
    """The artifacts of one stage (records, decay, plateau) of all records, in the order of names.

    batches: files of a campaign's folder `batches` with a record's name a line.
    without: as of `load`; the samples of thousands of records fill a memory, and each variable
    takes its time.
    """
    places = [
        (name, Path(batch).parents[1] / stage / f"{name}.nc")
        for batch in batches
        for name in Path(batch).read_text(encoding="utf-8").split()
    ]
    return [load(place, without) for _, place in sorted(places)]


def save(
    dataset: xr.Dataset,
    path: str | Path,
    *,
    origin: xr.Dataset | None = None,
    settings: str = "{}",
) -> None:
    """Write a Dataset with its provenance in the global attributes.

    `origin` is the artifact that it was made from: its campaign, and whether that is simulated,
    carry over; without one the dataset's own attributes say so. `settings` is the canonical JSON
    text (see `bladeroot.provenance`) of the settings that made it; `environment`, which is added,
    names the versions of what computes. Raises ValueError, one line,
    where it cannot be written.
    """
    source = {"campaign": "", "simulated": 0} | (dataset if origin is None else origin).attrs
    stamped = dataset.assign_attrs(
        campaign=source["campaign"],
        simulated=source["simulated"],
        schema=SCHEMA,
        bladeroot_version=__version__,
        environment=environment(),
        settings=settings,
    )
    with whole_file(path) as part:
        try:
            _write(stamped, part)
        except RuntimeError as error:  # HDF5 does not say that the disk is full
            raise OSError(None, f"the NetCDF library says {error}; is the disk full?") from error
        checksum.seal(part)


def _write(dataset: xr.Dataset, path: Path) -> None:
    """A Dataset as `to_netcdf` writes it, in less than half of its time.

    xarray writes each variable as soon as it is declared, and the library then goes through all
    metadata once a variable: here all are declared before the first is written.
    """
    variables, attrs = xr.conventions.encode_dataset_coordinates(dataset)
    variables, attrs = xr.conventions.cf_encoder(variables, attrs)
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(attrs)
        for name, size in dataset.sizes.items():
            file.createDimension(name, size)
        for name, one in variables.items():
            fill = one.attrs.pop("_FillValue", None)
            kind = str if one.dtype.kind in "UO" else one.dtype
            file.createVariable(name, kind, one.dims, fill_value=fill).setncatts(one.attrs)
        file.set_auto_maskandscale(False)  # packed by `cf_encoder` where that is asked for
        for name, one in variables.items():
            text = one.dtype.kind in "UO"
            file[name][...] = one.values.astype(object) if text else one.values


def save_json(document: dict, path: str | Path) -> None:
    """Write a document (no NaN) with its checksum, for `load_json`."""
    save_text(json.dumps(_summed(document), indent=2, allow_nan=False) + "\n", path)


def load_json(path: str | Path) -> dict:
    """Read a document of `save_json`, without its checksum. Raises ValueError as `load`."""
    try:
        document = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"{path}: {reason(error)}; {_again(path)}") from error
    except ValueError as error:
        fault = "is cut off or damaged" if Path(path).stat().st_size else "is empty"
        raise ValueError(f"{path} {fault}; {_again(path)}") from error
    if not isinstance(document, dict) or _summed(document) != document:
        raise ValueError(
            f"{path} was altered after it was written: its checksum does not match; {_again(path)}"
        )
    document.pop("checksum")
    return document


def _summed(document: dict) -> dict:
    """The document with the checksum of all else in it."""
    bare = {key: value for key, value in document.items() if key != "checksum"}
    text = json.dumps(bare, sort_keys=True, separators=(",", ":"))
    return bare | {"checksum": hashlib.sha256(text.encode()).hexdigest()}
