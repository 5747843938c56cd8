"""The report's part on calibrated dimensions: how well known they are, what contradicts what."""

import xarray as xr

from bladeroot.report.numbers import fixed, significant
from bladeroot.report.page import Table

# SI unit -> the unit shown, its size in SI, decimals.
_SHOWN_UNITS = {"m": ("mm", 1e-3, 2), "Pa": ("GPa", 1e9, 1), "kg/m3": ("kg/m³", 1.0, 0)}


def calibration_parts(one: xr.Dataset) -> list:
    """Dimensions, tables and contradictions of one calibration."""
    name = one.attrs["structure"]
    return [
        Table(
            f"{name}: unpublished dimensions from Tables {one.attrs['fitted']}, with the standard "
            "deviation that tolerances and priors leave. A deviation near the prior's says that "
            "the tables do not see that dimension. The shipped file lies "
            f"{fixed(one['shipped_distance'].item(), 1)} standard deviations away over all "
            f"{one.sizes['parameter']} together.",
            ("dimension", "unit", "most probable", "± std", "prior", "shipped"),
            [_parameter(one.isel(parameter=k)) for k in range(one.sizes["parameter"])],
        ),
        Table(
            f"{name}: each table as the other fitted tables predict it.",
            ("table", "fitted", "numbers", "largest z", "chi²", "chance"),
            [_table(one.sel(table=table)) for table in one["table"].values],
        ),
        *_contradictions(one),
    ]


def _parameter(one: xr.Dataset) -> tuple[str, ...]:
    unit, size, digits = _SHOWN_UNITS[str(one["unit"].item())]
    keys = ("most_probable", "std", "prior_mean", "prior_std", "shipped")
    value, std, mean, wide, shipped = (fixed(one[key].item() / size, digits) for key in keys)
    return str(one["parameter"].item()), unit, value, std, f"{mean} ± {wide}", shipped


def _table(one: xr.Dataset) -> tuple[str, ...]:
    return (
        str(one["table"].item()),
        "yes" if one["table_fitted"].item() else "no",
        str(one["left_out_count"].item()),
        fixed(one["left_out_z"].item(), 1),
        fixed(one["left_out_chi_square"].item(), 1),
        significant(one["left_out_chance"].item(), 1),
    )


def _contradictions(one: xr.Dataset) -> list:
    if not one.sizes["set"]:
        return ["One geometry meets all tables within twice their tolerances."]
    rows = [
        (str(tables), fixed(float(inflation), 1))
        for tables, inflation in zip(
            one["set_tables"].values, one["set_inflation"].values, strict=True
        )
    ]
    caption = (
        f"{one.attrs['structure']}: tables that no geometry within the priors meets together, each "
        "number within twice its tolerance, and the factor on all tolerances at which one would."
    )
    return [Table(caption, ("tables", "factor"), rows)]
