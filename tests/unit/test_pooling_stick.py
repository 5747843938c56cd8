"""Pooling of records: exact forces, holds as replicates, tables kept as printed."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from bladeroot.plateau.plateau import RECORD_VARIABLES
from bladeroot.pooling.components import pool
from bladeroot.pooling.scatter_of_table import scatter_about_law
from bladeroot.pooling.stick import stick_from_records
from bladeroot.pooling.stick_table import stick_from_table
from scipy.stats import t


def fitted(name, mode, force, hold, value, std, direction=""):
    """One record's plateau; not reached where the value is NaN."""
    reached = bool(np.isfinite(value))
    numbers = dict.fromkeys(RECORD_VARIABLES, np.nan) | {
        "stick_frequency": value, "stick_frequency_std": std,
        "loss_factor": 0.01, "loss_factor_std": 0.001, "plateau_reached": int(reached),
    }  # fmt: skip
    verdict = "plateau" if reached else "plateau not reached"
    attrs = {"record": name, "mode": mode, "force_N": force, "hold": hold}
    attrs["direction"] = direction
    return xr.Dataset(numbers | {"verdict": verdict}, attrs=attrs)


def pooled(rows):
    """Pool rows of (mode, force, hold, frequency, std[, direction])."""
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


def campaign(rng, holds, records):
    """Rows of a drawn campaign, `holds(rng)` a force and `records(rng)` a hold; its truths."""
    hold_std, record_std, own = 10 ** rng.uniform([-1.5, -2.0, -3.0], [0.0, -0.3, -1.0])
    difference = rng.choice([0.0, 0.5])
    rows, truth = [], 500.0 + 10.0 * np.arange(rng.integers(4, 9))
    for number, value in enumerate(truth):
        for hold in range(holds(rng)):
            clamped = value + hold_std * rng.standard_normal() + difference * (0.5 - hold % 2)
            for _ in range(records(rng)):
                found = clamped + np.hypot(record_std, own) * rng.standard_normal()
                rows.append(("1B", 1e3 * (1 + number), f"h{number}{hold}", found, own,
                             ("up", "down")[hold % 2] if difference else ""))  # fmt: skip
    return rows, truth


@pytest.mark.parametrize(
    ("holds", "records"),
    [
        (lambda rng: 2, lambda rng: 2),
        (lambda rng: rng.integers(1, 5), lambda rng: rng.integers(1, 4)),
    ],
    ids=["two holds", "unbalanced"],
)
def test_intervals_cover_the_truth(holds, records):
    """On a few campaigns; benchmarks/repeats.py counts on many."""
    rng = np.random.default_rng(3)
    z = []
    for _ in range(6):
        rows, truth = campaign(rng, holds, records)
        result = pooled(rows)
        z += list((result["frequency"].values - truth) / result["frequency_std"].values)
    z = np.abs(z)
    assert 0.63 < np.mean(z < 1.0) < 0.84  # few degrees of freedom: wide where it counts, at 95 %
    assert 0.92 < np.mean(z < 1.96) <= 0.99


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_clampings_kept_over_loads_are_so_many_repeats_and_no_more(seed):
    """Five clampings loaded through three loads: Student's of five values at each load."""
    rng = np.random.default_rng(seed)
    kept = 0.3 * rng.standard_normal(5)
    rows = [
        ("1B", 1e3 * load, f"c{k}", 500.0 + 10.0 * load + own, 1e-5)
        for load in (1, 2, 3)
        for k, own in enumerate(kept)
    ]
    result = pooled(rows)
    half = t.ppf(0.975, 4) * kept.std(ddof=1) / np.sqrt(5)
    assert 1.96 * result["frequency_std"].values == pytest.approx([half] * 3, rel=0.02)
    assert (result["hold_freedom"] == 4).all()


