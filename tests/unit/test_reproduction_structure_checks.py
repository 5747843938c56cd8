import numpy as np
import pandas as pd
import pytest
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.reproduction.structure_checks import checks
from bladeroot.rom.comparison import checks_dataset, row
from bladeroot.rom.reduction import reduce_structure
from structure_coarse import ROOT, coarse_structure

TABLES = ("table_2_2", "table_4_1", "table_4_2", "table_4_4")


@pytest.fixture(scope="module")
def tables():
    return {name: pd.read_csv(ROOT / f"resources/thesis/{name}.csv") for name in TABLES}


@pytest.fixture(scope="module")
def result(tables):
    data = {name: table for name, table in tables.items() if name != "table_4_4"}
    keep = tables["table_4_4"].force_kN.isin([0, 10.8])
    return _checks(data | {"table_4_4": tables["table_4_4"][keep]})


def _checks(tables, **changes):
    structure = coarse_structure(**changes)
    mesh = build_mesh(structure)
    stress = prestress(structure, mesh)
    return checks(structure, mesh, stress, reduce_structure(structure, mesh, stress), tables)


def test_tables_are_as_printed(tables):
    assert [len(tables[name]) for name in TABLES] == [9, 12, 70, 18]
    wide = tables["table_4_2"].pivot_table(index="mode", columns="force_N", values="frequency_Hz")
    assert wide.loc["1Fy", 30000] == 596.6
    assert wide.loc["Rz", 5000] == 76.4
    assert (
        tables["table_4_4"].query("mode == '2B' and force_kN == 86.6").frequency_Hz.item() == 1688
    )


def test_every_comparison_is_there(result):
    found = pd.Series(result.check.values).value_counts()
    assert found["Table 4.1"] == 6
    assert found["Table 4.2"] == 6
    assert found["Table 4.4"] == 4
    assert found["reduced against full"] == 12
    assert found["rigid rotation"] == 3
    assert sum(found[found.index.str.startswith("Table 2.2")]) == 9


def test_identities_hold_on_any_mesh(result):
    chosen = result.check.values == "rigid rotation"
    assert abs(result.residual.values[chosen]).max() < 1e-9
    chosen = np.isin(result.check.values, ["rotation mode at 1 kN", "reduced against full"])
    assert result.within.values[chosen].all()


def test_verdict_compares_residual_and_limit(result):
    residual, limit = result.residual.values, result.limit.values
    required = np.isfinite(limit)
    np.testing.assert_array_equal(
        result.within.values[required], (abs(residual) <= limit)[required]
    )
    assert result.within.values[~required].all()
    # differences of rounding alone are no residuals
    expected = result.computed / result.reference - 1
    np.testing.assert_allclose(residual, expected, rtol=1e-9, atol=1e-12)


def test_missing_table_is_named(tables):
    with pytest.raises(ValueError, match="table_4_1"):
        _checks({k: v for k, v in tables.items() if k != "table_4_1"})


def test_a_case_without_the_pad_is_compared_with_it(tables, result):
    bare = _checks(tables, loaded_case="without-pad")
    chosen = bare.check.values == "Table 4.1"
    np.testing.assert_array_equal(
        bare.computed.values[chosen], result.computed.values[result.check.values == "Table 4.1"]
    )


@pytest.mark.parametrize(
    ("computed", "limit", "within"),
    [
        (1.01, 0.02, 1),
        (1.03, 0.02, 0),
        (0.97, 0.02, 0),
        (np.nan, 0.02, 0),
        (np.inf, 0.02, 0),
        (1.5, np.nan, 1),
        (np.nan, np.nan, 0),
    ],
)
def test_what_is_no_number_is_within_no_limit(computed, limit, within):
    made = checks_dataset([row("c", "1B", 0.0, 1.0, computed, limit)], "s", "d")
    assert made["within"].item() == within
