"""Opening and saving the artifacts of the stages: the one place that touches result files.

An artifact is one xarray Dataset in one NetCDF file. It is written to a temporary name beside
its place and moved there whole, so that a killed run never leaves half a file under a real name.
"""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import xarray as xr

from bladeroot import __version__


def load(path: str | Path) -> xr.Dataset:
    """Read a whole artifact into memory and close its file."""
    with xr.open_dataset(path, engine="netcdf4") as dataset:
        return dataset.load()


def load_records(batches: Iterable[str | Path], stage: str) -> list[xr.Dataset]:
    """The artifacts of one stage (records, decay, plateau) of all records, in the order of names.

    batches: files of a campaign's folder `batches` with a record's name a line.
    """
    places = [
        (name, Path(batch).parents[1] / stage / f"{name}.nc")
        for batch in batches
        for name in Path(batch).read_text(encoding="utf-8").split()
    ]
    return [load(place) for _, place in sorted(places)]


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
    text (see `bladeroot.provenance`) of the settings that made it.
    """
    source = {"campaign": "", "simulated": 0} | (dataset if origin is None else origin).attrs
    stamped = dataset.assign_attrs(
        campaign=source["campaign"],
        simulated=source["simulated"],
        bladeroot_version=__version__,
        settings=settings,
    )
    with whole_file(path) as part:
        stamped.to_netcdf(part, engine="netcdf4")


def save_text(text: str, path: str | Path) -> None:
    """Write a text file (report, table) whole or not at all."""
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """A temporary name beside `path`, moved there when all has been written, else removed."""
    whole = Path(path)
    whole.parent.mkdir(parents=True, exist_ok=True)
    part = whole.with_name(f".{whole.name}.{os.getpid()}.part")
    try:
        yield part
        os.replace(part, whole)
    finally:
        part.unlink(missing_ok=True)
