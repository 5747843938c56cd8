"""The thesis's own contact stiffness (Table 5.2), from its columns as printed to SI and totals."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

NODES = 33  # nodes of one flank in the thesis's model (eq. 6.16)
COLUMNS = ("force_kN", "kn_N_per_mm", "kn_delta_N_per_mm", "kt_N_per_mm", "kt_delta_N_per_mm")


def published_stiffness(table: Mapping[str, Any], nodes: int = NODES) -> xr.Dataset:
    """Table 5.2 as a Dataset: nodal values as printed, and totals of a flank (eq. 6.16), N/m.

    `table` maps the column names of `COLUMNS` to lists of numbers. Nothing is corrected.
    Raises ValueError naming a missing column.
    """
    missing = [name for name in COLUMNS if name not in table]
    if missing:
        raise ValueError(f"published stiffness: missing column {', '.join(missing)}")
    column = {name: np.asarray(table[name], float) for name in COLUMNS}
    variables = {}
    for part, name in (("normal", "kn"), ("tangential", "kt")):
        value, delta = column[f"{name}_N_per_mm"] * 1e3, column[f"{name}_delta_N_per_mm"] * 1e3
        for suffix, factor, what in (
            ("nodal", 1.0, "per node, as printed"),
            ("total", float(nodes), f"of a flank, {nodes} times the nodal one"),
        ):
            attrs = {
                "units": "N/m",
                "long_name": f"published {part} contact stiffness {what}",
                "source": "Table 5.2" if suffix == "nodal" else "Table 5.2, eq. 6.16",
            }
            spread = attrs | {"long_name": f"standard deviation: {attrs['long_name']}"}
            variables[f"{name}_{suffix}"] = ("force", value * factor, attrs)
            variables[f"{name}_{suffix}_std"] = ("force", delta * factor, spread)
    force = ("force", column["force_kN"] * 1e3, {"units": "N", "long_name": "axial force"})
    return xr.Dataset(variables, coords={"force": force}, attrs={"nodes": nodes})
