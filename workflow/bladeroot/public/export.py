"""A campaign's curves, stick frequencies and verdict as CSV, MATLAB and universal file."""

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from bladeroot import artifacts
from bladeroot.files import save_text, whole_file
from bladeroot.loads import AXIAL_FORCE, value_of

# Of a record's curve, a column each; damping as loss factor and, half of it, as damping ratio.
CURVE = ("time", "amplitude", "frequency", "frequency_std", "loss_factor", "loss_factor_std")
UNITS = {"s": "s", "m": "m", "Hz": "Hz", "1": ""}
# What the sheet says of a record, and what of it stands beside its curve; what none of them has is
# left out.
RECORD = ("mode", "group", "sensor", "event", "hold", "direction")
CURVE_FACTS = ("mode", "group", "sensor")
# MATLAB's names of fields hold so many letters.
_MATLAB_NAME = 63
# Bytes of text at the head of a MATLAB file.
_MATLAB_HEAD = 116


def export(results: str | Path, folder: str | Path) -> list[Path]:
    """Write what a campaign's results hold of curves, stick frequencies and verdict.

    Args:
        results: the campaign's folder in `results/`.
        folder: where these go: `records.csv` (what is known of each, its findings and what a person
            overruled among them), `curves.csv` (a row a record's point), `curves_mean.csv` (a row
            an amplitude of a level, with its errors), `curves_levels.csv` (a level's change per
            decade of amplitude), `stick.csv`, `stick_pooled.csv`, `verdict.csv`, `results.mat` (the
            same tables as structs) and `curves.uff` (a dataset 58 a record and quantity).

    Returns:
        The files written; none of what the results do not have.

    Raises:
        ValueError: no finished stage in the folder.
    """
    results, folder = Path(results), Path(folder)
    tables = dict(_tables(results))
    if not tables:
        raise ValueError(f"expected stick.nc or decay/ of a finished campaign ({results})")
    written = []
    for name, table in tables.items():
        written.append(folder / f"{name}.csv")
        save_text(table.to_csv(index=False, lineterminator="\n"), written[-1])
    written.append(folder / "results.mat")
    _save_matlab(tables, written[-1])
    if len(tables.get("curves", ())):
        written.append(folder / "curves.uff")
        _save_universal(tables["curves"], written[-1])
    return written


def _tables(results: Path) -> Iterator[tuple[str, pd.DataFrame]]:
    stick = artifacts.load(results / "stick.nc") if (results / "stick.nc").is_file() else None
    places = sorted((results / "decay").glob("*.nc"))
    if stick is not None and "record" in stick.dims:
        # what a removed record left in results/ is not the campaign's
        places = [place for place in places if place.stem in stick["record"].values]
    if places:
        decays = [artifacts.load(place) for place in places]
        yield "records", record_table(decays)
        yield "curves", curve_table(decays)
    if (results / "curves.nc").is_file():
        yield from _mean_tables(artifacts.load(results / "curves.nc"))
    if stick is not None:
        for name, dim in (("stick", "record"), ("stick_pooled", "level")):
            if dim in stick.dims:
                yield name, _table_over(stick, dim)
    verdict = results / "diagnosis" / "verdict.json"
    if verdict.is_file():
        said = artifacts.load_json(verdict)
        yield "verdict", pd.DataFrame(list(_leaves(said)), columns=["entry", "value"])


def record_table(decays: Sequence[xr.Dataset]) -> pd.DataFrame:
    """What is known of each record (`decay/<record>.nc`) beside its curve, a row a record."""
    return pd.DataFrame(
        {
            "record": decay.attrs["record"],
            **_facts(decay, RECORD),
            _load(decay.attrs): value_of(decay.attrs),
            **_facts(decay, ("quantity", "verdict", "reason", "findings")),
        }
        for decay in decays
    ).pipe(_known)


def curve_table(decays: Sequence[xr.Dataset]) -> pd.DataFrame:
    """Curves of records (`decay/<record>.nc`) as one table, a row a point, units in the header."""
    parts = []
    for decay in decays:
        facts = {"record": decay.attrs["record"], **_facts(decay, CURVE_FACTS)}
        facts[_load(decay.attrs)] = value_of(decay.attrs)
        points = {}
        for name in CURVE:
            unit = UNITS[decay[name].attrs["units"]]
            points[f"{name}_{unit}".rstrip("_")] = decay[name].values
        points["damping_ratio"] = 0.5 * decay["loss_factor"].values
        points["damping_ratio_std"] = 0.5 * decay["loss_factor_std"].values
        parts.append(pd.DataFrame(points).assign(**facts)[[*facts, *points]])
    return _known(pd.concat(parts, ignore_index=True))


def _mean_tables(curves: xr.Dataset) -> Iterator[tuple[str, pd.DataFrame]]:
    """Mean curves of levels (`curves.nc`), and what is known of each as a whole."""
    whole = [name for name, one in curves.data_vars.items() if one.dims == ("level", "amplitude")]
    points = curves[whole].to_dataframe().reset_index().drop(columns="level", errors="ignore")
    points = points[points["records"] > 0].reset_index(drop=True)
    units = {name: _with_unit(name, curves[name].attrs.get("units", "")) for name in points}
    load = {"force": _load(curves.attrs)}
    own = ["mode", "force", "group", "sensor", "amplitude"]
    yield "curves_mean", _known(points[[*own, *whole]].rename(columns=units | load))
    levels = _table_over(curves.drop_vars("amplitude"), "level")
    told = curves[own[:-1]].to_dataframe().reset_index(drop=True).rename(columns=load)
    yield (
        "curves_levels",
        _known(pd.concat([told[[load.get(n, n) for n in own[:-1]]], levels], axis=1)),
    )


