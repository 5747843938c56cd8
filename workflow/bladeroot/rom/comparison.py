"""Rows of a comparison of this model with a reference, and the table they make."""

import numpy as np
import pandas as pd
import xarray as xr

from bladeroot.variables import dataset


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
    made = {name: column.to_numpy(None if column.dtype == float else str)
            for name, column in listed.items()}  # fmt: skip
    made["within"] = within.to_numpy().astype(np.int8)
    about = {"structure": structure, "description": description}
    return dataset("rom/checks", made).assign_attrs(about)
