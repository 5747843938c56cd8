"""The section on the finite-element structure: what it is and how it stands against the thesis."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from bladeroot.report.numbers import NONE, percent
from bladeroot.report.page import Picture, Section, Table


def structure_section(checks: Mapping[str, xr.Dataset], side_view: str) -> Section:
    """One table a structure: each check with its largest residual and the limit it is held to."""
    parts: list = [
        "The beam's root block and length and the slots are not published. Each structure is an "
        "effective geometry, a fit to some of the thesis's tables and not metrology; no single one "
        "satisfies all of them, so the stiffness below is given with each.",
        Picture(
            side_view,
            f"Structure {next(iter(checks))}: 27-node hexahedra seen from the side. Above the "
            "beam with the shaker's support and both slots, below one joint.",
        ),
    ]
    for name, check in checks.items():
        parts.append(Table(f"{name}: {check.attrs['description']}", _HEADER, _rows(check)))
        failed = sorted(set(check["check"].values[check["within"].values == 0]))
        if failed:
            parts.append(f"{name} misses the limit in: {', '.join(failed)}.")
    return Section("Structure", parts)


_HEADER = ("comparison", "quantity", "count", "largest residual", "limit", "within")


def _rows(check: xr.Dataset) -> list[tuple[str, ...]]:
    rows = []
    titles = check["check"].values
    for title in dict.fromkeys(titles):
        chosen = np.flatnonzero(titles == title)
        part = check.isel(row=chosen)
        residual, limit = np.abs(part["residual"].values), part["limit"].values
        held = np.isfinite(limit)
        rows.append(
            (
                title,
                part["quantity"].values[0],
                str(len(chosen)),
                _residual(residual.max()),
                _residual(limit[held].max()) if held.any() else NONE,
                f"{int(part['within'].values[held].sum())} of {held.sum()}"
                if held.any()
                else "shown only",
            )
        )
    return rows


def _residual(value: float) -> str:
    return percent(value, 2) if value >= 1e-5 else f"{value:.0e}"
