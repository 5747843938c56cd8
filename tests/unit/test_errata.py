"""Every erratum's arithmetic, done on the tables as printed."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from bladeroot.fem.clamped_beam import stiffening_factor, wave_number

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


def density_unit():
    density = table("2_1").set_index("quantity").loc["density"]
    assert density["printed_unit"] == "kg/m^2"
    assert 7.0e3 < float(density["modified"]) < float(density["primary"]) < 8.0e3


def strain_gauge_modulus():
    beam = float(table("2_1").set_index("quantity").loc["modulus of elasticity", "modified"])
    assert pytest.approx(1.048, abs=5e-4) == 210e9 / beam


def gauge_percent():
    full_scale = 0.01 * 700e5 * 17.9e-4
    assert full_scale == pytest.approx(1253)
    assert full_scale / 12e3 == pytest.approx(0.104, abs=1e-3)
    assert full_scale / table("3_1")["force_N"][0] == pytest.approx(0.35, abs=1e-3)


def table_22_against_41():
    numerical = table("2_2").query("source == 'numerical refined mesh'")["frequency_Hz"].to_numpy()
    free = table("4_1").set_index("number")["free_frequency_Hz"].loc[[7, 9, 10]].to_numpy()
    assert free / numerical == pytest.approx([1.038, 1.002, 1.034], abs=5e-4)


def table_31_frequency_percent():
    wrong = {}
    for name in ("3_1", "3_2"):
        rows = table(name)
        low, high = (
            100 * (rows["frequency_delta_Hz"] + side * 0.005) / rows["frequency_Hz"] + side * 0.0005
            for side in (-1, 1)
        )
        printed = rows["frequency_delta_percent"]
        wrong[name] = list(rows["force_N"][(printed < low - 1e-9) | (printed > high + 1e-9)])
    assert wrong == {"3_1": [6802], "3_2": []}
    assert pytest.approx(0.0144, abs=5e-5) == 100 * 0.075 / 521.17


def table_41_supports():
    rows = table("4_2")
    free = table("4_1").set_index("number")["elastic_support_frequency_Hz"]
    for mode, number, alone in (("Ry", 5, 1.05), ("Rz", 6, 1.08)):
        of_mode = rows[rows["mode"] == mode]
        slope = np.polyfit(of_mode["force_N"], of_mode["frequency_Hz"] ** 2, 1)[0]
        assert np.sqrt(slope) == pytest.approx(alone, abs=6e-3)
        assert np.sqrt(slope + free[number] ** 2) == pytest.approx(1.53, abs=0.03)
        assert of_mode["frequency_Hz"].iloc[0] == 1.1


def equation_412():
    rng = np.random.default_rng(0)
    masters, slaves = 2, 3
    mass_m, mass_s = np.diag(rng.random(masters)), np.diag(rng.random(slaves))
    static = rng.random((slaves, masters))
    whole = np.block([[mass_m, np.zeros((2, 3))], [np.zeros((3, 2)), mass_s]])
    alpha = np.vstack([np.eye(masters), static])
    assert np.allclose(alpha.T @ whole @ alpha, mass_m + static.T @ mass_s @ static)
    assert (static.T @ mass_s).shape != mass_m.shape


def table_43_first_column():
    def slope(name, mode):
        rows = table(name).query("mode == @mode")
        return np.polyfit(1e3 * rows["force_kN"], rows["frequency_Hz"] ** 2, 1)[0]

    beam = table("b").query("mode == 1")
    clamped = np.polyfit(beam["force_N"], beam["frequency_Hz"] ** 2, 1)[0]
    mass_length2 = stiffening_factor(1) / (4 * np.pi**2 * clamped)
    assert mass_length2 == pytest.approx(0.1986, abs=3e-4)
    least = 1 / (4 * mass_length2)  # the integrals' ratio is pi^2 at least, for X(0) = X(1) = 0
    assert slope("4_3", "1B") == pytest.approx(1.06, abs=0.01)
    assert least == pytest.approx(1.26, abs=0.01)
    assert slope("4_4", "1B") > least


def equation_512():
    s1, s2 = 0.24, 0.22
    angle = np.linspace(1e-3, np.pi / 2, 20001)
    rim = s1 * np.cos(angle) + s2 * np.sin(angle)  # accepted below this distance
    largest = (rim * np.cos(angle)).max()
    assert largest == pytest.approx((s1 + np.hypot(s1, s2)) / 2, rel=1e-6)
    assert largest > s1


def table_52_percent():
    rows = table("5_2").set_index("force_kN")
    wrong = {}
    for name in ("kn", "kt"):
        exact = 100 * rows[f"{name}_delta_N_per_mm"] / rows[f"{name}_N_per_mm"]
        off = (exact - rows[f"{name}_delta_percent"]).abs() > 0.0501
        wrong |= {(name, force): round(value, 2) for force, value in exact[off].items()}
    assert wrong == {
        ("kn", 16): 10.67, ("kn", 22): 26.84, ("kt", 18): 15.05, ("kt", 22): 23.17,
    }  # fmt: skip


def _punch(angle, edge):
    """Shape of (6.4) with the exponent on the whole fraction, and as printed."""
    with np.errstate(divide="ignore"):
        tangents = np.abs(np.tan((angle + edge) / 2) * np.tan((angle - edge) / 2)) ** np.sin(edge)
        above, below = np.abs(np.sin(angle + edge)), np.abs(np.sin(angle - edge))
        straight = (np.pi - 2 * edge) * np.cos(angle)
        factor = 2 / np.pi / (np.pi - 2 * edge - np.sin(2 * edge))
        return (
            factor * (straight + np.log((above / below) ** np.sin(angle) * tangents)),
            factor * (straight + np.log(above ** np.sin(angle) / below * tangents)),
        )


def equation_64():
    edge = 0.8
    angle = (np.arange(200000) + 0.5) / 200000 * np.pi - np.pi / 2
    whole, printed = _punch(angle, edge)
    step = np.cos(angle) * np.pi / 200000  # dx over b
    assert np.sum(whole * step) == pytest.approx(1, abs=1e-4)
    assert whole == pytest.approx(whole[::-1], abs=1e-6)
    assert abs(np.sum(printed * step) - 1) > 0.05
    assert np.abs(printed - printed[::-1]).max() > 0.1


def equation_69():
    friction_limit, shear = 1.0, 0.4  # mu P and Q
    corrective = friction_limit - shear  # what (6.9) without its sign integrates to, as (6.4) to P
    assert friction_limit - corrective == pytest.approx(shear)
    assert friction_limit - (-corrective) == pytest.approx(2 * friction_limit - shear)


def equation_610():
    length, half_width, r = 26.0, 1.3, 0.7
    exact = np.arcsinh(length / (2 * r))  # half the integral of 1/sqrt(r^2 + s^2)
    assert np.log(length / half_width) - np.log(r / half_width) == pytest.approx(exact, rel=1e-3)
    assert abs(np.log(r / half_width) / exact) < 0.2


def appendix_a_load():
    assert round(44 / 1.1) == 40 != 35
    assert max(table(name)["force_N"].max() for name in ("3_1", "3_2")) == 24165


def appendix_b_percent():
    rows = table("b")
    assert np.allclose(rows["force_percent"] * 30e3, rows["force_N"])


def appendix_b_material():
    rows = table("b")
    squares, mass_length2, ratio = {}, {}, {}
    for mode, group in rows.groupby("mode"):
        squares[mode] = np.polyfit(group["force_N"], group["frequency_Hz"] ** 2, 1)
        mass_length2[mode] = stiffening_factor(mode) / (4 * np.pi**2 * squares[mode][0])
        ratio[mode] = squares[mode][1] * (2 * np.pi) ** 2 / wave_number(mode) ** 4
    assert mass_length2[1] == pytest.approx(mass_length2[2], rel=2e-3)  # one beam
    assert ratio[1] == pytest.approx(ratio[2], rel=2e-4)
    section, inertia = 26e-3 * 10e-3, 26e-3 * 10e-3**3 / 12
    for modulus, needed in ((200.3e9, 8024), (210e9, 7654)):
        length2 = modulus * inertia / 22951 / 0.19863
        density = 0.19863 / length2 / section
        assert density == pytest.approx(needed, abs=5)
        assert abs(density / 7592 - 1) > 0.008


def equation_b18():
    root, length = wave_number(1), 0.31

    def end(argument):
        above, below = np.sinh(argument) - np.sin(argument), np.cosh(argument) - np.cos(argument)
        return np.sinh(root) - np.sin(root) - above / below * (np.cosh(root) - np.cos(root))

    assert abs(end(root)) < 1e-9
    assert abs(end(root * length)) > 1


def appendix_c_slip():
    friction, load, radius, modulus, t = 0.42, 3e5, 2.5e-3, 1.15e11, 0.6
    b = np.sqrt(4 * load * radius / (np.pi * modulus))
    shear = friction * 2 * load / (np.pi * b) * np.sqrt(1 - t**2)
    slip = 2 * 2 / (np.pi * modulus) * friction * load * t**2  # printed, for c -> 0
    limit = friction**2 * load * b / (np.pi * radius) * t**2 * np.sqrt(1 - t**2)
    assert slip * shear == pytest.approx(2 * limit)


def appendix_c_cycle():
    angle = (np.arange(100000) + 0.5) / 100000 * np.pi - np.pi / 2
    integral = np.sum(np.sin(angle) ** 2 * np.cos(angle) ** 2) * np.pi / 100000
    assert integral == pytest.approx(np.pi / 8)
    assert 4 * integral == pytest.approx(np.pi / 2)


def appendix_d_phase():
    theta, cosine, sine = np.linspace(0, 6, 50), 3.0, 4.0
    wave = cosine * np.cos(theta) + sine * np.sin(theta)
    size = np.hypot(cosine, sine)
    assert np.allclose(wave, size * np.cos(theta + np.arctan2(-sine, cosine)))
    assert not np.allclose(wave, size * np.cos(theta + np.arctan2(sine, cosine)))


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
    "table-2.1-unit": density_unit,
    "strain-gauge-modulus": strain_gauge_modulus,
    "gauge-percent": gauge_percent,
    "table-2.2-against-4.1": table_22_against_41,
    "table-3.1-frequency-percent": table_31_frequency_percent,
    "table-4.1-elastic-supports": table_41_supports,
    "equation-4.12-mass": equation_412,
    "table-4.3-first-column": table_43_first_column,
    "equation-5.12-tolerance": equation_512,
    "table-5.2-kt-percent-18kN": table_52_percent,
    "table-5.2-kn-percent-22kN": table_52_percent,
    "equation-6.4-exponent": equation_64,
    "equation-6.9-sign": equation_69,
    "equation-6.10-logarithm": equation_610,
    "appendix-a-load": appendix_a_load,
    "appendix-b-percent": appendix_b_percent,
    "appendix-b-material": appendix_b_material,
    "equation-B-18": equation_b18,
    "appendix-c-slip": appendix_c_slip,
    "appendix-c-cycle": appendix_c_cycle,
    "appendix-d-phase": appendix_d_phase,
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
