"""The shipped geometry H against the thesis's tables, exact identities and its own full model."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from bladeroot.structure.checks import checks
from bladeroot.structure.file import load_structure

RESOURCES = Path(__file__).resolve().parents[2] / "resources"


@pytest.mark.slow
def test_dovetail_h_keeps_every_limit():
    names = ("table_2_2", "table_4_1", "table_4_2", "table_4_4")
    tables = {name: pd.read_csv(RESOURCES / "thesis" / f"{name}.csv") for name in names}
    result = checks(load_structure(RESOURCES / "structures" / "dovetail-H.yaml"), tables)
    held = result.isel(row=np.flatnonzero(np.isfinite(result["limit"].values)))
    missed = held["check"].values[np.abs(held["residual"].values) > held["limit"].values]
    assert held.sizes["row"] > 30
    assert list(missed) == []
    limits = dict(zip(held["check"].values, held["limit"].values, strict=True))
    assert limits["Table 2.2, experimental"] == 0.005
    assert limits["Table 4.1"] == 0.01
    assert limits["Table 4.2"] == 0.023
    assert limits["Table 4.4"] == 0.006
    assert limits["rigid rotation"] <= 1e-6
    assert limits["reduced against full"] == 0.0005
