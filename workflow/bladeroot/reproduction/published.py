"""The thesis's own contact stiffness (Table 5.2), from its columns as printed to SI and totals."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from bladeroot.variables import dataset

NODES = 33  # nodes of one flank in the thesis's model (eq. 6.16)
_PRINTED = {"": "N_per_mm", "_std": "delta_N_per_mm"}


def published_stiffness(table: Mapping[str, Any]) -> xr.Dataset:
    """Table 5.2 as a Dataset: nodal values as printed, and totals of a flank (eq. 6.16), N/m.

    table: lists of numbers by the names of its columns (`force_kN`, `kn_N_per_mm`,
    `kn_delta_N_per_mm`, the same of `kt`). Nothing is corrected. Raises ValueError naming a
    missing column.
    """
    names = ["force_kN", *(f"{k}_{end}" for k in ("kn", "kt") for end in _PRINTED.values())]
    missing = [name for name in names if name not in table]
    if missing:
        raise ValueError(f"published stiffness: missing column {', '.join(missing)}")
    made = {"force": 1e3 * np.asarray(table["force_kN"], float)}
    for k in ("kn", "kt"):
        for std, end in _PRINTED.items():
            nodal = 1e3 * np.asarray(table[f"{k}_{end}"], float)
            made |= {f"{k}_nodal{std}": nodal, f"{k}_total{std}": NODES * nodal}
    return dataset("reproduction/published", made)