def _facts(decay: xr.Dataset, names: Sequence[str]) -> dict[str, str]:
    """Facts of a record, empty where it has none."""
    return {name: str(decay.attrs.get(name, "")) for name in names}


def _known(table: pd.DataFrame) -> pd.DataFrame:
    """A table without the columns in which nothing stands: no load, no groups, one sensor."""
    empty = [n for n in table if n == "" or (len(table) and table[n].isin(["", None]).all())]
    return table.drop(columns=empty)


def _table_over(dataset: xr.Dataset, dim: str) -> pd.DataFrame:
    """The variables of one dimension, its unit behind each name; the load by its own."""
    columns = {dim: dataset[dim].values} if dim in dataset.coords else {}
    for name, variable in dataset.data_vars.items():
        if variable.dims == (dim,):
            called = _with_unit(name, variable.attrs.get("units", ""))
            if name in ("force", "record_force"):
                load = _load(dataset.attrs)
                called = load and name.removesuffix("force") + load
            columns[called] = variable.values
    columns.pop("", None)  # there is no load
    return pd.DataFrame(columns)


def _load(facts: Mapping) -> str:
    """The load's column: `force_N`, or what a campaign calls it; empty where there is none."""
    name, unit = str(facts.get("load_name", AXIAL_FORCE)), facts.get("load_unit", "N")
    named = "force" if name == AXIAL_FORCE else name.replace(" ", "_")
    return _with_unit(named, unit) if name else ""


def _with_unit(name: str, unit: str) -> str:
    """A column's name, with its unit where it has one."""
    return name if unit in ("", "1") else f"{name}_{unit.replace('/', '_per_').replace(' ', '_')}"


def _leaves(node: object, place: str = "") -> Iterator[tuple[str, object]]:
    """Every value of nested fields with the place where it stands, as causes.0.mechanism."""
    parts = node.items() if isinstance(node, Mapping) else enumerate(node) if _many(node) else None
    if parts is None:
        yield place, node
        return
    for key, part in parts:
        yield from _leaves(part, f"{place}.{key}".lstrip("."))


def _many(node: object) -> bool:
    return isinstance(node, list | tuple)


def _save_matlab(tables: Mapping[str, pd.DataFrame], path: Path) -> None:
    """Each table as a struct of columns: numbers as vectors, text as cells. MATLAB's names are
    letters and figures; `columns` has the names as they are in the CSV files.
    """
    from scipy.io import savemat

    structs: dict = {"columns": {name: _cells(table.columns) for name, table in tables.items()}}
    for name, table in tables.items():
        columns = {}
        for column in table:
            values = table[column].to_numpy()
            if values.dtype.kind not in "fiub":
                values = _cells(values)
            columns[_plain(column)[:_MATLAB_NAME]] = values
        structs[name] = columns
    with whole_file(path) as part, part.open("wb") as file:
        savemat(file, structs, oned_as="column", long_field_names=True)
        # MATLAB's head of text, which has the time of day: the same results are the same bytes
        file.seek(0)
        file.write(b"MATLAB 5.0 MAT-file, bladeroot".ljust(_MATLAB_HEAD))


def _cells(values: Iterable) -> np.ndarray:
    return np.array([str(value) for value in values], dtype=object)


def _plain(name: str) -> str:
    """A name in letters, figures and underscores."""
    parts = unicodedata.normalize("NFKD", name.replace("%", "percent"))
    letters = "".join(one for one in parts if not unicodedata.combining(one))
    return re.sub(r"[\W_]+", "_", letters).encode("ascii", "ignore").decode()


def _ascii(text: str) -> str:
    """Text of a universal file, whose lines hold 80 ASCII characters."""
    return unicodedata.normalize("NFKD", text).encode("ascii", "replace").decode()[:80]


def _save_universal(curves: pd.DataFrame, path: Path) -> None:
    """Frequency and loss factor of each record over amplitude, as datasets 58."""
    import pyuff

    sets = []
    facts = curves.columns[: curves.columns.get_loc("time_s")]
    load = next((one for one in facts if one not in ("record", *CURVE_FACTS)), "")
    for (record, mode), rows in curves.groupby(["record", "mode"], sort=True):
        for column, label, unit in (
            ("frequency_Hz", "frequency over amplitude", "Hz"),
            ("frequency_std_Hz", "standard error of the frequency over amplitude", "Hz"),
            ("loss_factor", "loss factor over amplitude", "NONE"),
            ("loss_factor_std", "standard error of the loss factor over amplitude", "NONE"),
        ):
            order = np.argsort(rows["amplitude_m"].to_numpy())
            sets.append(
                pyuff.prepare_58(
                    binary=0,
                    id1=_ascii(f"{record} {mode}: {label}"),
                    id2=_ascii(f"{load} {rows[load].iloc[0]:g}") if load else "NONE",
                    func_type=0,
                    rsp_node=1,
                    rsp_dir=0,
                    ref_node=1,
                    ref_dir=0,
                    ord_data_type=4,
                    abscissa_spacing=0,
                    abscissa_spec_data_type=8,
                    abscissa_axis_units_lab="m",
                    ordinate_axis_units_lab=unit,
                    orddenom_spec_data_type=0,
                    data=rows[column].to_numpy()[order],
                    x=rows["amplitude_m"].to_numpy()[order],
                )
            )
    with whole_file(path) as part:
        named = part.with_name(f"{part.name}.uff")  # pyuff knows its files by their ending
        try:
            pyuff.UFF(str(named)).write_sets(sets, "overwrite")
            named.replace(part)
        finally:
            named.unlink(missing_ok=True)
