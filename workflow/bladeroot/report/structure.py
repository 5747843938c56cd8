"""The section on the finite-element structure: what it is and how it stands against the thesis."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.report.calibration import calibration_parts
from bladeroot.report.numbers import NONE, percent
from bladeroot.report.page import Picture, Section, Table

_HEADER = ("comparison", "quantity", "count", "largest residual", "limit", "within")
SIDE = (
    "Structure {} seen from the side: 27-node hexahedra, or the nodes of matrices from another "
    "program. Above the beam and both slots, below one joint."
)
MODES = (
    "Its first elastic modes, free and without a load, named by their reflection parity: Fy bends "
    "about Y, Fz about Z, T twists. Side views show the near face."
)


def structure_section(
    checks: Mapping[str, xr.Dataset],
    accuracies: Sequence[xr.Dataset],
    calibrations: Sequence[xr.Dataset],
    drawn: Sequence[Picture],
) -> Section:
    """Checks with residual and limit, a table a structure; accuracy of reduction; dimensions."""
    parts: list = [
        "Each dovetail is compared with what the thesis prints of its beam, with exact identities, "
        "and reduced with full; matrices of another program with exact identities only. The "
        "thesis publishes neither the beam's root block and length nor the slots: the shipped "
        "structures are effective geometries, fits to some of its tables and not metrology, and "
        "no single one satisfies all of them. “Within” counts the comparisons that have a limit.",
        *drawn,
    ]
    for name, check in checks.items():
        parts.append(Table(f"{name}: {check.attrs['description']}", _HEADER, _rows(check)))
        failed = sorted(set(check["check"].values[check["within"].values == 0]))
        if failed:
            parts.append(f"{name} misses the limit in: {', '.join(failed)}.")
    parts.append(
        Table(
            "Reduced and parametric model against the finite-element model with all its degrees of "
            "freedom: largest relative error of a frequency at the softest and the stiffest "
            "contact of the box.",
            ("structure", "force / kN", "degrees of freedom", "softest", "stiffest"),
            [row for accuracy in accuracies for row in _accuracy_rows(accuracy)],
        )
    )
    for one in calibrations:
        parts += calibration_parts(one)
    return Section("Structure", parts)


def _accuracy_rows(accuracy: xr.Dataset) -> list[tuple[str, ...]]:
    largest = np.abs(accuracy["residual"]).max("mode")
    return [
        (
            str(accuracy.attrs["structure"]),
            f"{float(force) / 1e3:g}",
            str(accuracy.attrs["full_dofs"]),
            *(f"{float(largest.sel(contact=c, force=force)):.1e}" for c in ("softest", "stiffest")),
        )
        for force in accuracy["force"].values
    ]


def _rows(check: xr.Dataset) -> list[tuple[str, ...]]:
    rows = []
    held = np.isfinite(check["limit"].values)
    kinds = list(zip(check["check"].values, held, strict=True))
    for title, limited in dict.fromkeys(kinds):
        chosen = [index for index, kind in enumerate(kinds) if kind == (title, limited)]
        part = check.isel(row=chosen)
        rows.append(
            (
                title,
                str(part["quantity"].values[0]),
                str(len(chosen)),
                _residual(np.abs(part["residual"].values).max()),
                _residual(part["limit"].values.max()) if limited else NONE,
                f"{int(part['within'].sum())} of {len(chosen)}" if limited else "shown only",
            )
        )
    return rows


def _residual(value: float) -> str:
    return percent(value, 2) if value >= 1e-5 else f"{value:.0e}"
