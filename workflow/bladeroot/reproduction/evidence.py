"""What the ledger may look at: artifacts of the stages and the published tables."""

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

# Computed values in the order and the unit of the printed ones, by variant (which structure, which
# reading of the gauge); one variant is named "". NaN where this run has no value.
Computed = dict[str, Float[ndarray, " value"]]


@dataclass(frozen=True)
class Evidence:
    """Artifacts by name (stick, fe_forces, stiffness, theory), by structure, and tables.

    checks and reduced: by structure. maps: by structure and axial force in N. tables: by the
    number in their file's name, as printed. parameters: of the contact, SI, by name.
    """

    stages: Mapping[str, xr.Dataset]
    checks: Mapping[str, xr.Dataset]
    reduced: Mapping[str, xr.Dataset]
    maps: Mapping[str, Mapping[float, xr.Dataset]]
    tables: Mapping[str, pd.DataFrame]
    parameters: Mapping[str, float]
