"""Every erratum's arithmetic, done on the tables as printed."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

THESIS = Path(__file__).resolve().parents[2] / "resources" / "thesis"


def table(name):
    return pd.read_csv(THESIS / f"table_{name}.csv")


def damping_percent(name):
    printed = table(name)
    return (100 * printed["loss_factor_delta"] / printed["loss_factor"]).to_numpy(), printed[
        "loss_factor_delta_percent"
    ].to_numpy()


def on_grid(value):
    steps = (value - 1e4) / (1.4e5 / 49)
    return abs(steps - round(steps)) < 1e-3


def piston_area():
    for name in ("3_1", "3_2"):
        bars = table(name)["force_N"] / 179
        assert np.allclose(bars, bars.round(), atol=1e-9)
    assert pytest.approx(179) == 17.9e-4 * 1e5
    assert table("3_2")["force_N"].min() / (17.9e-6 * 1e5) > 700


def table_31_damping_percent():
    computed, printed = damping_percent("3_1")
    wrong = np.abs(computed - printed) > 0.3
    assert list(table("3_1")["force_N"][wrong]) == [3938]


def table_32_damping_percent():
    computed, printed = damping_percent("3_2")
    shifted = np.abs(computed[:-1] - printed[1:])
    in_place = np.abs(computed - printed)
    assert np.median(shifted) < 0.1
    assert np.median(in_place) > 0.5


def table_52_kn_16():
    row = table("5_2").set_index("force_kN").loc[16]
    assert not on_grid(row["kn_N_per_mm"])
    assert on_grid(50000)
    assert round(100 * row["kn_delta_N_per_mm"] / row["kn_N_per_mm"], 1) == 10.7
    assert round(100 * row["kn_delta_N_per_mm"] / 50000, 1) == row["kn_delta_percent"] == 10.9


def table_52_kt_22():
    row = table("5_2").set_index("force_kN").loc[22]
    assert not on_grid(row["kt_N_per_mm"])
    assert on_grid(10000 + 26 * 140000 / 49)
    assert round(100 * row["kt_delta_N_per_mm"] / row["kt_N_per_mm"], 1) == 23.2
    assert round(100 * row["kt_delta_N_per_mm"] / 84285.7, 1) == row["kt_delta_percent"] == 23.5


def equation_65():
    for ratio in (1e-2, 1e-3):  # a / b = sin(phi_0)
        angle = np.arcsin(ratio)
        right = (np.pi - 2 * angle) / (2 * np.sin(angle) ** 2) - 1 / np.tan(angle)
        half_width_squared = right * ratio**2  # in units of factor * P R / E*, b = 1
        for factor, hertz in ((2, True), (4, False)):
            agrees = abs(1 / half_width_squared * factor / (4 / np.pi) - 1) < 2 * ratio
            assert agrees == hertz


CHECKS = {
    "piston-area": piston_area,
    "table-3.1-damping-percent": table_31_damping_percent,
    "table-3.2-damping-percent": table_32_damping_percent,
    "table-5.2-kn-16kN": table_52_kn_16,
    "table-5.2-kt-22kN": table_52_kt_22,
    "equation-6.5": equation_65,
}


@pytest.mark.parametrize("erratum", CHECKS)
def test_the_arithmetic_of(erratum):
    CHECKS[erratum]()


def test_every_erratum_has_its_arithmetic_tested():
    listed = yaml.safe_load((THESIS / "errata.yaml").read_text())
    assert [entry["id"] for entry in listed] == list(CHECKS)


def test_the_campaign_is_the_printed_tables():
    stick = pd.read_csv(THESIS.parents[0] / "campaigns" / "thesis" / "stick.csv")
    for mode, name in (("1B", "3_1"), ("2B", "3_2")):
        printed = table(name)
        rows = stick[stick["mode"] == mode].reset_index(drop=True)
        for column, source in (
            ("force_N", "force_N"),
            ("frequency_Hz", "frequency_Hz"),
            ("frequency_std_Hz", "frequency_delta_Hz"),
            ("loss_factor", "loss_factor"),
            ("loss_factor_std", "loss_factor_delta"),
        ):
            assert (rows[column] == printed[source]).all()
