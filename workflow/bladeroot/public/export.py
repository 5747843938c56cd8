"""A campaign's curves, stick frequencies and verdict as CSV, MATLAB and universal file."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from bladeroot import artifacts
from bladeroot.files import save_text, whole_file
from bladeroot.loads import value_of

# Of a record's curve, a column each; damping as loss factor and, half of it, as damping ratio.
CURVE = ("time", "amplitude", "frequency", "frequency_std", "loss_factor", "loss_factor_std")
UNITS = {"s": "s", "m": "m", "Hz": "Hz", "1": ""}
# MATLAB's names of variables hold so many letters.
_MATLAB_NAME = 31
# Bytes of text at the head of a MATLAB file.
_MATLAB_HEAD = 116


def export(results: str | Path, folder: str | Path) -> list[Path]:
    """Write what a campaign's results hold of curves, stick frequencies and verdict.

    Args:
        results: the campaign's folder in `results/`.
        folder: where `curves.csv`, `stick.csv`, `stick_pooled.csv`, `verdict.csv`, `results.mat`
            (the same tables as structs) and `curves.uff` (a dataset 58 a record and quantity) go.

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
    if "curves" in tables:
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
        yield "curves", curve_table([artifacts.load(place) for place in places])
    if stick is not None:
        for name, dim in (("stick", "record"), ("stick_pooled", "level")):
            if dim in stick.dims:
                yield name, _table_over(stick, dim)
    verdict = results / "diagnosis" / "verdict.json"
    if verdict.is_file():
        said = artifacts.load_json(verdict)
        yield "verdict", pd.DataFrame(list(_leaves(said)), columns=["entry", "value"])


def curve_table(decays: Sequence[xr.Dataset]) -> pd.DataFrame:
    """Curves of records (`decay/<record>.nc`) as one table, a row a point, units in the header."""
    parts = []
    for decay in decays:
        columns = {
            name: np.full(decay.sizes["point"], decay.attrs[name], dtype=object)
            for name in ("record", "mode")
        }
        load = _with_unit("force", decay.attrs.get("load_unit", "N"))
        columns[load] = np.full(decay.sizes["point"], value_of(decay.attrs))
        for name in CURVE:
            unit = UNITS[decay[name].attrs["units"]]
            columns[f"{name}_{unit}".rstrip("_")] = decay[name].values
        columns["damping_ratio"] = 0.5 * decay["loss_factor"].values
        columns["damping_ratio_std"] = 0.5 * decay["loss_factor_std"].values
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)


def _table_over(dataset: xr.Dataset, dim: str) -> pd.DataFrame:
    """The variables of one dimension, its unit behind each name."""
    columns = {dim: dataset[dim].values} if dim in dataset.coords else {}
    for name, variable in dataset.data_vars.items():
        if variable.dims == (dim,):
            columns[_with_unit(name, variable.attrs.get("units", ""))] = variable.values
    return pd.DataFrame(columns)


def _with_unit(name: str, unit: str) -> str:
    """A column's name, with its unit where it has one."""
    return name if unit in ("", "1") else f"{name}_{unit.replace('/', '_per_')}"


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
    """Each table as a struct of columns: numbers as vectors, text as cells."""
    from scipy.io import savemat

    structs = {}
    for name, table in tables.items():
        columns = {}
        for column in table:
            values = table[column].to_numpy()
            if values.dtype.kind not in "fiub":
                values = np.array([str(value) for value in values], dtype=object)
            columns[column[:_MATLAB_NAME]] = values
        structs[name] = columns
    with whole_file(path) as part, part.open("wb") as file:
        savemat(file, structs, oned_as="column")
        # MATLAB's head of text, which has the time of day: the same results are the same bytes
        file.seek(0)
        file.write(b"MATLAB 5.0 MAT-file, bladeroot".ljust(_MATLAB_HEAD))


def _save_universal(curves: pd.DataFrame, path: Path) -> None:
    """Frequency and loss factor of each record over amplitude, as datasets 58."""
    import pyuff

    sets = []
    load = next(column for column in curves if column.partition("_")[0] == "force")
    for (record, mode), rows in curves.groupby(["record", "mode"], sort=True):
        for column, label, unit in (
            ("frequency_Hz", "frequency over amplitude", "Hz"),
            ("loss_factor", "loss factor over amplitude", "NONE"),
        ):
            order = np.argsort(rows["amplitude_m"].to_numpy())
            sets.append(
                pyuff.prepare_58(
                    binary=0,
                    id1=f"{record} {mode}: {label}",
                    id2=f"{load.replace('_', ' in ', 1)} {rows[load].iloc[0]:g}",
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
