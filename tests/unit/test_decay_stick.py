"""Pooling of records: exact forces, holds as replicates, tables kept as printed."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from bladeroot.decay.record import RECORD
from bladeroot.decay.stick import stick_from_records, stick_from_table


def fitted(name, mode, force, hold, value, std):
    """One record's plateau; not reached where the value is NaN."""
    reached = bool(np.isfinite(value))
    numbers = dict.fromkeys(RECORD, np.nan) | {
        "stick_frequency": value, "stick_frequency_std": std,
        "loss_factor": 0.01, "loss_factor_std": 0.001, "plateau_reached": int(reached),
    }  # fmt: skip
    verdict = "plateau" if reached else "plateau not reached"
    attrs = {"record": name, "mode": mode, "force_N": force, "hold": hold}
    return xr.Dataset(numbers | {"verdict": verdict}, attrs=attrs)


def pooled(rows):
    """Pool rows of (mode, force, hold, frequency, std)."""
    return stick_from_records([fitted(f"r{k}", *row) for k, row in enumerate(rows)])


def test_single_record_keeps_its_error():
    result = pooled([("1B", 4000.0, "a", 500.0, 0.02)])
    assert result["frequency_std"].item() == pytest.approx(0.02)
    assert np.isnan(result["between_std"].item())


def test_forces_are_grouped_exactly():
    result = pooled([("1B", 4000.0, "a", 500.0, 0.02), ("1B", 4000.5, "a", 501.0, 0.02)])
    assert result.sizes["level"] == 2


def test_within_record_error_is_3_21():
    result = pooled([("1B", 1e3, "a", 500.0, 0.03), ("1B", 1e3, "a", 500.0, 0.04)])
    assert result["within_std"].item() == pytest.approx(0.025)


def test_hold_scatter_covers_the_truth():
    rng = np.random.default_rng(0)
    z = []
    for _ in range(40):
        rows = []
        for force in (1e3, 2e3, 3e3):
            for hold in "abc":
                clamped = 0.3 * rng.standard_normal()
                rows += [
                    ("1B", force, hold + str(force), 500 + clamped + 0.01 * rng.standard_normal(),
                     0.01) for _ in range(3)
                ]  # fmt: skip
        rows.append(("1B", 4e3, "d", 500.0 + 0.3 * rng.standard_normal(), 0.01))
        result = pooled(rows)
        z.append((result["frequency"].values - 500.0) / result["frequency_std"].values)
    z = np.array(z)
    assert 0.7 < np.sqrt(np.mean(z[:, :3] ** 2)) < 1.4
    assert 0.6 < np.sqrt(np.mean(z[:, 3] ** 2)) < 1.7  # one hold: the other forces' scatter


def test_records_of_one_hold_are_not_replicates():
    rows = [("1B", 1e3, "a", 500.0, 0.01)] * 20 + [("1B", 1e3, "b", 501.0, 0.01)]
    result = pooled(rows)
    assert result["frequency"].item() == pytest.approx(500.5)
    assert result["frequency_std"].item() == pytest.approx(0.5, rel=0.01)
    assert result["holds"].item() == 2


def test_not_reached_is_listed_and_not_pooled():
    result = pooled([("1B", 1e3, "a", np.nan, np.nan), ("1B", 1e3, "b", 500.0, 0.01)])
    assert result.sizes["record"] == 2
    assert result["records"].item() == 1
    assert list(result["verdict"].values) == ["plateau not reached", "plateau"]


def table(**changes):
    values = {
        "mode": ["2B", "1B"], "force_N": [3580.0, 3580.0], "frequency_Hz": [1333.48, 480.03],
        "frequency_std_Hz": [0.18, 0.28], "loss_factor": [0.005, 0.05],
        "loss_factor_std": [0.0002, 0.0003],
    }  # fmt: skip
    return pd.DataFrame(values | changes)


def test_table_keeps_the_printed_error(tmp_path):
    result = stick_from_table(table())
    assert result.sizes == {"record": 0, "level": 2}
    np.testing.assert_allclose(result["frequency_std"], [0.28, 0.18])
    np.testing.assert_allclose(result["within_std"], [0.28, 0.18])
    assert "printed" in result["within_std"].attrs["note"]
    result.to_netcdf(tmp_path / "stick.nc")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frequency_Hz": [1333.0, -1.0]}, "frequency_Hz must be a positive number, got -1.0"),
        ({"mode": ["1B", "1B"]}, "once a mode, got 1B at 3580 N"),
    ],
)
def test_bad_tables_are_named(changes, message):
    with pytest.raises(ValueError, match=message):
        stick_from_table(table(**changes))


def test_no_records_at_all():
    assert stick_from_records([]).sizes == {"record": 0, "level": 0}
