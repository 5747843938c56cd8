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


def equation_31():
    phase = np.linspace(0.0, 50.0, 400)
    signal = np.cos(phase) + 1j * np.sin(phase)  # y + i H[y]
    assert np.allclose(signal, np.exp(1j * phase))
    assert not np.allclose(signal, np.exp(-1j * phase))


def equation_33():
    omega_n, eta = 3.0, 0.1
    rate = 1j * omega_n * np.sqrt(1 + 1j * eta)
    assert rate.real < 0  # it decays
    signal = np.exp(rate * np.linspace(0.0, 5.0, 50))
    for sign, holds in ((-1.0, True), (1.0, False)):  # of d H[y], with H[y] the imaginary part
        left = rate**2 * signal
        real = left.real + sign * eta * omega_n**2 * signal.imag + omega_n**2 * signal.real
        assert np.allclose(real, 0.0, atol=1e-9) == holds


def equation_313():
    y, hilbert, omega, decline, bend, chirp = 0.7, -0.4, 5.0, -0.3, 0.2, 0.11
    second = (y + 1j * hilbert) * (bend - omega**2 + 1j * (2 * omega * decline + chirp))

    def printed(factor):
        return -hilbert * omega**2 + y * 2 * omega * decline + factor * bend + y * chirp

    assert printed(hilbert) == pytest.approx(second.imag)
    assert printed(y) != pytest.approx(second.imag)
    size = y**2 + hilbert**2
    boxed = (y * second.real + hilbert * second.imag) / size + omega**2
    assert boxed == pytest.approx(bend)
    boxed = (y * second.imag - hilbert * second.real) / size - 2 * omega * decline
    assert boxed == pytest.approx(chirp)


def newmark():
    q, speed, dt = 0.3, 2.0, 1e-3
    assert q + dt * speed == pytest.approx(0.302)
    assert abs(speed + dt * dt * speed - 0.302) > 1.0


def slider_correction():
    contact, limit, before, after = 4e6, 400.0, 2.0e-4, 2.1e-4
    right, printed = after - limit / contact, before - limit / contact
    assert contact * (after - right) == pytest.approx(limit)
    excess = contact * (after - printed) - limit
    assert excess == pytest.approx(contact * (after - before))


def appendix_f_bound():
    draws = np.random.default_rng(0).standard_normal(100000)
    assert np.mean(np.abs(draws) > 1.0) == pytest.approx(0.317, abs=0.01)


def appendix_f_decay():
    eta = 0.00203
    periods = np.log(1000.0) / (np.pi * eta)
    factor = np.sqrt(1.0 + np.exp(2.0 * np.pi * periods * eta)) / np.sqrt(2.0)
    assert factor == pytest.approx(707.0, abs=1.0)


def appendix_f_clock():
    rows = table("3_1").set_index("force_N")
    assert rows["frequency_delta_percent"].min() == rows["frequency_delta_percent"][12530] == 0.001
    assert pytest.approx(0.1e-6) == 1e-2 * 0.001e-2


CHECKS = {
    "piston-area": piston_area,
    "table-3.1-damping-percent": table_31_damping_percent,
    "table-3.2-damping-percent": table_32_damping_percent,
    "table-5.2-kn-16kN": table_52_kn_16,
    "table-5.2-kt-22kN": table_52_kt_22,
    "equation-6.5": equation_65,
    "equation-3.1-sign": equation_31,
    "equation-3.3-equals": equation_33,
    "equation-3.13-second-row": equation_313,
    "newmark-displacement": newmark,
    "slider-correction": slider_correction,
    "appendix-f-bound": appendix_f_bound,
    "appendix-f-decay": appendix_f_decay,
    "appendix-f-clock": appendix_f_clock,
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
