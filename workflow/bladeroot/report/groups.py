"""The section on groups of records that are no repeats of each other: how they differ."""

import numpy as np
import xarray as xr

from bladeroot.report.numbers import NONE, fixed, significant, with_std
from bladeroot.report.page import Section, Table
from bladeroot.terms import length


def groups_section(curves: xr.Dataset) -> Section | None:
    """How the groups of a campaign differ at the same amplitude; None where it has none.

    curves: with what `bladeroot.pooling.groups` adds.
    """
    if "compared_mode" not in curves:
        return None
    rows = [
        (
            str(one["compared_mode"].item()),
            _name(one),
            _per_cent(one["difference"], one["difference_std"]),
            f"{one['high_group'].item()} over {one['low_group'].item()}",
            _largest(one),
            significant(float(one["chance"]), 2),
            significant(100.0 * float(one["scatter"]), 2, "%"),
            "yes" if int(one["told"]) else "no",
        )
        for k in range(curves.sizes["comparison"])
        for one in [curves.isel(comparison=k)]
    ]
    levels = [
        (
            str(one["of_group_mode"].item()),
            _name(one, "of_group_"),
            str(one["of_group_group"].item()),
            _per_cent(np.expm1(one["of_group_level"]), one["of_group_level_std"]),
            fixed(float(one["of_group_events"]), 0),
        )
        for k in range(curves.sizes["group_level"])
        for one in [curves.isel(group_level=k)]
    ]
    return Section(
        "Groups of records",
        [
            "Records of one group are repeats of each other; those of two groups are not, and no "
            "mean is taken over them. Groups are compared at the same amplitude of the same "
            "sensor; what several sensors saw of one event counts once.",
            Table(
                "The groups that lie furthest apart: mean difference over the amplitudes that both "
                "reach, with its standard error; largest: at one amplitude, where that is sure; "
                "chance: how often repeats alone would show as much as the mean; scatter: between "
                "the events of a group",
                ("mode", "quantity", "mean difference", "groups", "largest", "chance", "scatter",
                 "they differ"),
                rows,
            ),
            Table(
                "Each group against the mean of the groups, at the same amplitude",
                ("mode", "quantity", "group", "level", "events"),
                levels,
            ),
        ],
    )  # fmt: skip


def _per_cent(value: xr.DataArray, std: xr.DataArray) -> str:
    return with_std(100.0 * float(value), 100.0 * float(std), 0, "%")


def _largest(one: xr.Dataset) -> str:
    if not np.isfinite(float(one["largest"])):
        return NONE
    place = f"{length(float(one['largest_amplitude']))} {one['largest_sensor'].item()}".strip()
    groups = f"{one['largest_high'].item()} over {one['largest_low'].item()}"
    return f"{significant(100.0 * float(one['largest']), 2)} % at {place}, {groups}"


def _name(one: xr.Dataset, prefix: str = "compared_") -> str:
    return str(one[f"{prefix}quantity"].item()).replace("_", " ")