def test_what_clampings_keep_is_told_from_what_they_have_anew():
    rng = np.random.default_rng(4)
    z = []
    for _ in range(12):
        rows = [
            ("1B", 1e3 * load, f"c{k}", 500.0 + kept + anew + repeat, 1e-3)
            for k, kept in enumerate(0.3 * rng.standard_normal(6))
            for load, anew in enumerate(0.1 * rng.standard_normal(4))
            for repeat in 0.02 * rng.standard_normal(2)
        ]
        result = pooled(rows)
        z += list((result["frequency"].values - 500.0) / result["frequency_std"].values)
    assert float(result["between_record_std"][0]) == pytest.approx(0.02, rel=0.4)
    assert 0.9 < np.mean(np.abs(z) < 1.96) <= 1.0


def test_one_clamping_kept_over_many_loads_is_a_lower_bound():
    rows = [("1B", 1e3 * k, "a", 500.0 + k, 0.01) for k in range(1, 12)]
    assert pooled(rows)["frequency_std"].attrs["lower_bound"] == "1B"


@pytest.mark.parametrize("repeats", [1, 4])
def test_one_clamping_a_force_is_told_by_the_law_of_the_forces(repeats):
    rng = np.random.default_rng(7)
    force, z = np.linspace(2e3, 24e3, 7), []
    truth = 500.0 + 5.0 * np.log(force)
    for _ in range(8):
        clamped = truth + 0.1 * rng.standard_normal(force.size)
        rows = [
            ("1B", at, f"{at}", value + 0.02 * rng.standard_normal(), 0.002)
            for at, value in zip(force, clamped, strict=True)
            for _ in range(repeats)
        ]
        result = pooled(rows)
        z += list((result["frequency"].values - truth) / result["frequency_std"].values)
    assert 0.9 < np.mean(np.abs(z) < 1.96) <= 0.99
    assert "lower_bound" not in result["frequency_std"].attrs


def test_one_clamping_of_few_forces_is_a_lower_bound():
    rows = [("1B", 1e3 * k, f"a{k}", 500.0 + k, 0.01) for k in range(1, 6)]
    rows += [("2B", 1e3, hold, 900.0, 0.01) for hold in "ab"]
    result = pooled(rows)
    for name in ("frequency_std", "loss_factor_std"):
        assert result[name].attrs["lower_bound"] == "1B"
        assert "1B unknown: a lower bound" in result[name].attrs["long_name"]


def test_scatters_are_told_apart():
    rng = np.random.default_rng(5)
    rows = [
        ("1B", 1e3 * force, f"{force} {hold}", 500.0 + shift + 0.05 * rng.standard_normal(), 0.01)
        for force in range(6)
        for hold, shift in enumerate(0.4 * rng.standard_normal(8))
        for _ in range(4)
    ]
    level = pooled(rows).isel(level=0)
    assert float(level["between_record_std"]) == pytest.approx(0.05, rel=0.15)
    assert float(level["between_hold_std"]) == pytest.approx(0.4, rel=0.3)
    assert level["hold_freedom"] == 6 * 7
    assert level["record_freedom"] == 6 * 8 * 3


