"""Rows of a comparison of this model with a reference, and the table they make."""

import numpy as np
import pandas as pd
import xarray as xr


def row(
    check: str,
    mode: str,
    force: float,
    reference: float,
    computed: float,
    limit: float,
    quantity: str = "frequency",
    unit: str = "Hz",
    scale: float | None = None,
) -> dict:
    """One comparison: computed against a reference; `limit` NaN where none is required.

    scale: what the difference is divided by, the reference unless given.
    """
    return {
        "check": check,
        "quantity": quantity,
        "unit": unit,
        "mode": mode,
        "force": float(force),
        "reference": float(reference),
        "computed": float(computed),
        "residual": float((computed - reference) / (reference if scale is None else scale)),
        "limit": float(limit),
    }


def checks_dataset(rows: list[dict], structure: str, description: str) -> xr.Dataset:
    """Rows as the Dataset of `checks.nc`, with a verdict each."""
    listed = pd.DataFrame(rows)
    # a NaN residual is within no limit; a NaN limit asks for none
    within = listed.residual.notna() & (
        listed.limit.isna() | (listed.residual.abs() <= listed.limit)
    )
    text = {
        "check": "what is compared",
        "quantity": "which quantity",
        "unit": "unit of reference and computed",
        "mode": "mode, named by reflection parity",
    }
    variables = {
        name: ("row", listed[name].to_numpy(dtype=str), {"units": "", "long_name": label})
        for name, label in text.items()
    }
    for name, label, unit in (
        ("force", "axial force", "N"),
        ("reference", "published or exact value", "see unit"),
        ("computed", "value of this model", "see unit"),
        ("residual", "computed over reference, minus one", "1"),
        ("limit", "largest residual allowed; NaN where none is required", "1"),
    ):
        variables[name] = ("row", listed[name].to_numpy(), {"units": unit, "long_name": label})
    variables["within"] = (
        "row",
        within.to_numpy().astype(np.int8),
        {"units": "1", "long_name": "1 where the residual is within its limit"},
    )
    attrs = {"structure": structure, "description": description}
    return xr.Dataset(variables, attrs=attrs)
