"""Write `variables.csv`: what each kind of artifact holds, read from the results of a finished run.

    python docs/list_variables.py results

The page of artifacts is made from it (`reference.py`).
"""

import csv
import re
import sys
from pathlib import Path

import xarray as xr

PLACE = Path(__file__).with_name("variables.csv")
COLUMNS = ("artifact", "variable", "dims", "units", "meaning", "source")
# Parts of a path that are names of a campaign, a structure, a record or a force.
_NAMES = (
    (r"^structures/[^/]+/", "structures/<structure>/"),
    (r"^bench/[^/]+/", "bench/<campaign>/"),
    (r"^(?!structures/|bench/)[^/]+/", "<campaign>/"),
    (r"/(assembly|map)/[0-9]+\.nc$", r"/\1/<force>.nc"),
    (r"/stiffness/[^/]+/[0-9]+\.nc$", "/stiffness/<structure>/<force>.nc"),
    (r"/(records|decay|plateau|truth)/[^/]+\.nc$", r"/\1/<record>.nc"),
    (r"^bench/<campaign>/[^/]+\.nc$", "bench/<campaign>/<record>.nc"),
    (r"/(joint|amplitude|diagnosis|thesis_search|nonlinear)/[^/]+\.nc$", r"/\1/<structure>.nc"),
    (r"/extended/[^/]+/", "/extended/<structure>/"),
)


def kind(path: str) -> str:
    """The kind of an artifact by its path below `results`, such as `<campaign>/stick.nc`."""
    for pattern, name in _NAMES:
        path = re.sub(pattern, name, path)
    return path


def variables(results: Path) -> list[list[str]]:
    """Rows of `COLUMNS`, one for every variable of every kind of artifact."""
    found: dict[tuple[str, str], list[str]] = {}
    for path in sorted(results.rglob("*.nc")):
        artifact = kind(path.relative_to(results).as_posix())
        with xr.open_dataset(path, engine="netcdf4", decode_cf=False) as dataset:
            for name, one in dataset.variables.items():
                dims = " ".join(str(dim) for dim in one.dims if not str(dim).startswith("string"))
                told = [str(one.attrs.get(key, "")) for key in ("units", "long_name", "source")]
                found[artifact, str(name)] = [dims, *told]
    return [[*key, *row] for key, row in sorted(found.items())]


if __name__ == "__main__":
    rows = variables(Path(sys.argv[1]))
    if not rows:
        sys.exit(f"expected results of a finished run, found none in {sys.argv[1]}")
    with PLACE.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])