def test_the_worst_record_does_not_set_the_prior():
    """No scatter, own errors spread over a factor of 100: near the ideal weighted mean."""
    rng = np.random.default_rng(5)
    hold = np.arange(54) // 3
    wider = []
    for _ in range(6):
        std = 0.02 * 10.0 ** rng.uniform(-1.0, 1.0, 54)
        found = pool(std * rng.standard_normal(54), std, hold // 3, hold, np.zeros(54))
        wider += list(found.std * np.sqrt(np.add.reduceat(std**-2.0, np.arange(0, 54, 9))))
    assert 1.0 < np.median(wider) < 1.75


def test_direction_is_reported_and_is_not_scatter():
    rows = [
        ("1B", 1e3 * force, f"{force}{side}", 500.0 + sign * 0.5 + 0.02 * shift, 0.01, side)
        for force, shift in enumerate((-1.0, 0.3, 1.2, -0.6))
        for side, sign in (("up", 1.0), ("down", -1.0))
    ]
    result = pooled(rows)
    np.testing.assert_allclose(result["direction_difference"], 1.0)
    assert float(result["mode_direction_difference"][0]) == pytest.approx(1.0, abs=1e-6)
    assert float(result["between_hold_std"][0]) < 0.05
    np.testing.assert_allclose(result["frequency"], 500.0, atol=0.03)


@pytest.mark.parametrize(("down", "repeats"), [("a", 1), ("b", 1), ("b", 2)])
def test_one_up_and_one_down_is_scatter(down, repeats):
    """A direction that nothing repeats in another hold (or record) is not told from scatter."""
    sides = [("1B", 1e3, "a", 540.0, 0.001, "up"), ("1B", 1e3, down, 540.1, 0.001, "down")]
    result = pooled(sides * repeats)
    assert result["frequency"].item() == pytest.approx(540.05)
    assert result["frequency_std"].item() == pytest.approx(0.05 * 12.71 / 1.96, rel=0.1)
    assert np.isnan(result["mode_direction_difference"].item())


def test_records_of_one_hold_are_not_replicates():
    rows = [("1B", 1e3, "a", 500.0, 0.01)] * 20 + [("1B", 1e3, "b", 501.0, 0.01)]
    result = pooled(rows)
    assert result["frequency"].item() == pytest.approx(500.5)
    # one degree of freedom: Student's 12.71, against a normal distribution's 1.96
    assert result["frequency_std"].item() == pytest.approx(0.5 * 12.71 / 1.96, rel=0.2)
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
    assert (result.sizes["record"], result.sizes["level"]) == (0, 2)
    np.testing.assert_allclose(result["frequency_std"], [0.28, 0.18])
    np.testing.assert_allclose(result["within_std"], [0.28, 0.18])
    assert "printed" in result["within_std"].attrs["note"]
    result.to_netcdf(tmp_path / "stick.nc")


@pytest.fixture(scope="module")
def thesis():
    path = Path(__file__).parents[2] / "resources" / "campaigns" / "thesis" / "stick.csv"
    return pd.read_csv(path)


def test_printed_errors_of_the_thesis_are_too_small(thesis):
    result = stick_from_table(thesis)
    ratio = result["scatter_ratio"]
    assert float(ratio.sel(table_mode="1B", quantile=0.025)) > 5.0
    assert float(ratio.sel(table_mode="2B", quantile=0.025)) > 20.0
    assert float(ratio.sel(table_mode="2B", quantile=0.975)) < 100.0
    np.testing.assert_array_equal(result["frequency_std"], result["stated_std"])
    assert np.all(result["scatter_std"] > result["stated_std"])
    chosen = stick_from_table(thesis, "scatter")
    np.testing.assert_array_equal(chosen["frequency_std"], result["scatter_std"])
    assert "scatter" in chosen["frequency_std"].attrs["note"]


def test_scatter_about_a_law_is_found_again():
    rng = np.random.default_rng(2)
    force = np.geomspace(1.8e3, 23e3, 27)
    for true in (0.1, 1.0):
        found = [
            scatter_about_law(
                force,
                1500.0 - 200.0 * np.exp(-force / 5e3) + np.hypot(true, 0.1) *
                rng.standard_normal(27),
                np.full(27, 0.1),
            ).ratio
            for _ in range(4)
        ]  # fmt: skip
        low, middle, high = np.mean(found, axis=0)
        assert middle == pytest.approx(true / 0.1, rel=0.4)
        assert low < true / 0.1 < high


def test_rows_that_read_the_same_do_not_scatter():
    found = scatter_about_law(np.geomspace(2e3, 2e4, 8), np.full(8, 5e-3), np.full(8, 1e-4))
    assert np.all(found.rms < 1e-5)


def test_few_rows_have_no_scatter():
    result = stick_from_table(table(), "scatter")
    np.testing.assert_allclose(result["frequency_std"], [0.28, 0.18])
    assert np.isnan(result["scatter_ratio"]).all()


def test_no_records_at_all():
    assert stick_from_records([]).sizes == {"record": 0, "level": 0}
