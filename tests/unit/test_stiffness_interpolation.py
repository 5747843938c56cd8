import csv
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from bladeroot.stiffness.interpolation import (
    ForceGauge,
    fe_forces,
    interpolate_to,
)
from hypothesis import given, settings
from hypothesis import strategies as st

RESOURCES = Path(__file__).parents[2] / "resources"
GAUGE = ForceGauge(0.01 * 700e5 * 17.9e-4, 0.01, "full-scale")


def table(path):
    with (RESOURCES / path).open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: [row[key] for row in rows] for key in rows[0]}


def stick_of(mode, force, frequency, std, loss=None):
    count = len(force)
    loss = np.full(count, 0.005) if loss is None else loss
    return xr.Dataset(
        {
            "mode": ("level", np.array([mode] * count if isinstance(mode, str) else mode)),
            "force": ("level", np.asarray(force, float)),
            "frequency": ("level", np.asarray(frequency, float)),
            "frequency_std": ("level", np.asarray(std, float)),
            "loss_factor": ("level", np.asarray(loss, float)),
            "loss_factor_std": ("level", np.full(count, 1e-4)),
        }
    )


@pytest.fixture(scope="module")
def thesis():
    rows = table("campaigns/thesis/stick.csv")
    numbers = {key: np.array(rows[key], float) for key in rows if key != "mode"}
    stick = stick_of(
        rows["mode"],
        numbers["force_N"],
        numbers["frequency_Hz"],
        numbers["frequency_std_Hz"],
        numbers["loss_factor"],
    )
    return fe_forces(stick, np.arange(12e3, 23e3, 2e3), GAUGE)


def test_gauges():
    assert GAUGE.full_scale_std == pytest.approx(1253.0)
    forces = np.array([10e3, 20e3])
    np.testing.assert_allclose(GAUGE.std("full-scale", forces), [1253.0, 1253.0])
    np.testing.assert_allclose(GAUGE.std("reading", forces), [100.0, 200.0])
    with pytest.raises(ValueError, match="force error"):
        ForceGauge(1.0, 0.01, "readings")
    with pytest.raises(ValueError, match="negative"):
        ForceGauge(-1.0, 0.01, "reading")


def test_table_5_1_follows_from_one_per_cent_of_reading(thesis):
    """Nine of its twelve numbers to the printed digit, all within 0.01 Hz."""
    printed = table("thesis/table_5_1.csv")
    found = thesis["frequency_std"].sel(force_error="reading")
    same = 0
    for mode in ("1B", "2B"):
        expected = np.array(printed[f"frequency_delta_{mode}_Hz"], float)
        np.testing.assert_allclose(found.sel(mode=mode), expected, atol=0.01)
        same += int(np.sum(np.round(found.sel(mode=mode).values, 2) == expected))
    assert same == 9


def test_forces_between_the_same_two_records_share_their_errors(thesis):
    covariance = thesis["frequency_covariance"].sel(force_error="full-scale")
    std = thesis["frequency_std"].sel(force_error="full-scale").values
    for m in range(2):
        np.testing.assert_allclose(np.diag(covariance[m]), std[m] ** 2)
        assert np.linalg.eigvalsh(covariance[m]).min() > -1e-10
    first = covariance.sel(mode="1B").values / np.outer(std[0], std[0])
    assert first[2, 3] > 0.9  # 16 and 18 kN: both on the line from 12.5 to 24.2 kN
    apart = covariance.sel(mode="2B").values[0, 3]
    assert apart == 0.0  # 12 and 18 kN: no measured level in common


def test_covariance_agrees_with_simulated_errors():
    rng = np.random.default_rng(3)
    forces, values = np.array([5e3, 9e3, 20e3]), np.array([500.0, 530.0, 560.0])
    value_std, force_std = np.array([0.3, 0.2, 0.4]), np.array([60.0, 90.0, 150.0])
    targets = np.array([7e3, 12e3, 15e3])
    expected = interpolate_to(targets, forces, values).covariance(value_std, force_std)
    draws = np.array(
        [
            np.interp(
                targets,
                forces + force_std * rng.standard_normal(3),
                values + value_std * rng.standard_normal(3),
            )
            for _ in range(20000)
        ]
    )
    np.testing.assert_allclose(np.cov(draws.T), expected, rtol=0.05, atol=0.002)


def test_nothing_is_extrapolated():
    stick = stick_of("1B", [5e3, 10e3], [500, 510], [0.1, 0.1])
    result = fe_forces(stick, np.array([4999.0, 5e3, 10e3, 10001.0]), GAUGE)
    known = np.isfinite(result["frequency"].values[0])
    assert known.tolist() == [False, True, True, False]
    for name in ("frequency_std", "loss_factor", "lower_force", "frequency_only_std"):
        unknown = np.isnan(result[name].isel(force=[0, 3]).values)
        assert unknown.all(), name
    np.testing.assert_allclose(result["frequency"].values[0, 1:3], [500, 510])


def test_one_level_alone_gives_nothing():
    result = fe_forces(stick_of("1B", [5e3], [500], [0.1]), np.array([5e3]), GAUGE)
    assert np.isnan(result["frequency"].values).all()


def test_level_without_frequency_is_passed_over():
    stick = stick_of("1B", [5e3, 7e3, 10e3], [500, np.nan, 510], [0.1, np.nan, 0.1])
    result = fe_forces(stick, np.array([7e3]), GAUGE)
    assert result["frequency"].values[0, 0] == pytest.approx(504)
    assert result["loss_factor"].values[0, 0] == pytest.approx(0.005)


def test_two_levels_at_one_force_are_refused():
    with pytest.raises(ValueError, match=r"mode 1B has two levels at 5000\.0 N"):
        fe_forces(stick_of("1B", [5e3, 5e3], [500, 501], [0.1, 0.1]), np.array([5e3]), GAUGE)


@settings(max_examples=100, deadline=None)
@given(
    forces=st.lists(st.floats(1e3, 3e4), min_size=2, max_size=8, unique=True),
    share=st.floats(0, 1),
    slope=st.floats(-1e-2, 1e-2),
)
def test_lines_are_exact_on_a_line_and_never_beyond_the_bracket(forces, share, slope):
    forces = np.sort(forces)
    target = np.clip(forces[0] + share * (forces[-1] - forces[0]), forces[0], forces[-1])
    lines = interpolate_to(np.array([target]), forces, 500 + slope * forces)
    assert lines.value[0] == pytest.approx(500 + slope * target, rel=1e-9)
    assert lines.lower[0] <= target <= lines.upper[0]
    assert lines.by_value.sum() == pytest.approx(1.0)
