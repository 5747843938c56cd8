"""The table of records that the diagnosis reads."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from bladeroot.diagnosis.observations import (
    POINTS_A_DECADE,
    correlation_length,
    observations,
    reading_step,
)
from bladeroot.diagnosis.stick_model import stick_data
from bladeroot.plateau.plateau import RECORD_VARIABLES
from bladeroot.pooling.stick import stick_from_records
from bladeroot.pooling.stick_table import stick_from_table

FACTS = {
    "same_everywhere": 1253.0, "of_reading": 0.01, "scale": 179.0,
    "laser_x": {"1B": 0.01}, "time": {"a": 60.0}, "temperature": {},
}  # fmt: skip


def decay(record, top=1e-5, **facts):
    """A decay at constant 500 Hz whose errors are those of straight lines over 0.1 s."""
    time = np.linspace(0.0, 1.0, 101)
    amplitude = top * np.exp(-6.0 * time)
    std = np.sqrt(12.0 * 0.01**2 * 0.01 / 0.1**3) / (2.0 * np.pi)
    parts = {
        "time": time, "amplitude": amplitude, "frequency": 500.0 + 0.0 * time,
        "loss_factor": 0.004 + amplitude, "amplitude_std": 1e-3 * amplitude,
        "frequency_std": np.full(101, std), "loss_factor_std": np.full(101, 1e-5),
    }  # fmt: skip
    made = {name: ("point", values) for name, values in parts.items()}
    made |= {"block_time": ("block", time), "block_std": ("block", np.full(101, 0.01))}
    attrs = {"record": record, "mode": "1B", "force_N": 1790.0, "verdict": "usable"}
    return xr.Dataset(made, attrs=attrs | facts)


def plateau_of(decay):
    """What the plateau stage says of such a decay."""
    values = dict.fromkeys(RECORD_VARIABLES, 1e-3) | {
        "stick_frequency": 500.0,
        "plateau_reached": 1,
    }
    made = {name: ((), value) for name, value in values.items()}
    return xr.Dataset(made | {"verdict": ((), "plateau")}, attrs=decay.attrs)


@pytest.fixture(scope="module")
def campaign():
    decays = [decay("a", hold="h1"), decay("b", top=5e-6, hold="b"), decay("c", force_N=3580.0)]
    stick = stick_from_records([plateau_of(one) for one in decays])
    integrity = xr.Dataset(
        {"finding_id": ("finding", ["spike", "clipping"]),
         "finding_record": ("finding", ["b", "b"])}
    )  # fmt: skip
    return decays, observations(stick, decays, integrity, FACTS)


def test_curves_stand_on_a_ladder_and_are_not_extrapolated(campaign):
    decays, seen = campaign
    ladder = seen["amplitude"].values
    assert np.allclose(np.diff(np.log10(ladder)), 1.0 / POINTS_A_DECADE)
    known = np.isfinite(seen["loss_factor"].values)
    for row, one in zip(known, decays, strict=True):
        reach = one["amplitude"].values
        assert np.array_equal(row, (ladder >= reach.min()) & (ladder <= reach.max()))
    exact = 0.004 + ladder
    assert np.allclose(seen["loss_factor"].values[0][known[0]], exact[known[0]], rtol=1e-3)


def test_records_carry_hold_time_and_findings(campaign):
    _, seen = campaign
    assert seen["hold"].values.tolist() == ["h1", "", ""]  # a record's own id is no hold
    assert seen["findings"].values.tolist() == ["", "clipping;spike", ""]
    assert seen["time"].values[0] == 60.0
    assert np.isnan(seen["time"].values[1:]).all()


def test_the_correlation_length_is_that_of_the_window_of_straight_lines():
    assert correlation_length(decay("a")) == pytest.approx(0.1 * 6.0, rel=1e-6)


def test_a_table_begins_at_the_stick_frequencies():
    table = pd.DataFrame(
        {"mode": "1B", "force_N": [1790.0, 3580.0], "frequency_Hz": [500.0, 510.0],
         "frequency_std_Hz": 0.1, "loss_factor": 0.004, "loss_factor_std": 1e-4}
    )  # fmt: skip
    seen = observations(stick_from_table(table), [], None, FACTS)
    assert seen.sizes["amplitude"] == 0
    assert seen["record"].values.tolist()[0] == "1B-1790N"
    assert seen["stick_frequency_std"].values.tolist() == [0.1, 0.1]
    assert "stick_frequency_scatter" in seen


@pytest.mark.parametrize(
    ("forces", "clampings"), [((1e3, 2e3, 3e3), 3), ((1e3, 5e3, 6e3), 6), ((9e3, 8e3, 7e3), 6)]
)
def test_modes_that_share_most_loads_of_a_table_share_its_clampings(forces, clampings):
    modes = np.repeat(["1B", "2B"], 3)
    table = pd.DataFrame(
        {"mode": modes, "force_N": [1e3, 2e3, 3e3, *forces], "frequency_Hz": 500.0,
         "frequency_std_Hz": 0.1, "loss_factor": 0.004, "loss_factor_std": 1e-4}
    )  # fmt: skip
    seen = observations(stick_from_table(table), [], None, FACTS)
    data = stick_data(seen, ["1B", "2B"])
    assert np.unique(data.hold).size == clampings


@pytest.mark.parametrize(("step", "expected"), [(1.0, 179.0), (0.1, 17.9), (0.003, 0.0)])
def test_the_rounding_of_the_gauge_is_seen_in_its_readings(step, expected):
    force = 179.0 * step * np.array([31.0, 77.0, 123.0])
    assert reading_step(force, 179.0) == pytest.approx(expected)
