import numpy as np
import pytest
import xarray as xr
from bladeroot.report.calibration import calibration_parts


@pytest.fixture
def made():
    """A calibration's artifact of two dimensions, two tables and one contradiction."""
    return xr.Dataset(
        {
            "unit": ("parameter", ["m", "Pa"]),
            "most_probable": ("parameter", [4.31e-3, 2.003e11]),
            "std": ("parameter", [0.12e-3, 1.4e9]),
            "prior_mean": ("parameter", [4.4e-3, 2.0e11]),
            "prior_std": ("parameter", [0.5e-3, 3.0e9]),
            "shipped": ("parameter", [4.28e-3, 2.003e11]),
            "shipped_distance": ((), 1.7),
            "table_fitted": ("table", np.array([1, 0], np.int8)),
            "left_out_count": ("table", [3, 2]),
            "left_out_z": ("table", [1.23, -9.8]),
            "left_out_chi_square": ("table", [2.5, 140.0]),
            "left_out_chance": ("table", [0.47, 3e-31]),
            "set_tables": ("set", ["2.2; 4.3"]),
            "set_inflation": ("set", [3.44]),
            "bonded_frequency": ("joint_mode", [537.1, 1432.2]),
            "bonded_frequency_std": ("joint_mode", [2.1, 4.2]),
            "ln_stiffness_std": ("contact", [0.2, 0.1]),
            "ln_stiffness_correlation": ((), -0.97),
            "joint_force": ((), 12e3),
        },
        coords={
            "parameter": ["neck", "modulus"],
            "table": ["2.2", "4.4"],
            "joint_mode": ["1B", "2B"],
            "contact": ["kn", "kt"],
        },
        attrs={"structure": "toy", "fitted": "2.2"},
    )


def test_dimensions_are_shown_in_the_units_of_drawings(made):
    first = calibration_parts(made)[0]
    assert first.rows[0] == ["neck", "mm", "4.31", "0.12", "4.40 ± 0.50", "4.28"]
    assert first.rows[1][1:4] == ["GPa", "200.3", "1.4"]


def test_tables_and_contradictions_are_named(made):
    _, tables, sets = calibration_parts(made)
    assert tables.rows[1][:4] == ["4.4", "no", "2", "-9.8"]
    assert sets.rows == [["2.2; 4.3", "3.4"]]
